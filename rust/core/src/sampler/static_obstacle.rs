//! The sampler as users see it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;

use super::hypothesis::{Claim, ContactModel, Hypothesis};
use super::measurements::Measurements;
use super::options::SamplerOptions;
use super::particle::Particle;
use super::path::ContactPath;
use super::sums::Prior;
use crate::detection::Gate;
use crate::error::{Error, Result};
use crate::math::chi_square::upper_limit;
use crate::math::random::Stream;
use crate::particle::{exposed_places, Event, FilterEstimate, FilterOptions, Instant};
use crate::posterior::parallel::{Course, Pool};
use crate::posterior::tempering::{Samples, Tempering, Travelled};
use crate::posterior::{Clusters, ContactSamples, MOST_MODES};
use crate::robot::{LinkIndex, Robot};
use crate::surface::SurfacePoint;

/// A contact ends below this share of the thresholds at which it begins.
const RELEASE: f64 = 1.0 / 3.0;
/// Share of hypotheses that stay effective from step to step.
const EFFECTIVE: f64 = 0.5;
/// Moves of a particle each time particles are drawn anew, where there are few poses, at most; and how often that is done at least.
const MOST_MOVES: usize = 6;
const LEAST_STEPS: usize = 4;
/// Errors of torque may be so many times as large as is stated.
const GRANTED: f64 = 3.0;
/// A place, a radius, a force and a stiffness.
const FITTED: usize = 5;
/// Poses that tell an obstacle that stays from what is none.
const LEAST_POSES: usize = 4;

