//! Observer, bias, detection and isolation on one kinematics pass.

use std::sync::Arc;

use super::bias::BiasTracker;
use super::clock::SampleClock;
use super::limits::JointLimits;
use super::options::{of_observer, MonitorOptions};
use super::recent_motion::RecentMotion;
use super::report::ContactReport;
use super::rest_readings::RestReadings;
use super::sensing::Sensing;
use super::source::{signal_of, Source};
use crate::detection::{ContactTest, Detector, FreeDirections, Load, ReleaseDetector, Whitening};
use crate::error::{Error, Result};
use crate::isolation::ContactIsolator;
use crate::observer::{MomentumObserver, Step};
use crate::robot::Robot;
use crate::sample::Sample;
use crate::sensor::{ForceTorqueSensor, SensorIndex, SensorTree};
use crate::tracking::{ContactTracker, TickEvidence};

/// The sense of touch of one robot, called once a control tick.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::monitor::{ContactMonitor, MonitorOptions};
/// use contactsense::robot::Robot;
/// use contactsense::Sample;
///
/// let robot = Arc::new(Robot::example_arm());
/// let (q, v) = (vec![0.4; 7], vec![0.0; 7]);
/// let weight = robot.inverse_dynamics(&q, &v, &v)?;
/// let mut monitor = ContactMonitor::new(robot, &MonitorOptions::new(1e-3))?;
/// for _ in 0..100 {
///     let report = monitor.update(&Sample::new(&q, &v, &weight))?;
///     assert!(!report.collision);
/// }
///
/// let pushed: Vec<f64> = weight.iter().map(|tau| tau - 3.0).collect();
/// for _ in 0..100 {
///     monitor.update(&Sample::new(&q, &v, &pushed))?;
/// }
/// assert!(monitor.report().collision);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ContactMonitor {
    pub(super) robot: Arc<Robot>,
    /// The same without the payload.
    pub(super) unloaded: Arc<Robot>,
    pub(super) payload: Option<Load>,
    pub(super) clock: SampleClock,
    /// Of the torques since the first accepted call.
    pub(super) source: Option<Source>,
    pub(super) observer: MomentumObserver,
    pub(super) bias: Option<BiasTracker>,
    /// What was tared where no bias is followed.
    pub(super) fixed_bias: Option<Vec<f64>>,
    pub(super) rest: RestReadings,
    pub(super) recent: RecentMotion,
    /// Of all joints at once, with a bias of its own; none where each joint has a threshold.
    pub(super) test: Option<ContactTest>,
    /// Of each joint (Nm, N).
    pub(super) threshold: Vec<f64>,
    /// Standard deviations of the external torque at rest, where all joints are not tested at once (Nm, N).
    pub(super) deviation: Vec<f64>,
    /// The thresholds as a covariance.
    pub(super) scale: Whitening,
    pub(super) limits: JointLimits,
    pub(super) free: FreeDirections,
    pub(super) release: ReleaseDetector,
    pub(super) detector: Detector,
    pub(super) isolator: ContactIsolator,
    /// None where `samples` is zero, and with wanted points.
    pub(super) tracker: Option<ContactTracker>,
    pub(super) sensing: Option<Sensing>,
    pub(super) options: MonitorOptions,
    pub(super) report: ContactReport,
}

