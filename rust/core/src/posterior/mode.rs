//! A place where a contact may be.

use nalgebra::Vector3;

use crate::robot::LinkIndex;

/// A place where the contact may be.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::particle::{ContactParticleFilter, FilterOptions};
/// use contactsense::robot::Robot;
///
/// let options = FilterOptions { particles: 500, ..FilterOptions::default() };
/// let mut filter = ContactParticleFilter::new(Arc::new(Robot::example_arm()), options)?;
/// let modes = &filter.update(&[0.4; 7], &[1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])?.estimate.modes;
/// // The most probable first.
/// assert!(modes.windows(2).all(|pair| pair[0].probability >= pair[1].probability));
/// assert!(modes.iter().all(|mode| mode.force.dot(&mode.normal) < 0.0), "contacts push");
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Mode {
    /// Which link.
    pub link: LinkIndex,
    /// On the link's surface, world frame (m).
    pub point: Vector3<f64>,
    /// On the robot, world frame (N).
    pub force: Vector3<f64>,
    /// Outward, world frame.
    pub normal: Vector3<f64>,
    /// Stiffness of the contact (N/m); none where nothing is assumed of it.
    pub stiffness: Option<f64>,
    /// Share of the posterior.
    pub probability: f64,
    /// Root of the mean squared distance of the mode's samples from their mean (m).
    pub spread: f64,
}
