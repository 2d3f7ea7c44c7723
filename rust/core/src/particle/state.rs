//! All that an update works on, and its course.

use std::sync::atomic::AtomicBool;
use std::sync::Arc;

use super::adaptation::Adaptation;
use super::beside::Beside;
use super::birth::Births;
use super::check::Check;
use super::clock::Clock;
use super::cloud::Cloud;
use super::columns::Slice;
use super::estimate::{Event, FilterEstimate};
use super::instant::Instant;
use super::known::Known;
use super::left_over::LeftOver;
use super::likelihood::{Belief, Weighing};
use super::motion::Move;
use super::options::{FilterOptions, Likelihood, Motion};
use super::push::Push;
use super::response::ResponseModel;
use super::search::EstimatedPush;
use super::step_noise::StepNoise;
use crate::detection::{is_over, Gate};
use crate::error::Result;
use crate::posterior::parallel::{Course, Pieces};
use crate::posterior::resampling::effective_share;
use crate::posterior::{Clusters, MOST_MODES};
use crate::robot::Robot;
use crate::torque::LEVEL;

mod among_others;
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

#[derive(Debug, Clone)]
pub(super) struct FilterState {
    robot: Arc<Robot>,
    pub options: FilterOptions,
    /// Set to stop a step from another thread.
    pub stop: Arc<AtomicBool>,
    gate: Gate,
    pub instant: Instant,
    pub cloud: Cloud,
    clusters: Clusters,
    check: Check,
    pub found: FilterEstimate,
    adaptation: Adaptation,
    beside: Beside,
    /// As others take the contact to be: the best particle, if it is on the estimated link. None without a contact.
    pub known: Option<Known>,
    /// By how much the best particle reduces the squared norm of the torques that nothing else explains, each over its noise as it
    /// was learnt.
    pub explains: f64,
    /// Whether the contact is not looked for elsewhere, whatever it leaves unexplained.
    pub stays: bool,
    pub clock: Clock,
}

impl FilterState {
    pub fn new(robot: Arc<Robot>, options: FilterOptions) -> Result<Self> {
        let wanted = options.check(&robot)?;
        let count = options.particles;
        let noise = options.torque_noise(&robot)?;
        let threshold = options.threshold(&robot, &noise)?;
        let births = Births::new(&robot, &wanted, &options)?;
        let found = FilterEstimate::of_several(wanted.len(), MOST_MODES, options.max_contacts);
        let instant = Instant::new(&robot, noise, wanted);
        Ok(Self {
            check: Check::new(&robot, &instant, &options),
            gate: Gate::with_hysteresis(threshold, RELEASE),
            found,
            instant,
            cloud: Cloud::new(births, count)?,
            clusters: Clusters::new(count, robot.links().len())?,
            clock: Clock::new(options.seed),
            adaptation: Adaptation::default(),
            beside: Beside::new(robot.nv()),
            known: None,
            explains: 0.0,
            stays: false,
            stop: Arc::default(),
            robot,
            options,
        })
    }

    pub fn reset(&mut self) {
        self.clock.reset();
        self.gate.reset();
        self.found.clear(Event::None);
        self.found.updates = 0;
        self.found.torque.clear();
        (self.known, self.adaptation) = (None, Adaptation::default());
        self.cloud.clear();
    }

    /// Takes in a measurement.
    pub fn read(&mut self, q: &[f64], tau_ext: &[f64]) -> Result<()> {
        self.robot.check_configuration(q)?;
        self.robot.check_tangent("tau_ext", tau_ext)?;
        let weighed = self.options.likelihood == Likelihood::Gaussian;
        self.instant.update(&self.robot, q, tau_ext, weighed);
        Ok(())
    }

    /// Updates particles and estimate by the measurement that was read.
    pub fn step(&mut self) {
        let moved = if self.clock.step == 0 { 0.0 } else { self.instant.displacement() };
        let event = self.detect(moved);
        // What moves behind the contact tells nothing of it.
        let moved = self
            .found
            .estimate
            .contact
            .map_or(moved, |contact| self.instant.displacement_of(contact.link.get()));
        if self.clock.step == 0 || matches!(event, Event::Started | Event::Jumped) {
            self.spread();
        }
        if self.gate.any_on() {
            self.follow(event, moved);
        } else {
            self.found.clear(event);
            self.known = None;
        }
        self.clock.tick();
        self.found.updates = self.clock.step;
        self.found.torque.clone_from(&self.instant.measured);
    }

