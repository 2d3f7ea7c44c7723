//! The sampler as users see it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;

use nalgebra::Vector3;

use super::hypothesis::ContactModel;
use super::measurements::Measurements;
use super::neighbours::Neighbours;
use super::numbers::{Numbers, LEAST_POSES};
use super::options::SamplerOptions;
use super::particle::Particle;
use super::population::{population, Population, Scene};
use crate::detection::Gate;
use crate::error::{Error, Result};
use crate::math::chi_square::upper_limit;
use crate::math::random::Stream;
use crate::particle::{exposed_places, Event, FilterEstimate, FilterOptions, Instant, MOST_CONTACTS};
use crate::posterior::parallel::{Course, Pool};
use crate::posterior::{Clusters, MOST_MODES};
use crate::robot::{LinkIndex, Robot};
use crate::surface::SurfacePoint;

/// A contact ends below this share of the thresholds at which it begins.
const RELEASE: f64 = 1.0 / 3.0;
/// Errors of torque may be so many times as large as is stated.
const GRANTED: f64 = 3.0;
/// A place, a radius, a force and a stiffness.
const FITTED: usize = 5;
/// A number of contacts that is less probable is not sure.
const SURE_NUMBER: f64 = 0.8;

/// Finds contacts with obstacles that stay, anywhere on a robot, from all joint torques that were measured of them (algorithm C3).
///
/// Where a particle filter forgets what earlier motions taught, each hypothesis here has an obstacle that stays for good and
/// predicts every measurement of the window. Hypotheses are taken from one measurement to the next by tempered sequential Monte
/// Carlo (Del Moral, Doucet and Jasra 2006).
///
/// Where there may be several contacts, there are as many particles of one contact, of two and so on, each of which explains the
/// torques together; their evidence tells how many contacts there are.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::robot::Robot;
/// use contactsense::sampler::{SamplerOptions, StaticObstacleSampler};
///
/// let robot = Arc::new(Robot::example_arm());
/// let options = SamplerOptions { particles: 500, ..SamplerOptions::default() };
/// let mut sampler = StaticObstacleSampler::new(robot, &options)?;
/// assert!(sampler.update(&[0.4; 7], &[0.0; 7], None)?.estimate.contact.is_none());
/// let found = sampler.update(&[0.4; 7], &[1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0], None)?;
/// assert!(found.estimate.contact.is_some() && found.estimate.ambiguous);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug)]
pub struct StaticObstacleSampler {
    robot: Arc<Robot>,
    options: FilterOptions,
    models: Vec<ContactModel>,
    forgetting_time: Option<f64>,
    /// Of the last update (s).
    time: Option<f64>,
    moves: usize,
    window: usize,
    stop: Arc<AtomicBool>,
    pool: Pool,
    gate: Gate,
    instant: Instant,
    measurements: Measurements,
    places: Vec<(u32, SurfacePoint)>,
    neighbours: Neighbours,
    /// Of contacts: one, two and so on.
    numbers: Numbers,
    clusters: Clusters,
    found: FilterEstimate,
}

impl StaticObstacleSampler {
    /// A sampler for a robot.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) names the option.
    pub fn new(robot: Arc<Robot>, options: &SamplerOptions) -> Result<Self> {
        let (filter, wanted) = options.check(&robot)?;
        let noise = filter.torque_noise(&robot)?;
        let threshold = filter.threshold(&robot, &noise)?;
        let (places, _) = exposed_places(&robot, &wanted, &filter)?;
        let most = options.max_contacts;
        let found = FilterEstimate::of_several(wanted.len(), MOST_MODES, most);
        let neighbours = Neighbours::new(&robot, &wanted);
        let instant = Instant::new(&robot, noise, wanted);
        let measurements = Measurements::new(&instant, options.window, most > 1);
        let scene = Scene {
            robot: &robot,
            measurements: &measurements,
            options: &filter,
            models: &options.models,
            places: &places,
            neighbours: &neighbours,
        };
        let populations = (1..=most)
            .map(|contacts| population(contacts, options.particles, scene))
            .collect::<Result<_>>()?;
        Ok(StaticObstacleSampler {
            numbers: Numbers::new(populations),
            clusters: Clusters::new(options.particles, robot.links().len())?,
            moves: options.moves,
            window: options.window,
            gate: Gate::with_hysteresis(threshold, RELEASE),
            pool: Pool::new(filter.threads)?,
            models: options.models.clone(),
            forgetting_time: options.forgetting_time,
            time: None,
            stop: Arc::default(),
            options: filter,
            instant,
            measurements,
            places,
            neighbours,
            found,
            robot,
        })
    }

