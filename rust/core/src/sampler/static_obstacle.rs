//! The sampler as users see it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;

use super::hypothesis::Hypothesis;
use super::measurements::{Measurement, Measurements};
use super::options::SamplerOptions;
use super::path::ObstaclePath;
use super::sums::Prior;
use crate::detection::Gate;
use crate::error::{Error, Result};
use crate::math::chi_square::upper_limit;
use crate::math::random::Stream;
use crate::particle::{exposed_places, Event, FilterEstimate, FilterOptions, Instant};
use crate::posterior::parallel::{Course, Pool};
use crate::posterior::tempering::{Samples, Tempering, Travelled};
use crate::posterior::{Clusters, MOST_MODES};
use crate::robot::Robot;
use crate::surface::SurfacePoint;

/// A contact ends below this share of the thresholds at which it begins.
const RELEASE: f64 = 1.0 / 3.0;
/// Share of hypotheses that stay effective from step to step.
const EFFECTIVE: f64 = 0.5;
/// Steps from one measurement to the next at most; the last goes to the end.
const MOST_STEPS: usize = 12;
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
/// let options = SamplerOptions { hypotheses: 500, ..SamplerOptions::default() };
/// let mut sampler = StaticObstacleSampler::new(robot, &options)?;
/// assert!(sampler.update(&[0.4; 7], &[0.0; 7])?.estimate.contact.is_none());
/// let found = sampler.update(&[0.4; 7], &[1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])?;
/// assert!(found.estimate.contact.is_some() && found.estimate.ambiguous);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug)]
pub struct StaticObstacleSampler {
    robot: Arc<Robot>,
    options: FilterOptions,
    tempering: Tempering,
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
        let path = path(&robot, &measurements, &filter);
        let first = path.make(link, place, path.log_radius[0]);
        let first =
            first.ok_or_else(|| Error::input("robot", "has no surface where anything could touch it"))?;
        Ok(StaticObstacleSampler {
            samples: Samples::new(options.hypotheses, first)?,
            clusters: Clusters::new(options.hypotheses, robot.links().len())?,
            tempering: Tempering { effective_share: EFFECTIVE, moves: options.moves, most_steps: MOST_STEPS },
            gate: Gate::with_hysteresis(threshold, RELEASE),
            pool: Pool::new(filter.threads)?,
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

    /// Takes in a configuration `q` `(nq,)` and the external torque `tau_ext` `(nv,)` measured there, as
    /// [`ContactParticleFilter::update`](crate::particle::ContactParticleFilter::update).
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) names the argument; the sampler is unchanged.
    pub fn update(&mut self, q: &[f64], tau_ext: &[f64]) -> Result<&FilterEstimate> {
        self.robot.check_configuration(q)?;
        self.robot.check_tangent("tau_ext", tau_ext)?;
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
            _ => self.follow(event),
        }
        self.found.updates += 1;
        self.found.torque.clear();
        self.found.torque.extend_from_slice(tau_ext);
        if self.stop.swap(false, Ordering::Relaxed) {
            // What was done in part is of no use.
            self.reset();
            return Err(Error::Stopped);
        }
        Ok(&self.found)
    }

    /// A flag that stops an update when another thread sets it, as
    /// [`ContactParticleFilter::stop`](crate::particle::ContactParticleFilter::stop).
    pub fn stop(&self) -> Arc<AtomicBool> {
        self.stop.clone()
    }

    /// Forgets all updates.
    pub fn reset(&mut self) {
        self.gate.reset();
        self.measurements.clear();
        self.found.clear(Event::None);
        (self.found.updates, self.evidence) = (0, 0.0);
        self.found.torque.clear();
    }

    /// The last estimate.
    pub fn estimate(&self) -> &FilterEstimate {
        &self.found
    }

    /// Weights of the hypotheses, which sum to one.
    pub fn weights(&self) -> &[f64] {
        &self.samples.weights
    }

    /// Logarithm of how many times as likely all torques of the contact are under one obstacle that stays as without a contact.
    pub fn total_log_evidence(&self) -> f64 {
        self.evidence
    }

    fn follow(&mut self, event: Event) {
        let started = event == Event::Started;
        if started {
            self.measurements.clear();
            self.evidence = 0.0;
        }
        self.measurements.take_in(&self.instant);
        let Self { robot, options, measurements, samples, tempering, stop, pool, places, found, .. } = self;
        let random = Stream::new(options.seed).fork(found.updates);
        let path = path(robot, measurements, options);
        let course = Course { threads: options.threads, stop };
        let tempering = *tempering;
        if started {
            samples.restart();
        }
        let count = samples.all.len();
        let mut travelled = Travelled::default();
        pool.install(|| {
            let work = |start: usize, hypotheses: &mut [Hypothesis]| {
                for (k, hypothesis) in hypotheses.iter_mut().enumerate() {
                    if started {
                        let number = start + k;
                        let (link, place) = places[number * places.len() / count];
                        let [least, greatest] = path.log_radius;
                        let log_radius = least + (greatest - least) * random.uniform(number as u64);
                        if let Some(made) = path.make(link, place, log_radius) {
                            *hypothesis = made;
                        }
                    } else {
                        path.follow(hypothesis);
                    }
                }
            };
            course.for_each(&mut samples.all[..], 0, &work);
            travelled = samples.travel(&path, tempering, random.fork(1), course);
        });
        let squared = |measurement: &Measurement| 0.5 * measurement.target.squared;
        let without = squared(self.measurements.newest()) - self.measurements.dropped().map_or(0.0, squared);
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

fn path<'a>(robot: &'a Robot, measurements: &'a Measurements, options: &FilterOptions) -> ObstaclePath<'a> {
    ObstaclePath {
        robot,
        measurements,
        prior: Prior { force: options.force_range, stiffness: options.stiffness_range },
        force_model: options.force_model,
        log_radius: options.radius_range.map(f64::ln),
    }
}

#[cfg(test)]
mod tests;