impl ContactMonitor {
    /// A monitor for a robot.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the option.
    pub fn new(robot: Arc<Robot>, options: &MonitorOptions) -> Result<Self> {
        let nv = robot.nv();
        let observer = match &options.calibration {
            Some(calibration) => {
                MomentumObserver::calibrated(&robot, options.dt, &options.observer_gain, calibration)
            }
            None => MomentumObserver::new(robot, options.dt, &options.observer_gain),
        };
        let observer = observer.map_err(of_observer)?;
        let robot = Arc::clone(observer.robot());
        let has_wanted = !options.isolation.wanted_contacts.is_empty();
        let (signal, gain) = signal_of(options, observer.gain());
        let of_test = if has_wanted { &signal } else { options };
        let test = of_test.contact_test(&robot, &gain, has_wanted)?;
        let options = &signal.with_calibrated_noise(&robot, &gain)?;
        let tree = SensorTree::new(&robot, &options.isolation.sensors)?;
        let (threshold, noise) = options.isolation.threshold_and_noise(&robot)?;
        let detector = Detector::new(
            robot.clone(),
            if test.is_some() { &[1.0] } else { &threshold },
            &tree,
            &options.isolation.wrench_threshold,
            options.hold_time,
        )?;
        let isolator = ContactIsolator::new(robot.clone(), &options.isolation)?;
        let tracker = options.tracker(&robot, (&tree, isolator.evidence()), &noise)?;
        let sensing = Sensing::new(
            &robot,
            tree,
            &options.isolation.wanted_contacts,
            observer.gain(),
            options.wrench_gain,
            options.dt,
        )?;
        let greatest_bias = options.greatest_bias(&threshold)?;
        let release = ReleaseDetector::new(
            options.release_rule(&robot, &options.release_threshold(&robot, &test, &threshold)?)?,
        );
        let bias_tracker = |constant| BiasTracker::new(constant, greatest_bias);
        let sensors = options.isolation.sensors.len();
        let mut monitor = Self {
            clock: SampleClock::new(options.dt),
            source: None,
            detector,
            release,
            sensing: (!options.isolation.sensors.is_empty()).then_some(sensing),
            bias: options.bias_time_constant.filter(|_| test.is_none()).map(bias_tracker).transpose()?,
            fixed_bias: None,
            rest: RestReadings::new(nv, sensors),
            recent: RecentMotion::new(robot.nq(), nv),
            free: FreeDirections::new(
                &robot,
                &options.wanted_points,
                observer.gain(),
                test.as_ref().map_or(&[], ContactTest::gains),
            )?,
            observer,
            test,
            scale: Whitening::of_deviations(&threshold),
            limits: JointLimits::new(&robot),
            threshold,
            deviation: noise.at_rest().to_vec(),
            report: ContactReport {
                links: Vec::with_capacity(robot.touchable_links().len()),
                external_torque: vec![0.0; nv],
                collision_torque: vec![0.0; nv],
                wrenches: Vec::with_capacity(sensors),
                sensors_left_out: Vec::with_capacity(sensors),
                joints_left_out: Vec::with_capacity(robot.joint_names().len()),
                limited_joints: Vec::with_capacity(robot.joint_names().len()),
                isolation: isolator.empty_answer(),
                ..ContactReport::default()
            },
            isolator,
            tracker,
            options: options.clone(),
            unloaded: Arc::clone(&robot),
            payload: None,
            robot,
        };
        monitor.finish_report();
        Ok(monitor)
    }

    /// One control tick; returns what it says. With sensors, the sample has their readings.
    ///
    /// The sample's `dt` is the time since the last that was accepted, where it is measured. Without it, that is the options'
    /// `dt`, and as much again for every sample refused in between. Over more than 50 ms, or five times the options' `dt`
    /// if that is longer, nothing is known of the mean torque: the external torque is then kept as it was.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the argument; the state is then unchanged but for the time that passed.
    pub fn update(&mut self, sample: &Sample<'_>) -> Result<&ContactReport> {
        if let Err(error) = self.check(sample) {
            self.miss(sample.dt);
            return Err(error);
        }
        self.source = Some(Source::Motors);
        let step = self.clock.step(sample.dt);
        let new = self.clock.started() && !step.is_gap();
        self.limits.set_configuration(sample.q);
        self.observer.advance(sample, step);
        self.note_motion(sample.q, step);
        self.clock.accept(sample.dt);
        self.sense(sample.wrenches, step);
        Ok(self.judge(step, new))
    }

