//! What the joints that move one link feel of a measured torque.

use nalgebra::Vector6;

/// What the joints that move one link feel.
#[derive(Debug, Clone)]
pub(crate) struct LinkTarget {
    /// Torques over their noise, in the order of the frame's axes.
    pub torque: Vec<f64>,
    /// Product of these with the columns of the frame's axes.
    pub product: Vector6<f64>,
    /// Squared norm of the torques: twice the most that a contact can make of the logarithm of their likelihood.
    pub squared: f64,
}
