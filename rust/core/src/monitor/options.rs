//! Settings of the monitor.

use std::sync::Arc;

use crate::calibration::Calibration;
use crate::detection::{ContactTest, ReleaseRule, FOLLOW_TIME};
use crate::error::{Error, Result};
use crate::isolation::{ContactEvidence, IsolatorOptions, SurfaceContact, SAMPLES};
use crate::map::MapOptions;
use crate::robot::Robot;
use crate::sensor::SensorTree;
use crate::torque::TorqueNoise;
use crate::tracking::ContactTracker;

/// Settings of a [`ContactMonitor`](super::ContactMonitor).
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::monitor::{ContactMonitor, MonitorOptions};
/// use contactsense::robot::Robot;
///
/// // A model that is a little off: its error is learnt within some seconds without contact.
/// let mut options = MonitorOptions { bias_time_constant: Some(1.0), ..MonitorOptions::new(1e-3) };
/// options.isolation.torque_threshold = Some(vec![2.0]);
/// let monitor = ContactMonitor::new(Arc::new(Robot::example_arm()), &options)?;
/// assert_eq!((monitor.dt(), monitor.bias()), (1e-3, Some(&[0.0; 7][..])));
///
/// options.isolation.torque_threshold = Some(vec![2.0, 1.0]);
/// assert!(ContactMonitor::new(Arc::new(Robot::example_arm()), &options).is_err());
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct MonitorOptions {
    /// Time between two calls (s).
    pub dt: f64,
    /// Per velocity variable, or one for all (1/s).
    pub observer_gain: Vec<f64>,
    /// What contact-free motion taught of the robot: corrects measurements and inertias, and gives thresholds and noise
    /// where `isolation` has none.
    pub calibration: Option<Calibration>,
    /// Of the low-pass on the sensors' external wrenches (1/s), infinite for no low-pass. If none, the
    /// observer's smallest, and no low-pass where that is at least half the tick rate.
    pub wrench_gain: Option<f64>,
    /// Thresholds, number of contacts, pushing, sensors.
    pub isolation: IsolatorOptions,
    /// Links and points on them, in their frames (m), at which contacts are meant that no sensor measures: a force there is
    /// no collision.
    #[cfg_attr(feature = "serde", serde(default))]
    pub wanted_points: Vec<(String, [f64; 3])>,
    /// A signal stays on for this time after it was last over its threshold (s).
    pub hold_time: f64,
    /// Time constant of the bias that is tracked while nothing touches (s); none for no tracking, or 3 s where all joints are
    /// tested at once: there is a calibration and no `torque_threshold`.
    pub bias_time_constant: Option<f64>,
    /// Greatest bias of each joint, in its thresholds; infinite for no limit. A model that is farther off must be mended.
    pub bias_limit: f64,
    /// With bias tracking: a torque that stands still for this long is no contact, whatever its size within `bias_limit`
    /// (s); none: a contact may last for ever.
    pub bias_settle_time: Option<f64>,
    /// With bias tracking: the share of its greatest torque in a contact that a joint's gear or sensor may keep after it.
    /// Per velocity variable, or one for all.
    pub hysteresis: Vec<f64>,
    /// Samples of the surface by which the place of a contact is found where closed forms do not determine it; zero for closed
    /// forms only. Not with wanted points.
    #[cfg_attr(feature = "serde", serde(default = "crate::isolation::samples"))]
    pub samples: usize,
}

/// A bias of more thresholds than this is taken for a fault of the set-up: a wrong sign of `tau`, a missing tool. Real arms
/// show up to twelve.
const BIAS_LIMIT: f64 = 30.0;
/// Gears and sensors keep some per cent of what loaded them; torques from motor currents up to 20 %.
const HYSTERESIS: f64 = 0.2;

impl MonitorOptions {
    /// The defaults, for calls every `dt` (s).
    pub fn new(dt: f64) -> Self {
        Self {
            dt,
            observer_gain: vec![50.0],
            calibration: None,
            wrench_gain: None,
            isolation: IsolatorOptions {
                torque_threshold: Some(vec![0.5]),
                wrench_threshold: vec![2.0],
                // The monitor follows contacts by samples of its own.
                samples: 0,
                ..IsolatorOptions::default()
            },
            wanted_points: vec![],
            hold_time: 0.02,
            bias_time_constant: None,
            bias_limit: BIAS_LIMIT,
            bias_settle_time: None,
            hysteresis: vec![HYSTERESIS],
            samples: SAMPLES,
        }
    }