    /// What torque and sensors say of contacts, after a step of the observer.
    pub(super) fn sense(&mut self, wrenches: &[Option<[f64; 6]>], step: Step) {
        let external_torque = self.observer.external_torque();
        self.report.external_torque.copy_from_slice(external_torque);
        self.report.collision_torque.copy_from_slice(external_torque);
        if let Some(sensing) = &mut self.sensing {
            let (threshold, dt) = (&self.threshold, self.clock.dt());
            sensing.update(&self.observer, wrenches, threshold, step, dt);
            let collision_torque = &mut self.report.collision_torque;
            if self.source == Some(Source::External) && sensing.has_wanted() {
                // The sensors' wrenches are means of a step.
                collision_torque.copy_from_slice(self.observer.unexplained().unwrap_or(external_torque));
            }
            let collision_torque = collision_torque.iter_mut();
            collision_torque.zip(sensing.wanted_torque()).for_each(|(torque, wanted)| *torque -= wanted);
        }
    }

    /// Bias, detection and isolation of what was sensed; `new` is false where the step brought no new torque.
    pub(super) fn judge(&mut self, step: Step, new: bool) -> &ContactReport {
        let length = step.length(self.clock.dt());
        let inward = self.limits.inward();
        self.free.set_pose(&self.robot, self.observer.kinematics(), inward, length, new);
        let felt = self.detector.sense(self.sensing.as_ref().map_or(&[], Sensing::unwanted));
        let mut detected = true;
        if self.test.is_some() {
            self.test_all_joints(step, new, felt);
        } else {
            detected = self.remove_bias(length, new, felt);
            if detected {
                self.detector.update(&self.report.collision_torque, length);
            }
        }
        if new {
            self.note_rest(length, detected);
        }
        if self.detector.collision() {
            self.isolate();
        } else {
            self.report.isolation.clear();
            self.tracker.iter_mut().for_each(ContactTracker::rest);
        }
        self.finish_report();
        &self.report
    }

    /// A tick whose sample never came to [`ContactMonitor::update`], `dt` (s) after the last that was accepted if that is
    /// measured: as if it had been refused.
    pub fn miss(&mut self, dt: Option<f64>) {
        self.clock.miss(dt);
    }

    /// The contacts behind the torque and the wrenches.
    fn isolate(&mut self) {
        let ContactReport { external_torque, collision_torque, .. } = &self.report;
        let torque = if self.free.has_points() { collision_torque } else { external_torque };
        let kinematics = self.observer.kinematics();
        self.isolator.leave_out(self.limits.inward(), external_torque);
        match &self.sensing {
            Some(sensing) => {
                let (wrenches, lag) = (sensing.trusted(), Some(sensing.wrenches()));
                self.isolator.isolate_at(kinematics, torque, wrenches, lag);
            }
            None => {
                self.isolator.isolate_at(kinematics, torque, &[], None);
            }
        }
        self.isolator.exchange(&mut self.report.isolation);
        let Self { tracker, test, observer, isolator, report, deviation, clock, sensing, .. } = self;
        let ContactReport { external_torque, collision_torque, isolation, .. } = report;
        let kinematics = observer.kinematics();
        let newest = if sensing.is_some() { &collision_torque[..] } else { &external_torque[..] };
        isolator.take_in(kinematics, (newest, deviation), sensing.as_ref().map(Sensing::without_wanted));
        let rows = isolator.evidence().at(kinematics);
        if let Some(tracker) = tracker {
            // A slower observer is behind the sensors.
            let (torque, deviation) = match test {
                Some(test) if sensing.is_none() => test.contact_signal(),
                _ => (rows.torque, rows.deviation),
            };
            let (newest, left_out, time) = (rows.torque, isolator.left_out(), clock.time());
            let evidence = TickEvidence { kinematics, torque, deviation, newest, left_out, time };
            tracker.follow(&evidence, isolation);
        }
        if let Some(sensing) = sensing {
            isolation.name_sources(sensing.tree());
        }
        isolator.determine_wrench(kinematics, isolation);
    }

