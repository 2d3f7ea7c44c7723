//! How large the errors of an external torque are: the one meaning of noise for detection, isolation and posteriors.

use std::ops::Range;

use nalgebra::{DMatrix, DVector, Vector6};

use crate::error::{Error, Result};
use crate::robot::{Robot, LARGEST};
use crate::sample::check_time_step;

/// Errors of the external torque of the untouched robot, each as one standard deviation: one number for all velocity
/// variables, or one for each.
///
/// ```
/// use contactsense::isolation::{ContactIsolator, IsolatorOptions};
/// use contactsense::robot::Robot;
/// use contactsense::NoiseModel;
///
/// // Torques that are 0.2 Nm off at rest and err by 5 % of what a contact causes.
/// let noise = NoiseModel { torque: vec![0.05], model: vec![0.2], relative: vec![0.05], ..NoiseModel::default() };
/// let options = IsolatorOptions { noise: Some(noise), torque_threshold: None, ..IsolatorOptions::default() };
/// assert!(ContactIsolator::new(Robot::example_arm().into(), &options).is_ok());
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct NoiseModel {
    /// White noise of the torque, per sample (Nm; N for sliding joints).
    pub torque: Vec<f64>,
    /// White noise of the velocity, per sample (rad/s; m/s for sliding joints). It acts through the gain of an observer and
    /// the mass matrix; what is given an external torque, as the isolator and the filter are, leaves it out.
    pub velocity: Vec<f64>,
    /// Share of the contact's own torque.
    pub relative: Vec<f64>,
    /// Slow errors left over: bias, friction, masses (Nm; N for sliding joints).
    pub model: Vec<f64>,
    /// Time over which these change (s).
    pub model_time: Vec<f64>,
    /// Errors of friction while a joint starts, stops or turns round (Nm; N for sliding joints).
    pub friction: Vec<f64>,
    /// What the bias differs by from one start to the next: gears keep a part of their load, sensors drift (Nm; N for sliding
    /// joints).
    pub bias: Vec<f64>,
    /// Step between two positions that an encoder counts (rad; m for sliding joints), no standard deviation: a joint that
    /// starts to move within it still seems to stand.
    pub position_step: Vec<f64>,
}

impl Default for NoiseModel {
    fn default() -> Self {
        NoiseModel {
            torque: vec![0.05],
            velocity: vec![0.0],
            relative: vec![0.03],
            model: vec![0.1],
            model_time: vec![1.0],
            friction: vec![0.0],
            bias: vec![0.0],
            position_step: vec![0.0],
        }
    }
}

/// A torque at rest is no noise beyond so many standard deviations: that many are a threshold.
pub(crate) const LEVEL: f64 = 3.0;
/// Every joint also errs by this share of the relative error of the torque that is largest: gears and flexible links pass on
/// what their neighbours feel.
const LARGEST_SHARE: f64 = 0.1;

impl NoiseModel {
    /// White noise of a torque at rest and a share of the torque: all that most callers know.
    pub(crate) fn short(torque: Vec<f64>, relative: f64) -> Self {
        NoiseModel { torque, relative: vec![relative], model: vec![0.0], ..NoiseModel::default() }
    }

    /// The covariance of the external torque of the untouched robot at `q` behind an observer of a `gain` (1/s) that is called
    /// every `dt` (s), `(nv, nv)` (Nm squared): white noise of the torque is averaged, white noise of the velocity passes
    /// through gain and mass matrix, and slow errors pass as far as the observer follows them (algorithm D1).
    ///
    /// # Errors
    /// [`Error::Input`] names the field or argument.
    pub fn covariance(&self, robot: &Robot, q: &[f64], gain: f64, dt: f64) -> Result<DMatrix<f64>> {
        Ok(self.parts(robot, q, gain, dt)?.into_iter().map(|(part, _)| part).sum())
    }

    /// Over which time (s) the errors of each velocity variable stay alike, `(nv,)`: as independent as samples so far apart.
    ///
    /// # Errors
    /// [`Error::Input`] names the field or argument.
    pub fn correlation_time(&self, robot: &Robot, q: &[f64], gain: f64, dt: f64) -> Result<Vec<f64>> {
        Ok(self.variance_and_time(robot, q, gain, dt)?.1)
    }