    /// Takes in a configuration `q` `(nq,)` and the external torque `tau_ext` `(nv,)` measured there at a `time` (s), as
    /// [`ContactParticleFilter::update`](crate::particle::ContactParticleFilter::update). The time is needed where measurements are
    /// forgotten with it.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) names the argument; the sampler is unchanged.
    pub fn update(&mut self, q: &[f64], tau_ext: &[f64], time: Option<f64>) -> Result<&FilterEstimate> {
        self.robot.check_configuration(q)?;
        self.robot.check_tangent("tau_ext", tau_ext)?;
        let kept = self.kept(time)?;
        self.time = time;
        self.instant.update(&self.robot, q, tau_ext, true);
        let before = self.gate.any_on();
        let event = match (before, self.gate.update(tau_ext, 1.0)) {
            (false, false) => Event::None,
            (true, false) => Event::Lost,
            (false, true) => Event::Started,
            (true, true) => Event::Continued,
        };
        match event {
            Event::None | Event::Lost => {
                self.found.clear(event);
                self.numbers.clear();
            }
            _ => self.follow(event, kept),
        }
        self.found.updates += 1;
        self.found.torque.clear();
        self.found.torque.extend_from_slice(tau_ext);
        self.stop.store(false, Ordering::Relaxed);
        Ok(&self.found)
    }

    /// The share that is kept of what was measured before a time.
    fn kept(&self, time: Option<f64>) -> Result<f64> {
        let refuse = |problem: &str| Err(Error::input("time", problem));
        let Some(now) = time else {
            return match self.forgetting_time {
                Some(_) => {
                    refuse("must be given where measurements are forgotten with time (forgetting_time)")
                }
                None => Ok(1.0),
            };
        };
        if !now.is_finite() {
            return refuse("must be a finite number (s)");
        }
        let passed = self.time.map_or(0.0, |before| now - before);
        match self.forgetting_time {
            Some(_) if passed < 0.0 => refuse("must not be less than at the last update (s)"),
            Some(forgetting) => Ok((-passed / forgetting).exp()),
            None => Ok(1.0),
        }
    }

    /// A flag that another thread sets to have an update end at once: it then returns what it has, with particles that are less
    /// well moved.
    pub fn stop(&self) -> Arc<AtomicBool> {
        self.stop.clone()
    }

    /// Forgets all updates.
    pub fn reset(&mut self) {
        self.gate.reset();
        self.measurements.clear();
        self.found.clear(Event::None);
        (self.found.updates, self.time) = (0, None);
        self.numbers.reset();
        self.begin();
        self.found.torque.clear();
    }

    /// Indices of the links that are looked on.
    pub fn links(&self) -> &[usize] {
        &self.instant.frames.wanted
    }

    /// Of the last update (s), if it was given.
    pub fn time(&self) -> Option<f64> {
        self.time
    }

    /// The last estimate.
    pub fn estimate(&self) -> &FilterEstimate {
        &self.found
    }

    /// Probability of one contact, two and so on; all zero without a contact.
    pub fn number_probabilities(&self) -> &[f64] {
        self.numbers.probabilities()
    }

    /// Of the most probable number of contacts.
    fn population(&self) -> &dyn Population {
        self.numbers.likely()
    }

    /// Weights of the particles of the most probable number of contacts, which sum to one.
    pub fn weights(&self) -> &[f64] {
        self.population().weights()
    }

    /// How many contacts these have.
    pub fn contacts(&self) -> usize {
        self.population().contacts()
    }

    /// A particle at the newest pose: the model of one of its contacts, and that contact in the world frame; none where there is none
    /// of these numbers.
    pub fn particle(&self, k: usize, contact: usize) -> Option<Particle> {
        let (model, sample) = self.population().sample(k, contact)?;
        let pose = self.instant.pose(sample.link);
        Some(Particle {
            model,
            link: LinkIndex::new(sample.link),
            point: pose.transform_point(&sample.point),
            normal: pose.rotation * sample.normal,
            force: pose.rotation * sample.force,
            stiffness: sample.stiffness,
            weight: self.weights()[k],
        })
    }

