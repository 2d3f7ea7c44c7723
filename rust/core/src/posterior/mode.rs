//! A place where a contact may be.

use nalgebra::Vector3;

use crate::robot::LinkIndex;
use crate::spatial::Pose;

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

impl Mode {
    /// The same in the frame of its link, which has this pose.
    pub(crate) fn in_link_frame(&self, pose: &Pose) -> Self {
        Mode {
            point: pose.inverse_transform_point(&self.point),
            normal: pose.inverse_transform_vector(&self.normal),
            force: pose.inverse_transform_vector(&self.force),
            ..*self
        }
    }

    /// The inverse: from the frame of its link to the world's.
    pub(crate) fn in_world_frame(&self, pose: &Pose) -> Self {
        Mode {
            point: pose.transform_point(&self.point),
            normal: pose.rotation * self.normal,
            force: pose.rotation * self.force,
            ..*self
        }
    }

    /// The normal of the side that its force enters: a force that pulls pushes from within.
    pub(crate) fn pushed_normal(&self) -> Vector3<f64> {
        if self.force.dot(&self.normal) > 0.0 {
            -self.normal
        } else {
            self.normal
        }
    }
}