    fn check(&self, sample: &Sample<'_>) -> Result<()> {
        self.check_source(Source::Motors)?;
        self.check_readings(sample.wrenches)?;
        sample.check(&self.robot)
    }

    pub(super) fn check_readings(&self, wrenches: &[Option<[f64; 6]>]) -> Result<()> {
        match &self.sensing {
            Some(sensing) => sensing.check_readings(wrenches),
            None if !wrenches.is_empty() => {
                Err(Error::input("wrenches", "the monitor was made without sensors"))
            }
            None => Ok(()),
        }
    }

    /// What the last tick said.
    pub fn report(&self) -> &ContactReport {
        &self.report
    }

    /// The estimated acceleration `(nv,)` at the last tick, as [`MomentumObserver::acceleration`] gives it.
    pub fn acceleration(&mut self) -> &[f64] {
        self.observer.acceleration()
    }

    /// Writes what the report has from the detector and the sensors.
    fn finish_report(&mut self) {
        let report = &mut self.report;
        report.time = self.clock.time();
        report.collision = self.detector.collision();
        report.onset = self.detector.onset();
        report.links.clear();
        report.links.extend_from_slice(self.detector.links());
        report.wrenches.clear();
        report.sensors_left_out.clear();
        report.joints_left_out.clear();
        report.limited_joints.clear();
        report.limited_joints.extend(self.limits.pushed(&report.external_torque, &self.threshold));
        if let Some(sensing) = &self.sensing {
            report.wrenches.extend_from_slice(sensing.external());
            let left_out = sensing.external().iter().enumerate().filter(|(_, wrench)| wrench.is_none());
            report.sensors_left_out.extend(left_out.map(|(sensor, _)| SensorIndex::new(sensor)));
            let is_blind = |body: &usize| sensing.blind()[self.robot.velocity_range(*body)].contains(&true);
            report.joints_left_out.extend((1..self.robot.body_count()).filter(is_blind).map(|body| body - 1));
        }
    }

    /// Forgets all ticks, the bias and the source of the torques too; the robot keeps its payload and the sensors their offsets.
    pub fn reset(&mut self) {
        self.forget_source();
        self.observer.reset();
        self.free.reset();
        self.detector.reset();
        self.report.isolation.clear();
        self.tracker.iter_mut().for_each(ContactTracker::reset);
        self.report.external_torque.fill(0.0);
        self.report.collision_torque.fill(0.0);
        if let Some(sensing) = &mut self.sensing {
            sensing.reset();
        }
        self.clock.reset();
        self.report.remainder_learned = false;
        self.release.reset();
        self.rest.reset();
        self.recent.reset();
        self.fixed_bias = None;
        if let Some(bias) = &mut self.bias {
            bias.reset();
        }
        if let Some(test) = &mut self.test {
            test.reset();
            self.report.significance = Some(0.0);
        }
        self.finish_report();
    }

    /// Since the first accepted call (s).
    pub fn time(&self) -> f64 {
        self.clock.time()
    }

    /// Time between two calls that is assumed where none is given (s).
    pub fn dt(&self) -> f64 {
        self.clock.dt()
    }

    /// The bias that is subtracted `(nv,)`; none without tracking, unless [`ContactMonitor::tare`] found one.
    pub fn bias(&self) -> Option<&[f64]> {
        let of_test = self.test.as_ref().map(|test| test.slow().bias());
        of_test.or_else(|| self.bias.as_ref().map(BiasTracker::bias)).or(self.fixed_bias.as_deref())
    }

    /// The sensors, with the offsets that are subtracted now.
    pub fn sensors(&self) -> &[ForceTorqueSensor] {
        self.sensing.as_ref().map_or(&[], |sensing| sensing.tree().sensors())
    }

    /// The sensors' names.
    pub fn sensor_names(&self) -> &[String] {
        self.sensing.as_ref().map_or(&[], |sensing| sensing.tree().names())
    }

    /// The robot watched, with its payload.
    pub fn robot(&self) -> &Arc<Robot> {
        &self.robot
    }
}