    /// Lets the particles take in a contact's torque.
    fn follow(&mut self, mut event: Event, moved: f64) {
        let noise = StepNoise::at(&self.options, self.clock.age, moved);
        // Particles that were born in this update are where the robot is.
        if self.clock.age > 0 {
            self.predict(&noise, self.cloud.particles.len());
        }
        let mut effective = self.weigh(moved, &noise);
        let due =
            self.clock.age >= self.clock.next_reinitialisation && noise.sharpness.is_none() && !self.stays;
        if due && self.left_over().is_much(REINITIALISE) {
            self.clock.next_reinitialisation = self.clock.age + PAUSE;
            (effective, event) = self.reinitialise(&noise, moved, event);
        }
        let left = self.left_over();
        let few = effective < RESAMPLE * self.cloud.particles.len() as f64;
        let kept = few.then(|| self.copies(Adaptation::fresh_share(left.share)));
        self.find_modes(kept);
        self.say(event, effective, moved, &left);
        if let Some(kept) = kept {
            self.take_copies(kept, &noise, moved);
        }
    }

    /// Says what the weighted particles show.
    pub fn estimate_contact(&mut self, event: Event, effective: f64, moved: f64) {
        let left = self.left_over();
        self.find_modes(None);
        self.say(event, effective, moved, &left);
    }

    /// Finds the modes of the weighted particles, and draws so many copies of these at the same time.
    fn find_modes(&mut self, kept: Option<usize>) {
        let wanted = kept.map(|kept| (kept, self.offset()));
        let Self { robot, instant, clusters, cloud, options, stop, .. } = self;
        let (copying, particles, weights) = cloud.copying();
        Course { threads: options.threads, stop }.both(
            || clusters.find(robot, &instant.frames, particles, weights),
            || {
                if let Some((kept, offset)) = wanted {
                    copying.draw(kept, offset);
                }
            },
        );
    }

    /// Says what was found, where the best particle leaves so much over.
    fn say(&mut self, event: Event, effective: f64, moved: f64, left: &LeftOver) {
        self.adaptation.learn(left.misfit, self.active_joints());
        self.update_estimate(event, effective, moved, left);
        self.known = self.known(left.best);
        self.explains = (self.instant.squared - left.misfit) / self.adaptation.noise();
    }

    fn response_model(&self) -> ResponseModel {
        ResponseModel { force_model: self.options.force_model, variance: self.adaptation.noise() }
    }

    /// Whether a contact begins, goes on or ends.
    fn detect(&mut self, moved: f64) -> Event {
        let before = self.gate.any_on();
        let felt = self.gate.update(&self.instant.measured, 1.0);
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
        self.renew(0, true);
        self.clock.spread();
    }

    /// Moves the first particles with the robot.
    pub fn predict(&mut self, noise: &StepNoise, count: usize) {
        let motion = Move {
            motion: self.options.motion,
            response_model: self.response_model(),
            log_radius: self.options.radius_range.map(f64::ln),
            noise: *noise,
            loose_force: self.options.force_range[1],
            stiffness_range: self.options.stiffness_range,
            sampled: self.options.likelihood == Likelihood::Exponential,
            random: self.clock.stream(),
            step: self.clock.step,
        };
        let Self { robot, instant, cloud, options, stop, .. } = self;
        let work = |start: usize, mut slice: Slice<'_>| motion.apply(robot, instant, start, &mut slice);
        Course { threads: options.threads, stop }.for_each(cloud.particles.slice().split(count).0, 0, &work);
    }

