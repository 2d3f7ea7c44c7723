//! One hypothesis of a contact with an obstacle that stays.

use nalgebra::Vector3;

use super::sums::{Marginal, Sums};
use crate::posterior::tempering::Logs;
use crate::posterior::{ContactSample, ContactSamples};
use crate::surface::SurfacePoint;

/// Where an obstacle is, and what the measurements say of it.
#[derive(Debug, Clone)]
pub(super) struct Hypothesis {
    /// Index into the robot's links.
    pub link: u32,
    /// Where it touched first, link frame.
    pub place: SurfacePoint,
    /// Of the obstacle's radius there (m).
    pub log_radius: f64,
    /// Of the obstacle, world frame (m).
    pub centre: Vector3<f64>,
    /// Of the measurements that count now.
    pub now: Sums,
    /// At the newest pose: point and outward normal, link frame, and the triangle that holds it.
    pub point: Vector3<f64>,
    pub normal: Vector3<f64>,
    pub triangle: Option<u32>,
    /// How much deeper the obstacle is in the link there than at first (m).
    pub deeper: f64,
    pub logs: Logs,
    pub marginal: Marginal,
}

impl Hypothesis {
    /// The force along the inward normal at the newest pose (N).
    pub fn force(&self) -> f64 {
        (self.marginal.force + self.marginal.stiffness * self.deeper).max(0.0)
    }
}

impl ContactSamples for Vec<Hypothesis> {
    #[inline]
    fn sample(&self, k: usize) -> ContactSample {
        let hypothesis = &self[k];
        ContactSample {
            link: hypothesis.link as usize,
            point: hypothesis.point,
            normal: hypothesis.normal,
            force: -hypothesis.normal * hypothesis.force(),
            stiffness: hypothesis.marginal.stiffness,
        }
    }
}