    /// The diagonal of the covariance (Nm squared) and the correlation times (s), both `(nv,)`.
    pub(crate) fn variance_and_time(
        &self,
        robot: &Robot,
        q: &[f64],
        gain: f64,
        dt: f64,
    ) -> Result<(Vec<f64>, Vec<f64>)> {
        let parts = self.parts(robot, q, gain, dt)?;
        let of_joint = |k: usize| {
            let variance: f64 = parts.iter().map(|(part, _)| part[(k, k)]).sum();
            let sum: f64 = parts.iter().map(|(part, times)| part[(k, k)] * times[k]).sum();
            (variance, if variance > 0.0 { sum / variance } else { 0.0 })
        };
        Ok((0..robot.nv()).map(of_joint).unzip())
    }

    /// What torque, velocity and slow errors add to the covariance, and the correlation time of each part.
    fn parts(&self, robot: &Robot, q: &[f64], gain: f64, dt: f64) -> Result<[(DMatrix<f64>, Vec<f64>); 3]> {
        self.check()?;
        check_time_step(dt)?;
        if !(gain > 0.0 && gain < LARGEST) {
            return Err(Error::input("gain", format!("must be positive [1/s], not {gain}")));
        }
        let squares = |name, values: &[f64]| {
            let values = robot.per_velocity(name, values)?;
            Ok(DVector::from_vec(values.into_iter().map(|x| x * x).collect()))
        };
        let times = robot.per_velocity("noise.model_time", &self.model_time)?;
        let (torque, model) = (squares("noise.torque", &self.torque)?, squares("noise.model", &self.model)?);
        let mass = robot.mass_matrix(q)?;
        let velocity = DMatrix::from_diagonal(&squares("noise.velocity", &self.velocity)?);
        let shares: Vec<f64> = times.iter().map(|time| Self::model_share(gain, *time)).collect();
        let model = model.component_mul(&DVector::from_vec(shares));
        let lag = 1.0 / gain;
        let slow = times.into_iter().map(|time| time + lag).collect();
        Ok([
            (DMatrix::from_diagonal(&(torque * Self::torque_share(gain, dt))), vec![lag; robot.nv()]),
            (&mass * velocity * &mass * Self::velocity_share(gain, dt), vec![dt; robot.nv()]),
            (DMatrix::from_diagonal(&model), slow),
        ])
    }

    /// What an observer of a `gain` (1/s), called every `dt` (s), leaves of the variance of the torque's white noise.
    pub(crate) fn torque_share(gain: f64, dt: f64) -> f64 {
        0.5 * (1.0 - (-gain * dt).exp())
    }

    /// What it makes of the variance of white noise of the momentum (1/s^2).
    pub(crate) fn velocity_share(gain: f64, dt: f64) -> f64 {
        let decay = (-gain * dt).exp();
        2.0 * ((1.0 - decay) / dt).powi(2) / (1.0 + decay)
    }

    /// What it leaves of the variance of errors that change over `time` (s).
    pub(crate) fn model_share(gain: f64, time: f64) -> f64 {
        gain * time / (1.0 + gain * time)
    }

    /// Whether every number can be a standard deviation.
    ///
    /// # Errors
    /// [`Error::Input`] names the field.
    pub fn check(&self) -> Result<()> {
        for (name, values) in [
            ("torque", &self.torque),
            ("velocity", &self.velocity),
            ("relative", &self.relative),
            ("model", &self.model),
            ("model_time", &self.model_time),
            ("friction", &self.friction),
            ("bias", &self.bias),
            ("position_step", &self.position_step),
        ] {
            if let Some(value) = values.iter().find(|x| !(0.0..LARGEST).contains(*x)) {
                return Err(Error::input(name, format!("must be finite and not negative, not {value}")));
            }
        }
        Ok(())
    }