    /// The probability of a model of a contact; zero without a contact.
    pub fn probability_of(&self, model: ContactModel) -> f64 {
        if self.found.estimate.contact.is_none() {
            return 0.0;
        }
        let population = self.population();
        let own = |k: &usize| population.sample(*k, 0).is_some_and(|(own, _)| own == model);
        (0..self.weights().len()).filter(own).map(|k| self.weights()[k]).sum()
    }

    /// Logarithm of how many times as likely all torques of the contacts are under one of the models as without a contact.
    pub fn total_log_evidence(&self) -> f64 {
        self.population().log_evidence()
    }

    fn follow(&mut self, event: Event, kept: f64) {
        let (event, weighed) = match event {
            Event::Continued => {
                let before = self.population().misfit();
                let weighed = self.take_in(false, kept);
                // One more contact, or one less: what is known of the others no longer tells what is measured.
                if self.numbers.several() && self.surprised(before) {
                    self.begin();
                    (Event::Changed, self.take_in(true, kept))
                } else {
                    (Event::Continued, weighed)
                }
            }
            _ => {
                self.found.clear(event);
                self.begin();
                (Event::Started, self.take_in(true, kept))
            }
        };
        self.say(event, weighed);
    }

    /// Contacts begin beside those of the last estimate, or in their place.
    fn begin(&mut self) {
        let FilterEstimate { estimate, others, .. } = &self.found;
        let (mut before, mut count) = ([Vector3::zeros(); MOST_CONTACTS], 0);
        for contact in
            std::iter::once(estimate).chain(others).filter_map(|estimate| estimate.contact.as_ref())
        {
            (before[count], count) = (contact.point, count + 1);
        }
        self.numbers.begin(&before[..count]);
    }

    /// Whether all hypotheses leave more of the newest torques over than noise does, though they explained those before.
    fn surprised(&self, before: f64) -> bool {
        let (poses, rows) = (self.measurements.len(), self.instant.torque.len());
        let noise = (before / ((poses - 1) * rows) as f64).max(1.0);
        let limit = GRANTED * GRANTED * upper_limit(rows);
        let now = self.numbers.least_misfit();
        poses > LEAST_POSES && self.found.explained && now - before > noise * limit
    }

    /// Takes the newest measurement in, `anew` without those before; effective samples and log-evidence of the most probable number.
    fn take_in(&mut self, anew: bool, kept: f64) -> (f64, f64) {
        if anew {
            self.measurements.clear();
        }
        self.measurements.take_in(&self.instant, kept);
        let rows = self.instant.torque.len();
        let Self { robot, options, models, measurements, numbers, stop, pool, places, neighbours, .. } = self;
        let random = Stream::new(options.seed).fork(self.found.updates);
        let scene = Scene { robot, measurements, options, models, places, neighbours };
        let course = Course { threads: options.threads, stop };
        // The less poses there are, the less work is a move.
        let moves = self.moves * self.window / measurements.len().max(1);
        let mut weighed = (0.0, 0.0);
        pool.install(|| weighed = numbers.update(scene, anew, moves, rows, random, course));
        weighed
    }

    fn say(&mut self, event: Event, (effective, log_evidence): (f64, f64)) {
        let Self { robot, instant, numbers, clusters, found, measurements, .. } = self;
        let population = numbers.likely();
        found.clear(event);
        (found.effective_samples, found.log_evidence) = (effective, log_evidence);
        for contact in 0..population.contacts() {
            population.find(contact, clusters, robot, &instant.frames);
            let estimate = match contact {
                0 => &mut found.estimate,
                _ => &mut found.others[contact - 1],
            };
            estimate.set(clusters, &instant.frames, 0.0);
        }
        let misfit = population.misfit();
        let poses = measurements.len();
        let rows = poses * instant.torque.len();
        found.residual = (misfit / rows as f64).sqrt();
        let fitted = FITTED * population.contacts();
        found.explained = misfit <= GRANTED * GRANTED * upper_limit(rows.saturating_sub(fitted));
        let unsure = !found.explained || poses < LEAST_POSES || numbers.greatest() < SURE_NUMBER;
        for estimate in found.others.iter_mut().chain([&mut found.estimate]) {
            estimate.ambiguous |= unsure && estimate.contact.is_some();
        }
    }
}

#[cfg(test)]
mod tests;
