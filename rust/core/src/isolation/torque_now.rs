//! What is measured at one instant.

use crate::robot::Kinematics;

/// The rows of a measurement with their standard deviations.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TorqueNow<'a> {
    pub kinematics: &'a Kinematics,
    /// External torque, then the wrenches of sensors (Nm, N).
    pub torque: &'a [f64],
    /// Their standard deviations without contact (Nm, N).
    pub deviation: &'a [f64],
}
