//! Observer, bias, detection and isolation on one kinematics pass.

use std::sync::Arc;

use super::bias::BiasTracker;
use super::release::ReleaseDetector;
use crate::detection::Detector;
use crate::error::{Error, Result};
use crate::isolation::{ContactIsolator, Isolation, IsolatorOptions};
use crate::observer::MomentumObserver;
use crate::robot::Robot;

/// Settings of a [`ContactMonitor`].
#[derive(Debug, Clone)]
pub struct MonitorOptions {
    /// Time between two calls [s].
    pub dt: f64,
    /// Per velocity variable, or one for all [1/s].
    pub observer_gain: Vec<f64>,
    /// Thresholds, number of contacts, pushing.
    pub isolation: IsolatorOptions,
    /// A signal stays on for this time after it was last over its threshold [s].
    pub hold_time: f64,
    /// Time constant of the bias that is tracked while nothing touches [s]; none for no tracking.
    pub bias_time_constant: Option<f64>,
    /// With bias tracking: a torque that stands still for this long is no contact, whatever its size [s]; none: a
    /// contact may last for ever.
    pub bias_settle_time: Option<f64>,
}

/// What the monitor says of one tick.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ContactReport {
    /// Since the first call [s].
    pub time: f64,
    /// Whether there is a contact.
    pub collision: bool,
    /// Whether it began with this tick.
    pub onset: bool,
    /// Region that detection alone gives: indices into [`Robot::links`].
    pub links: Vec<usize>,
    /// Bias-free external torque `(nv,)`.
    pub external_torque: Vec<f64>,
    /// Estimated acceleration `(nv,)`.
    pub acceleration: Vec<f64>,
    /// The contacts.
    pub isolation: Isolation,
}

/// The sense of touch of one robot, called once a control tick.
#[derive(Debug, Clone)]
pub struct ContactMonitor {
    robot: Arc<Robot>,
    dt: f64,
    observer: MomentumObserver,
    bias: Option<BiasTracker>,
    release: ReleaseDetector,
    detector: Detector,
    isolator: ContactIsolator,
    ticks: u64,
    external_torque: Vec<f64>,
}

impl ContactMonitor {
    /// A monitor for a robot.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the option.
    pub fn new(robot: Arc<Robot>, options: &MonitorOptions) -> Result<Self> {
        let nv = robot.nv();
        if let Some(time) = options.bias_settle_time.filter(|time| !(time.is_finite() && *time > 0.0)) {
            return Err(Error::Input(format!(
                "bias_settle_time: must be positive and finite [s], or none, not {time}"
            )));
        }
        Ok(Self {
            observer: MomentumObserver::new(robot.clone(), options.dt, &options.observer_gain)?,
            bias: options.bias_time_constant.map(|constant| BiasTracker::new(nv, constant)).transpose()?,
            release: ReleaseDetector::new(nv, options.bias_settle_time),
            detector: Detector::new(robot.clone(), &options.isolation.torque_threshold, options.hold_time)?,
            isolator: ContactIsolator::new(robot.clone(), &options.isolation)?,
            dt: options.dt,
            ticks: 0,
            external_torque: vec![0.0; nv],
            robot,
        })
    }

    /// One control tick. `tau` and `friction` are `(nv,)`, or `(nv - 6,)` for a floating base.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the argument; the state is then unchanged.
    pub fn update(&mut self, q: &[f64], v: &[f64], tau: &[f64], friction: Option<&[f64]>) -> Result<()> {
        let first = self.ticks == 0;
        self.external_torque.copy_from_slice(self.observer.update(q, v, tau, friction, None)?);
        self.ticks += 1;
        let ready = self.remove_bias(first);
        if ready {
            self.detector.update(&self.external_torque, self.dt);
        }
        if self.detector.collision() {
            self.isolator.isolate_at(self.observer.kinematics(), &self.external_torque);
        } else {
            self.isolator.clear();
        }
        Ok(())
    }

    /// Subtracts the bias, which follows the torque while nothing touches. False during its first average.
    fn remove_bias(&mut self, first: bool) -> bool {
        let Some(bias) = &mut self.bias else { return true };
        let ready = bias.ready();
        let threshold = self.detector.threshold();
        let over = |((torque, bias), threshold): ((&f64, &f64), &f64)| (torque - bias).abs() > *threshold;
        let touched = ready
            && (self.detector.collision()
                || self.external_torque.iter().zip(bias.bias()).zip(threshold).any(over));
        if touched {
            if self.release.update(&self.external_torque, bias.bias(), threshold, self.dt) {
                bias.set(self.release.remainder());
                self.release.reset();
                self.detector.reset();
            }
        } else {
            self.release.reset();
            // The first call has no torque yet.
            if !first {
                bias.follow(&self.external_torque, self.dt);
            }
        }
        self.external_torque.iter_mut().zip(bias.bias()).for_each(|(torque, bias)| *torque -= bias);
        ready
    }

    /// The last tick's report.
    pub fn report(&mut self) -> ContactReport {
        let mut report = ContactReport::default();
        self.report_into(&mut report);
        report
    }

    /// Writes the last tick's report into `report`, whose buffers are reused.
    pub fn report_into(&mut self, report: &mut ContactReport) {
        report.time = self.time();
        report.collision = self.detector.collision();
        report.onset = self.detector.onset();
        report.links.clear();
        report.links.extend_from_slice(self.detector.links());
        report.external_torque.clone_from(&self.external_torque);
        report.acceleration.clear();
        report.acceleration.extend_from_slice(self.observer.acceleration());
        report.isolation.clone_from(self.isolator.isolation());
    }

    /// Forgets all ticks, the bias too.
    pub fn reset(&mut self) {
        self.observer.reset();
        self.detector.reset();
        self.isolator.clear();
        self.external_torque.fill(0.0);
        self.ticks = 0;
        self.release.reset();
        if let Some(bias) = &mut self.bias {
            bias.reset();
        }
    }

    /// Since the first call [s].
    pub fn time(&self) -> f64 {
        self.ticks.saturating_sub(1) as f64 * self.dt
    }

    /// The robot watched.
    pub fn robot(&self) -> &Arc<Robot> {
        &self.robot
    }
}
