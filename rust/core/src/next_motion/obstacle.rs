//! A hypothesis of the obstacle that a link touches.

use nalgebra::Vector3;

/// An obstacle that stays where it is.
#[derive(Debug, Clone)]
pub(super) struct Obstacle {
    pub link: usize,
    /// Before the motion, world frame (m).
    pub point: Vector3<f64>,
    /// Of the curvature, world frame (m).
    pub centre: Vector3<f64>,
    /// From the centre to the surface before the motion (m).
    pub distance: f64,
    /// Where the surface is nearest to the centre then.
    pub triangle: Option<u32>,
    /// Along the inward normal before the motion (N).
    pub force: f64,
    /// N/m.
    pub stiffness: f64,
}