    /// For one robot, by velocity variable.
    ///
    /// # Errors
    /// [`Error::Input`] names the field, or `robot` where it has no torques.
    pub(crate) fn of(&self, robot: &Robot) -> Result<TorqueNoise> {
        robot.check_moves()?;
        self.check()?;
        robot.per_velocity("noise.velocity", &self.velocity)?;
        robot.per_velocity("noise.model_time", &self.model_time)?;
        robot.per_velocity("noise.friction", &self.friction)?;
        robot.per_velocity("noise.bias", &self.bias)?;
        robot.per_velocity("noise.position_step", &self.position_step)?;
        let torque = robot.per_velocity("noise.torque", &self.torque)?;
        let model = robot.per_velocity("noise.model", &self.model)?;
        let relative = robot.per_velocity("noise.relative", &self.relative)?;
        let at_rest: Vec<f64> =
            torque.iter().zip(&model).map(|(torque, model)| torque.hypot(*model)).collect();
        if at_rest.contains(&0.0) {
            return Err(Error::input("noise.torque", "must be positive where noise.model is zero"));
        }
        let joints = 0..at_rest.len();
        Ok(TorqueNoise { at_rest, relative, largest_share: LARGEST_SHARE, groups: vec![joints] })
    }
}

/// The noise of one robot's external torque, by velocity variable.
#[derive(Debug, Clone)]
pub(crate) struct TorqueNoise {
    at_rest: Vec<f64>,
    relative: Vec<f64>,
    largest_share: f64,
    /// Rows that err by a share of the largest one of them: the joints, then the force and the moment of each sensor.
    groups: Vec<Range<usize>>,
}

/// What the wrench of a force/torque sensor errs by, relative to its force or moment: a hundredth, which data sheets state.
pub(crate) const SENSOR_RELATIVE: f64 = 0.01;

impl TorqueNoise {
    /// With the wrenches of sensors as further rows, of these standard deviations without contact (N, Nm).
    pub fn with_sensors(mut self, deviations: impl Iterator<Item = Vector6<f64>>) -> Self {
        for deviation in deviations {
            for part in [0..3, 3..6] {
                let first = self.at_rest.len();
                self.at_rest.extend_from_slice(&deviation.as_slice()[part]);
                self.relative.resize(self.at_rest.len(), SENSOR_RELATIVE);
                self.groups.push(first..self.at_rest.len());
            }
        }
        self
    }

    /// The same where no joint errs by what another one feels.
    pub fn without_coupling(self) -> Self {
        TorqueNoise { largest_share: 0.0, ..self }
    }

    /// Standard deviations where nothing touches (Nm).
    pub fn at_rest(&self) -> &[f64] {
        &self.at_rest
    }

    /// What a torque at rest does not exceed (Nm).
    pub fn threshold(&self) -> Vec<f64> {
        self.at_rest.iter().map(|deviation| LEVEL * deviation).collect()
    }

    /// So many standard deviations of the part of the errors that grows with the contact's torque, on velocity variable
    /// `k` (Nm); `largest` is the magnitude of the largest torque.
    #[inline]
    pub fn growing(&self, k: usize, level: f64, torque: f64, largest: f64) -> f64 {
        let share = level * self.relative[k];
        (share * torque).hypot(share * self.largest_share * largest)
    }

    /// Sets the standard deviation of each torque (Nm).
    pub fn set_deviations(&self, torque: &[f64], deviations: &mut [f64]) {
        self.set_deviations_beside(&self.at_rest, torque, deviations);
    }

    /// The same where the standard deviations without contact are others.
    pub fn set_deviations_beside(&self, at_rest: &[f64], torque: &[f64], deviations: &mut [f64]) {
        for group in &self.groups {
            let largest = largest(&torque[group.clone()]);
            for k in group.clone() {
                deviations[k] = self.growing(k, 1.0, torque[k], largest).hypot(at_rest[k]);
            }
        }
    }
}

/// The magnitude of the largest torque.
#[inline]
pub(crate) fn largest(torque: &[f64]) -> f64 {
    torque.iter().fold(0.0_f64, |largest, torque| largest.max(torque.abs()))
}
