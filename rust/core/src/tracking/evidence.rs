//! What one tick tells of a contact's place.

use crate::robot::Kinematics;

/// A tick's torque and its errors.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TickEvidence<'a> {
    pub kinematics: &'a Kinematics,
    /// External torque to find the place by, then the wrenches of sensors (Nm, N): behind a slow observer, where there is a choice.
    pub torque: &'a [f64],
    /// Standard deviations without contact (Nm, N).
    pub deviation: &'a [f64],
    /// The same that says the force now (Nm, N).
    pub newest: &'a [f64],
    /// By velocity variable: it tells nothing.
    pub left_out: &'a [bool],
    /// Of the tick (s).
    pub time: f64,
}