    /// Weighs the particles; returns how many are effective.
    pub fn weigh(&mut self, moved: f64, noise: &StepNoise) -> f64 {
        let mut weighing = Weighing {
            likelihood: self.options.likelihood,
            variance: 1.0,
            stiffness_range: self.options.stiffness_range,
        };
        if let Some(sharpness) = noise.sharpness {
            let unit = match self.options.likelihood {
                Likelihood::Exponential => 1.0,
                Likelihood::Gaussian => {
                    self.instant.noise.at_rest().iter().copied().fold(f64::INFINITY, f64::min)
                }
            };
            weighing.variance = 1.0 / (sharpness * unit).powi(2);
        } else {
            let active = self.active_joints();
            weighing.variance = self.adaptation.sharpest(moved, active, self.clock.age);
            let widenings = if self.cloud.particles.len() < 2 { 0 } else { WIDENINGS };
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
        course.for_each(self.cloud.particles.slice(), 0, &work);
        let (effective, evidence) = self.cloud.normalise(course);
        // Without a contact all of the torque is noise.
        self.found.log_evidence = evidence + 0.5 * self.instant.squared / weighing.variance;
        effective
    }

    /// Share of particles that would be effective after a weighing.
    fn probe(&self, weighing: &Weighing) -> f64 {
        let particles = &self.cloud.particles;
        let stride = particles.len().div_ceil(PROBES);
        let mut logs = [0.0; PROBES];
        let logs = &mut logs[..particles.len().div_ceil(stride)];
        let work = |start: usize, logs: &mut [f64]| {
            for (k, log) in (start..).zip(logs) {
                let k = k * stride;
                *log = particles.log_weight[k] + weighing.log_likelihood(&Belief::of(particles, k));
            }
        };
        Course { threads: self.options.threads, stop: &self.stop }.for_each(&mut *logs, 0, &work);
        effective_share(logs.iter().copied())
    }

    /// How many joints feel the contact.
    fn active_joints(&self) -> usize {
        let torque = self.instant.torque.iter();
        torque
            .zip(self.instant.noise.at_rest())
            .filter(|(torque, noise)| is_over(**torque, LEVEL * **noise))
            .count()
    }

    /// What the best particle leaves over.
    fn left_over(&self) -> LeftOver {
        LeftOver::of(&self.cloud, &self.instant)
    }

    fn update_estimate(&mut self, event: Event, effective: f64, moved: f64, left: &LeftOver) {
        let error = left.moment(&self.instant) * self.adaptation.averaged();
        let Self { found, clusters, instant, check, robot, cloud, options, .. } = self;
        let sure = found.sure_within();
        let log_evidence = found.log_evidence;
        found.clear(event);
        (found.effective_samples, found.log_evidence) = (effective, log_evidence);
        found.estimate.set(clusters, &instant.frames, error);
        if options.motion != Motion::Curvature {
            found.estimate.forget_stiffness();
        }
        let Some(contact) = found.estimate.contact else { return };
        if let (Event::Continued, Some((before, reach))) = (event, sure) {
            if (contact.point - before).norm() > MOVED_ON + reach + moved {
                found.event = Event::Changed;
            }
        }
        if found.event != Event::Continued {
            check.restart();
        }
        let link = contact.link.get();
        let pose = instant.pose(link);
        let push = Push {
            instant,
            force_model: options.force_model,
            link,
            point: pose.inverse_transform_point(&contact.point),
            normal: pose.inverse_transform_vector(&contact.normal),
        };
        // The mean of a mode need not fit where the surface is curved or has an edge; its best particle does.
        let particles = &cloud.particles;
        let best = (particles.point[left.best], particles.normal[left.best]);
        let on_link = particles.link[left.best] as usize == link;
        let near = on_link && (best.0 - push.point).norm() < MOVED_ON;
        let other = near.then_some(Push { point: best.0, normal: best.1, ..push });
        let estimated = EstimatedPush {
            point: contact.point,
            normal: contact.normal,
            local: push.point,
            centre: on_link.then_some(particles.centre[left.best]),
        };
        found.residual = check.take_in(robot, &push, other.as_ref(), &estimated);
        found.explained = check.explained();
        // What is not explained is never sure, nor what has not been confirmed yet.
        found.estimate.ambiguous |= !check.trusted();
    }
}

/// Above this share of the torque that the best particle leaves over, the contact is looked for on the whole surface.
const REINITIALISE: f64 = 0.2;
/// Updates from one such search to the next: it costs as much as an update.
const PAUSE: u64 = 3;
/// A point that was sure and is farther off now, beyond its spread and the robot's motion, is another contact [m].
const MOVED_ON: f64 = 0.05;
