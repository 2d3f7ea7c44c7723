//! What is measured at one instant.

use crate::error::{Error, Result};
use crate::robot::Robot;

/// Shortest and longest time from one sample to the next (s).
const TIME_STEPS: std::ops::RangeInclusive<f64> = 1e-9..=LONGEST_STEP;
pub(crate) const LONGEST_STEP: f64 = 1e9;

/// What the sensors of a robot say at one instant: the argument of every call a control tick.
///
/// All vectors are in the order of the robot's joints. A call checks them before it changes anything.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::observer::MomentumObserver;
/// use contactsense::robot::Robot;
/// use contactsense::Sample;
///
/// let mut observer = MomentumObserver::new(Arc::new(Robot::example_arm()), 1e-3, &[50.0])?;
/// let (q, v, tau, friction) = ([0.0; 7], [0.0; 7], [0.5; 7], [0.5; 7]);
/// observer.update(&Sample::new(&q, &v, &tau).friction(&friction))?;
/// let torque = observer.update(&Sample::new(&q, &v, &tau).friction(&friction).dt(1.2e-3))?;
/// assert!(torque.iter().all(|torque| torque.abs() < 1e-12));
///
/// let error = observer.update(&Sample::new(&q, &v[1..], &tau)).unwrap_err();
/// assert_eq!(error.to_string(), "v: expected 7 numbers, got 6");
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<'a> {
    pub(crate) q: &'a [f64],
    pub(crate) v: &'a [f64],
    pub(crate) tau: &'a [f64],
    pub(crate) friction: Option<&'a [f64]>,
    pub(crate) wrenches: &'a [Option<[f64; 6]>],
    pub(crate) dt: Option<f64>,
}

impl<'a> Sample<'a> {
    /// The configuration `q` `(nq,)`, the velocity `v` `(nv,)` and the motors' torque `tau`, `(nv,)` or `(nv - 6,)` for a
    /// floating base: at this instant, or better the mean of what was held before and after it.
    pub fn new(q: &'a [f64], v: &'a [f64], tau: &'a [f64]) -> Self {
        Sample { q, v, tau, friction: None, wrenches: &[], dt: None }
    }

    /// With torques of friction, shaped as `tau`, which are subtracted from it.
    #[must_use]
    pub fn friction(self, friction: &'a [f64]) -> Self {
        Sample { friction: Some(friction), ..self }
    }

    /// With the readings of the force/torque sensors, in their order and axes (N, Nm); none where a sensor has no reading.
    #[must_use]
    pub fn wrenches(self, wrenches: &'a [Option<[f64; 6]>]) -> Self {
        Sample { wrenches, ..self }
    }

    /// With the time since the last sample that was accepted (s), where it is measured.
    #[must_use]
    pub fn dt(self, dt: f64) -> Self {
        Sample { dt: Some(dt), ..self }
    }

    /// Checks all but the readings, whose number the robot does not know.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) names the part.
    #[inline]
    pub(crate) fn check(&self, robot: &Robot) -> Result<()> {
        if let Some(dt) = self.dt {
            check_time_step(dt)?;
        }
        robot.check_configuration(self.q)?;
        robot.check_tangent("v", self.v)?;
        robot.check_torque("tau", self.tau)?;
        self.friction.map_or(Ok(()), |friction| robot.check_torque("friction", friction))
    }
}

/// What is measured at one instant where the robot's controller estimates the external torque itself: the argument of
/// [`ContactMonitor::update_external`](crate::monitor::ContactMonitor::update_external).
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::monitor::{ContactMonitor, MonitorOptions};
/// use contactsense::robot::Robot;
/// use contactsense::ExternalSample;
///
/// let mut monitor = ContactMonitor::new(Arc::new(Robot::example_arm()), &MonitorOptions::new(1e-3))?;
/// let (q, v, tau_ext) = ([0.0; 7], [0.1; 7], [0.2; 7]);
/// let report = monitor.update_external(&ExternalSample::new(&q, &tau_ext).velocity(&v).dt(1.2e-3))?;
/// assert_eq!(report.external_torque, tau_ext);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExternalSample<'a> {
    pub(crate) q: &'a [f64],
    pub(crate) tau_ext: &'a [f64],
    pub(crate) v: Option<&'a [f64]>,
    pub(crate) wrenches: &'a [Option<[f64; 6]>],
    pub(crate) dt: Option<f64>,
}

impl<'a> ExternalSample<'a> {
    /// The configuration `q` `(nq,)` and the external torque `tau_ext` `(nv,)`: that of forces on the robot, not on the world.
    pub fn new(q: &'a [f64], tau_ext: &'a [f64]) -> Self {
        ExternalSample { q, tau_ext, v: None, wrenches: &[], dt: None }
    }

    /// With the velocity `(nv,)`, where it is known: a robot without one is taken to move slowly.
    #[must_use]
    pub fn velocity(self, v: &'a [f64]) -> Self {
        ExternalSample { v: Some(v), ..self }
    }

    /// As [`Sample::wrenches`].
    #[must_use]
    pub fn wrenches(self, wrenches: &'a [Option<[f64; 6]>]) -> Self {
        ExternalSample { wrenches, ..self }
    }

    /// As [`Sample::dt`].
    #[must_use]
    pub fn dt(self, dt: f64) -> Self {
        ExternalSample { dt: Some(dt), ..self }
    }

    /// As [`Sample::check`].
    #[inline]
    pub(crate) fn check(&self, robot: &Robot) -> Result<()> {
        if let Some(dt) = self.dt {
            check_time_step(dt)?;
        }
        robot.check_configuration(self.q)?;
        robot.check_tangent("tau_ext", self.tau_ext)?;
        self.v.map_or(Ok(()), |v| robot.check_tangent("v", v))
    }
}

/// Refuses what cannot be the time from one sample to the next (s).
pub(crate) fn check_time_step(dt: f64) -> Result<()> {
    if TIME_STEPS.contains(&dt) {
        Ok(())
    } else {
        let (from, to) = (TIME_STEPS.start(), TIME_STEPS.end());
        Err(Error::input("dt", format!("must lie between {from:e} and {to:e} s, not {dt}")))
    }
}
