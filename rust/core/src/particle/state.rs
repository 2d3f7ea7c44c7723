//! All that an update works on, and its course.

use std::mem::size_of;
use std::sync::atomic::AtomicBool;
use std::sync::Arc;

use super::adaptation::Adaptation;
use super::birth::{Births, PLACE};
use super::check::Check;
use super::columns::{Columns, Slice};
use super::estimate::{ContactEstimate, Event};
use super::instant::Instant;
use super::left_over::{turning, LeftOver};
use super::likelihood::{Belief, Weighing};
use super::memory::{filled, space};
use super::modes::{Modes, MOST_MODES};
use super::motion::Move;
use super::options::{FilterOptions, Likelihood, Motion};
use super::parallel::Course;
use super::push::Push;
use super::resampling::{effective_share, normalise};
use super::response::ResponseModel;
use super::schedule::Noise;
use super::search::EstimatedPush;
use crate::detection::{is_over, Gate};
use crate::error::Result;
use crate::math::random::Stream;
use crate::robot::Robot;
use crate::torque::{TorqueNoise, LEVEL};

mod renewal;

/// A contact ends below this share of the thresholds at which it begins.
const RELEASE: f64 = 1.0 / 3.0;
/// A link that moves farther between two updates has jumped [m].
const JUMP: f64 = 0.5;
/// Particles are drawn anew below this share of effective ones.
const RESAMPLE: f64 = 0.5;
/// As many are weighed to choose the sharpness.
const PROBES: usize = 1024;
/// A likelihood is widened so often at most, each time to twice the variance.
const WIDENINGS: usize = 40;

/// Memory that one particle takes [bytes].
const PARTICLE: usize = 2 * Columns::SIZE + Modes::SIZE + PLACE + size_of::<f64>() + size_of::<u32>();

#[derive(Debug, Clone)]
pub(super) struct FilterState {
    robot: Arc<Robot>,
    pub options: FilterOptions,
    /// Set to stop a step from another thread.
    pub stop: Arc<AtomicBool>,
    noise: TorqueNoise,
    gate: Gate,
    /// Whether a velocity variable is a rotation's.
    turning: Vec<bool>,
    pub instant: Instant,
    births: Births,
    pub particles: Columns,
    spare: Columns,
    pub weights: Vec<f64>,
    parents: Vec<u32>,
    modes: Modes,
    check: Check,
    pub estimate: ContactEstimate,
    random: Stream,
    adaptation: Adaptation,
    /// Updates since the start or the last reset.
    step: u64,
    /// Updates since the particles were last spread.
    pub age: u64,
    /// Age from which the particles may be weighed a second time within an update.
    next_reinitialisation: u64,
    /// Streams of random numbers that were used up.
    streams: u64,
}

impl FilterState {
    pub fn new(robot: Arc<Robot>, options: FilterOptions) -> Result<Self> {
        let wanted = options.check(&robot)?;
        let count = options.particles;
        // All of it at once, so that a part is not filled in vain.
        drop(space::<[u8; PARTICLE]>(count)?);
        let noise = options.torque_noise(&robot)?;
        let threshold = options.threshold(&robot, &noise)?;
        let births = Births::new(&robot, &wanted, &options)?;
        let links = wanted.len();
        let instant = Instant::new(&robot, wanted);
        Ok(Self {
            check: Check::new(&robot, &instant, &options, noise.clone()),
            noise,
            gate: Gate::with_hysteresis(threshold, RELEASE),
            turning: turning(&robot),
            births,
            estimate: ContactEstimate::new(links, MOST_MODES),
            instant,
            particles: Columns::new(count)?,
            spare: Columns::new(count)?,
            weights: filled(1.0 / count as f64, count)?,
            parents: filled(0, count)?,
            modes: Modes::new(count, robot.links().len())?,
            random: Stream::new(options.seed),
            adaptation: Adaptation::default(),
            step: 0,
            stop: Arc::default(),
            age: 0,
            next_reinitialisation: 1,
            streams: 0,
            robot,
            options,
        })
    }

    pub fn reset(&mut self) {
        self.step = 0;
        self.streams = 0;
        self.gate.reset();
        self.estimate.clear();
        self.estimate.event = Event::None;
        self.estimate.updates = 0;
        self.particles.clear();
        self.weights.fill(1.0 / self.particles.len() as f64);
    }