/// Finds one contact with an obstacle that stays, anywhere on a robot, from all joint torques that were measured of it (algorithm C3).
///
/// Where a particle filter forgets what earlier motions taught, each hypothesis here has an obstacle that stays for good and
/// predicts every measurement of the window. Hypotheses are taken from one measurement to the next by tempered sequential Monte
/// Carlo (Del Moral, Doucet and Jasra 2006).
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
    samples: Samples<Hypothesis>,
    clusters: Clusters,
    found: FilterEstimate,
    evidence: f64,
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
        let found = FilterEstimate::new(wanted.len(), MOST_MODES);
        let instant = Instant::new(&robot, noise, wanted);
        let measurements = Measurements::new(&instant, options.window);
        let (link, place) = places[0];
        let claim = Claim { model: options.models[0], link, place, log_radius: filter.radius_range[0].ln() };
        let first = path(&robot, &measurements, &filter, &options.models).make(claim, None);
        let first =
            first.ok_or_else(|| Error::input("robot", "has no surface where anything could touch it"))?;
        Ok(StaticObstacleSampler {
            samples: Samples::new(options.particles, first)?,
            clusters: Clusters::new(options.particles, robot.links().len())?,
            moves: options.moves,
            window: options.window,
            gate: Gate::with_hysteresis(threshold, RELEASE),
            pool: Pool::new(filter.threads)?,
            models: options.models.clone(),
            forgetting_time: options.forgetting_time,
            time: None,
            stop: Arc::default(),
            evidence: 0.0,
            options: filter,
            instant,
            measurements,
            places,
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
            Event::None | Event::Lost => self.found.clear(event),
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
        (self.found.updates, self.evidence, self.time) = (0, 0.0, None);
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

    /// Weights of the particles, which sum to one.
    pub fn weights(&self) -> &[f64] {
        &self.samples.weights
    }

    /// A particle at the newest pose: its model, and its contact in the world frame; none where there is none of that number.
    pub fn particle(&self, k: usize) -> Option<Particle> {
        let hypothesis = self.samples.all.get(k)?;
        let link = hypothesis.claim.link as usize;
        let pose = self.instant.pose(link);
        let contact = self.samples.all.sample(k);
        Some(Particle {
            model: hypothesis.claim.model,
            link: LinkIndex::new(link),
            point: pose.transform_point(&contact.point),
            normal: pose.rotation * contact.normal,
            force: pose.rotation * contact.force,
            stiffness: contact.stiffness,
            weight: self.samples.weights[k],
        })
    }

    /// The probability of a model of a contact; zero without a contact.
    pub fn probability_of(&self, model: ContactModel) -> f64 {
        if self.found.estimate.contact.is_none() {
            return 0.0;
        }
        let own = |hypothesis: &Hypothesis| hypothesis.claim.model == model;
        self.samples
            .all
            .iter()
            .zip(&self.samples.weights)
            .filter(|(hypothesis, _)| own(hypothesis))
            .map(|(_, w)| w)
            .sum()
    }

    /// Logarithm of how many times as likely all torques of the contact are under one of the models as without a contact.
    pub fn total_log_evidence(&self) -> f64 {
        self.evidence
    }

    fn follow(&mut self, event: Event, kept: f64) {
        let started = event == Event::Started;
        if started {
            self.measurements.clear();
            self.evidence = 0.0;
        }
        self.measurements.take_in(&self.instant, kept);
        let Self {
            robot,
            options,
            models,
            measurements,
            samples,
            moves,
            window,
            stop,
            pool,
            places,
            found,
            ..
        } = self;
        let random = Stream::new(options.seed).fork(found.updates);
        let path = path(robot, measurements, options, models);
        let threads = options.threads;
        // The less poses there are, the less work is a move.
        let most_moves = *moves * *window / measurements.len().max(1);
        let tempering = Tempering {
            effective_share: EFFECTIVE,
            moves: (most_moves / LEAST_STEPS).clamp(1, MOST_MOVES),
            most_moves,
        };
        if started {
            samples.restart();
        }
        let count = samples.all.len();
        let mut travelled = Travelled::default();
        pool.install(|| {
            let work = |start: usize, hypotheses: &mut [Hypothesis]| {
                for (k, hypothesis) in hypotheses.iter_mut().enumerate() {
                    if !started {
                        path.follow(hypothesis);
                        continue;
                    }
                    let number = start + k;
                    let (link, place) = places[number * places.len() / count];
                    let [least, greatest] = path.log_radius;
                    let log_radius = least + (greatest - least) * random.uniform(number as u64);
                    let model = path.models[number % path.models.len()];
                    let made = path.make(Claim { model, link, place, log_radius }, None);
                    if let Some(made) = made {
                        *hypothesis = made;
                    }
                }
            };
            // Each measurement is taken into all particles, whatever is to end.
            let never = AtomicBool::new(false);
            Course { threads, stop: &never }.for_each(&mut samples.all[..], 0, &work);
            travelled = samples.travel(&path, tempering, random.fork(1), Course { threads, stop });
        });
        let without: f64 = self
            .measurements
            .scattered()
            .map(|measurement| 0.5 * (measurement.now - measurement.before) * measurement.target.squared)
            .sum();
        self.evidence += travelled.log_evidence + without;
        self.say(event, travelled.effective, travelled.log_evidence + without);
    }

    fn say(&mut self, event: Event, effective: f64, log_evidence: f64) {
        let Self { robot, instant, samples, clusters, found, measurements, .. } = self;
        clusters.find(robot, &instant.frames, &samples.all, &samples.weights);
        found.clear(event);
        found.estimate.set(clusters, &instant.frames, 0.0);
        (found.effective_samples, found.log_evidence) = (effective, log_evidence);
        let misfit =
            samples.all.iter().map(|hypothesis| hypothesis.marginal.misfit).fold(f64::INFINITY, f64::min);
        let poses = measurements.len();
        let rows = poses * instant.torque.len();
        found.residual = (misfit / rows as f64).sqrt();
        found.explained = misfit <= GRANTED * GRANTED * upper_limit(rows.saturating_sub(FITTED));
        found.estimate.ambiguous |= !found.explained || poses < LEAST_POSES;
    }
}

fn path<'a>(
    robot: &'a Robot,
    measurements: &'a Measurements,
    options: &FilterOptions,
    models: &'a [ContactModel],
) -> ContactPath<'a> {
    ContactPath {
        robot,
        measurements,
        models,
        prior: Prior { force: options.force_range, stiffness: options.stiffness_range },
        force_model: options.force_model,
        log_radius: options.radius_range.map(f64::ln),
    }
}

#[cfg(test)]
mod tests;
