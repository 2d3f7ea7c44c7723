//! The noise model of one robot as variances, by velocity variable.

use super::NoiseModel;
use crate::error::Result;
use crate::robot::Robot;

/// Variances of the errors of the untouched robot's external torque.
#[derive(Debug, Clone)]
pub(crate) struct ErrorVariances {
    /// White noise of the torque (Nm squared).
    pub torque: Vec<f64>,
    /// White noise of the velocity, as standard deviations (rad/s).
    pub velocity: Vec<f64>,
    /// Step between two positions that are counted (rad).
    pub position_step: Vec<f64>,
    /// Of friction while a joint starts or stops (Nm squared).
    pub friction: Vec<f64>,
    pub slow: SlowNoise,
}

/// Variances of slow errors.
#[derive(Debug, Clone)]
pub(crate) struct SlowNoise {
    /// (Nm squared).
    pub model: Vec<f64>,
    /// Over which these change (s).
    pub model_time: Vec<f64>,
    /// From one start to the next (Nm squared).
    pub bias: Vec<f64>,
    /// Share of a contact's torque.
    pub relative: Vec<f64>,
    /// Whether a joint's torque is a force (N).
    pub is_force: Vec<bool>,
}

impl NoiseModel {
    /// The variances for one robot.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the field.
    pub(crate) fn variances(&self, robot: &Robot) -> Result<ErrorVariances> {
        self.of(robot)?;
        let squares = |name, values: &[f64]| -> Result<Vec<f64>> {
            Ok(robot.per_velocity(name, values)?.into_iter().map(|x| x * x).collect())
        };
        Ok(ErrorVariances {
            torque: squares("noise.torque", &self.torque)?,
            velocity: robot.per_velocity("noise.velocity", &self.velocity)?,
            position_step: robot.per_velocity("noise.position_step", &self.position_step)?,
            friction: squares("noise.friction", &self.friction)?,
            slow: SlowNoise {
                model: squares("noise.model", &self.model)?,
                model_time: robot.per_velocity("noise.model_time", &self.model_time)?,
                bias: squares("noise.bias", &self.bias)?,
                relative: robot.per_velocity("noise.relative", &self.relative)?,
                is_force: robot.forces(),
            },
        })
    }
}