    /// Takes in a measurement.
    pub fn read(&mut self, q: &[f64], tau_ext: &[f64]) -> Result<()> {
        self.robot.check_configuration(q)?;
        self.robot.check_tangent("tau_ext", tau_ext)?;
        self.instant.torque.copy_from_slice(tau_ext);
        match self.options.likelihood {
            Likelihood::Gaussian => self.noise.set_deviations(tau_ext, &mut self.instant.deviation),
            Likelihood::Exponential => self.instant.deviation.fill(1.0),
        }
        self.instant.update(&self.robot, q);
        Ok(())
    }

    /// Updates particles and estimate by the measurement that was read.
    pub fn step(&mut self) {
        let moved = if self.step == 0 { 0.0 } else { self.instant.displacement() };
        let event = self.detect(moved);
        // What moves behind the contact tells nothing of it.
        let moved = self.estimate.link.map_or(moved, |link| self.instant.displacement_of(link));
        if self.step == 0 || matches!(event, Event::Started | Event::Jumped) {
            self.spread();
        }
        if self.gate.any_on() {
            self.follow(event, moved);
        } else {
            self.estimate.clear();
            self.estimate.event = event;
        }
        self.step += 1;
        self.age += 1;
        self.estimate.updates = self.step;
    }

    /// Lets the particles take in a contact's torque.
    fn follow(&mut self, mut event: Event, moved: f64) {
        let noise = Noise::at(&self.options, self.age, moved);
        // Particles that were born in this update are where the robot is.
        if self.age > 0 {
            self.predict(&noise, self.particles.len());
        }
        let mut effective = self.weigh(moved, &noise);
        let due = self.age >= self.next_reinitialisation && noise.sharpness.is_none();
        if due && self.left_over().is_much(REINITIALISE) {
            self.next_reinitialisation = self.age + PAUSE;
            (effective, event) = self.reinitialise(&noise, moved, event);
        }
        let left = self.estimate_contact(event, effective, moved);
        if effective < RESAMPLE * self.particles.len() as f64 {
            self.resample(&noise, moved, Adaptation::fresh_share(left.share));
        }
    }

    /// Says what the weighted particles show.
    pub fn estimate_contact(&mut self, event: Event, effective: f64, moved: f64) -> LeftOver {
        self.modes.find(&self.robot, &self.instant.frames, &self.particles, &self.weights);
        let left = self.left_over();
        self.adaptation.learn(left.misfit, self.active_joints());
        self.update_estimate(event, effective, moved, &left);
        left
    }

    /// Random numbers that nothing else uses.
    fn stream(&mut self) -> Stream {
        self.streams += 1;
        self.random.fork(self.streams)
    }

    fn response_model(&self) -> ResponseModel {
        ResponseModel { force_model: self.options.force_model, variance: self.adaptation.noise() }
    }

    /// Whether a contact begins, goes on or ends.
    fn detect(&mut self, moved: f64) -> Event {
        let before = self.gate.any_on();
        let felt = self.gate.update(&self.instant.torque, 1.0);
        match (before, felt) {
            (false, false) => Event::None,
            (false, true) => Event::Started,
            (true, false) => Event::Lost,
            (true, true) if moved > JUMP => Event::Jumped,
            (true, true) => Event::Continued,
        }
    }

    /// Begins the search anew.
    fn spread(&mut self) {
        self.adaptation = Adaptation::default();
        self.bear(0, true);
        self.age = 0;
        self.next_reinitialisation = 1;
    }

    /// Moves the first particles with the robot.
    pub fn predict(&mut self, noise: &Noise, count: usize) {
        let motion = Move {
            motion: self.options.motion,
            response_model: self.response_model(),
            log_radius: self.options.radius_range.map(f64::ln),
            noise: *noise,
            loose_force: self.options.force_range[1],
            stiffness_range: self.options.stiffness_range,
            sampled: self.options.likelihood == Likelihood::Exponential,
            random: self.stream(),
            step: self.step,
        };
        let Self { robot, instant, particles, options, stop, .. } = self;
        let work = |start: usize, mut slice: Slice<'_>| motion.apply(robot, instant, start, &mut slice);
        Course { threads: options.threads, stop }.for_each(particles.slice().split_at(count).0, 0, &work);
    }

