//! A particle as users see it.

use nalgebra::Vector3;

use super::hypothesis::ContactModel;
use crate::robot::LinkIndex;

/// One hypothesis of a contact at the newest pose, world frame.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::robot::Robot;
/// use contactsense::sampler::{SamplerOptions, StaticObstacleSampler};
///
/// let options = SamplerOptions { particles: 500, ..SamplerOptions::default() };
/// let mut sampler = StaticObstacleSampler::new(Arc::new(Robot::example_arm()), &options)?;
/// sampler.update(&[0.4; 7], &[1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0], None)?;
/// let particle = sampler.particle(0, 0).expect("the first of 500");
/// assert!((particle.normal.norm() - 1.0).abs() < 1e-9 && particle.weight >= 0.0);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Particle {
    /// What the contact is with.
    pub model: ContactModel,
    /// The link that is touched.
    pub link: LinkIndex,
    /// On its surface (m).
    pub point: Vector3<f64>,
    /// Outward normal of the surface there.
    pub normal: Vector3<f64>,
    /// On the link (N).
    pub force: Vector3<f64>,
    /// Of the contact (N/m); zero where the model has none.
    pub stiffness: f64,
    /// All weights sum to one.
    pub weight: f64,
}