    /// The test of all joints at once, where there is a calibration and no threshold for single joints. `gain` `(nv,)` is the
    /// observer's; `one_torque`: only that observer's torque is looked at.
    pub(super) fn contact_test(
        &self,
        corrected: &Arc<Robot>,
        gain: &[f64],
        one_torque: bool,
    ) -> Result<Option<ContactTest>> {
        let Some(calibration) =
            self.calibration.as_ref().filter(|_| self.isolation.torque_threshold.is_none())
        else {
            return Ok(None);
        };
        let time = self.bias_time_constant.unwrap_or(FOLLOW_TIME);
        check_time_constant(time)?;
        let variances = calibration.noise.variances(corrected)?;
        let (robot, nv) = (Arc::clone(corrected), corrected.nv());
        let levels = calibration.levels(nv, self.dt);
        let model_errors = &calibration.model_errors[..];
        Ok(Some(if one_torque || levels.is_empty() {
            let level = calibration.level_at(nv, gain, self.dt);
            ContactTest::of_one_torque(robot, &variances, self.dt, gain, level, model_errors, time)
        } else {
            ContactTest::new(robot, &variances, self.dt, &levels, model_errors, time)
        }))
    }

    /// What finds places of contacts by samples of the surface, with the noise of the torques and wrenches. Torques that wanted
    /// points share are left to closed forms.
    ///
    /// # Errors
    /// [`Error::Input`] names the option.
    pub(super) fn tracker(
        &self,
        robot: &Arc<Robot>,
        sensed: (&SensorTree, &ContactEvidence),
        noise: &TorqueNoise,
    ) -> Result<Option<ContactTracker>> {
        if self.samples == 0 || !self.wanted_points.is_empty() {
            return Ok(None);
        }
        let options = MapOptions { samples: self.samples, ..MapOptions::default() };
        let locate_within = self.isolation.locate_within;
        let surface = SurfaceContact::new(Arc::clone(robot), &options, sensed, noise.clone(), locate_within)?;
        Ok(surface.map(|surface| ContactTracker::new(Arc::clone(robot), surface)))
    }

    /// With the noise and the offsets of sensors of the calibration, and thresholds for its rate of false alarms, where none
    /// are given; `gain` `(nv,)` is the observer's.
    pub(super) fn with_calibrated_noise(&self, corrected: &Robot, gain: &[f64]) -> Result<Self> {
        let mut options = self.clone();
        if let Some(calibration) = &self.calibration {
            let (noise, threshold) = calibration.noise_and_threshold(corrected, gain, self.dt)?;
            options.isolation.sensors = calibration.sensors_with_offsets(&self.isolation.sensors);
            options.isolation.noise.get_or_insert(noise);
            options.isolation.torque_threshold.get_or_insert(threshold);
        }
        Ok(options)
    }

    /// The thresholds `(nv,)` for the end of a contact: those of the slowest gain of a test, which sees more than one at the
    /// observer's gain.
    pub(super) fn release_threshold(
        &self,
        corrected: &Robot,
        test: &Option<ContactTest>,
        threshold: &[f64],
    ) -> Result<Vec<f64>> {
        match (&self.calibration, test.as_ref().and_then(|test| test.gains().first())) {
            (Some(calibration), Some(gain)) => {
                let (_, threshold) =
                    calibration.noise_and_threshold(corrected, &vec![*gain; corrected.nv()], self.dt)?;
                Ok(threshold)
            }
            _ => Ok(threshold.to_vec()),
        }
    }

    /// The rule for the end of a contact, with checked thresholds `(nv,)`.
    pub(super) fn release_rule(&self, robot: &Robot, threshold: &[f64]) -> Result<ReleaseRule> {
        if let Some(time) = self.bias_settle_time.filter(|time| !(time.is_finite() && *time > 0.0)) {
            return Err(Error::input(
                "bias_settle_time",
                format!("must be positive and finite [s], or none, not {time}"),
            ));
        }
        let hysteresis = robot.per_velocity("hysteresis", &self.hysteresis)?;
        if let Some(share) = hysteresis.iter().find(|share| !(0.0..1.0).contains(*share)) {
            return Err(Error::input(
                "hysteresis",
                format!("must be a share from 0 to below 1, not {share}"),
            ));
        }
        Ok(ReleaseRule {
            settle_time: self.bias_settle_time,
            hysteresis,
            threshold: threshold.to_vec(),
            is_force: robot.forces(),
        })
    }

    /// Greatest bias of each joint (Nm, N), with checked thresholds `(nv,)`.
    pub(super) fn greatest_bias(&self, threshold: &[f64]) -> Result<Vec<f64>> {
        if self.bias_limit.is_nan() || self.bias_limit <= 0.0 {
            return Err(Error::input(
                "bias_limit",
                format!("must be positive, in thresholds, not {}", self.bias_limit),
            ));
        }
        Ok(threshold.iter().map(|threshold| self.bias_limit * threshold).collect())
    }
}

/// Whether a bias can be followed with a time constant (s).
pub(super) fn check_time_constant(time: f64) -> Result<()> {
    if time.is_finite() && time > 0.0 {
        return Ok(());
    }
    Err(Error::input("bias_time_constant", format!("must be positive and finite [s], not {time}")))
}

/// An error of the observer's gain, by its name here.
pub(super) fn of_observer(error: Error) -> Error {
    match error {
        Error::Input { argument, problem } if argument == "gain" => Error::input("observer_gain", problem),
        other => other,
    }
}