    /// Weighs the particles; returns how many are effective.
    pub fn weigh(&mut self, moved: f64, noise: &Noise) -> f64 {
        let mut weighing = Weighing {
            likelihood: self.options.likelihood,
            variance: 1.0,
            stiffness_range: self.options.stiffness_range,
        };
        if let Some(sharpness) = noise.sharpness {
            let unit = match self.options.likelihood {
                Likelihood::Exponential => 1.0,
                Likelihood::Gaussian => self.noise.at_rest().iter().copied().fold(f64::INFINITY, f64::min),
            };
            weighing.variance = 1.0 / (sharpness * unit).powi(2);
        } else {
            let active = self.active_joints();
            weighing.variance = self.adaptation.sharpest(moved, active, self.age);
            let widenings = if self.particles.len() < 2 { 0 } else { WIDENINGS };
            for _ in 0..widenings {
                if self.probe(&weighing) >= self.adaptation.effective_share() {
                    break;
                }
                weighing.variance *= 2.0;
            }
            self.adaptation.weighed(weighing.variance);
        }
        let work = |_: usize, mut slice: Slice<'_>| weighing.apply(&mut slice);
        let course = Course { threads: self.options.threads, stop: &self.stop };
        course.for_each(self.particles.slice(), 0, &work);
        normalise(&mut self.particles.log_weight, &mut self.weights)
    }

    /// Share of particles that would be effective after a weighing.
    fn probe(&self, weighing: &Weighing) -> f64 {
        let particles = &self.particles;
        let stride = particles.len().div_ceil(PROBES);
        effective_share(particles.len(), stride, |k| {
            particles.log_weight[k] + weighing.log_likelihood(&Belief::of(particles, k))
        })
    }

    /// How many joints feel the contact.
    fn active_joints(&self) -> usize {
        let torque = self.instant.torque.iter();
        torque.zip(self.noise.at_rest()).filter(|(torque, noise)| is_over(**torque, LEVEL * **noise)).count()
    }

    /// What the best particle leaves over.
    fn left_over(&self) -> LeftOver {
        LeftOver::of(&self.particles, &self.weights, self.instant.target.squared, self.instant.torque.len())
    }

    fn update_estimate(&mut self, event: Event, effective: f64, moved: f64, left: &LeftOver) {
        let error = left.moment(&self.instant.torque, &self.instant.deviation, &self.turning)
            * self.adaptation.averaged();
        let Self { estimate, modes, instant, check, robot, particles, options, .. } = self;
        let sure = (estimate.contact && !estimate.ambiguous)
            .then(|| (estimate.point, MOVED_ON + 3.0 * estimate.covariance.trace().sqrt()));
        estimate.clear();
        estimate.event = event;
        estimate.effective_samples = effective;
        let springy = options.motion == Motion::Curvature;
        estimate.set_contact(modes, &instant.frames, springy, error);
        if let (Event::Continued, Some((before, reach))) = (event, sure) {
            if (estimate.point - before).norm() > reach + moved {
                estimate.event = Event::Changed;
            }
        }
        if estimate.event != Event::Continued {
            check.restart();
        }
        let Some(link) = estimate.link else { return };
        let pose = instant.pose(link);
        let push = Push {
            instant,
            force_model: options.force_model,
            link,
            point: pose.inverse_transform_point(&estimate.point),
            normal: pose.inverse_transform_vector(&estimate.normal),
        };
        // The mean of a mode need not fit where the surface is curved or has an edge; its best particle does.
        let best = (particles.point[left.best], particles.normal[left.best]);
        let on_link = particles.link[left.best] as usize == link;
        let near = on_link && (best.0 - push.point).norm() < MOVED_ON;
        let other = near.then_some(Push { point: best.0, normal: best.1, ..push });
        let estimated = EstimatedPush {
            point: estimate.point,
            normal: estimate.normal,
            local: push.point,
            centre: on_link.then_some(particles.centre[left.best]),
        };
        estimate.residual = check.take_in(robot, &push, other.as_ref(), &estimated);
        estimate.explained = check.explained();
        // What is not explained is never sure, nor what has not been confirmed yet.
        estimate.ambiguous |= !check.trusted();
    }
}

/// Above this share of the torque that the best particle leaves over, the contact is looked for on the whole surface.
const REINITIALISE: f64 = 0.2;
/// Updates from one such search to the next: it costs as much as an update.
const PAUSE: u64 = 3;
/// A point that was sure and is farther off now, beyond its spread and the robot's motion, is another contact [m].
const MOVED_ON: f64 = 0.05;
