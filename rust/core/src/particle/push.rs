//! A push at a given point, and the torques that it leaves over.

use nalgebra::Vector3;

use super::instant::Instant;
use crate::torque::{BestForce, ForceModel};

/// A push on a link: point and outward normal in the link's frame.
#[derive(Clone, Copy)]
pub(super) struct Push<'a> {
    pub instant: &'a Instant,
    pub force_model: ForceModel,
    pub link: usize,
    pub point: Vector3<f64>,
    pub normal: Vector3<f64>,
}

impl Push<'_> {
    /// Sets the measured torques without what the best force of this push does.
    pub fn left_over(&self, left: &mut [f64]) {
        let Instant { frames, target, torque, deviation, .. } = self.instant;
        let target = target.on(self.link);
        let best =
            BestForce::of(&frames.links[self.link], target, self.force_model, &self.point, &self.normal);
        left.copy_from_slice(torque);
        frames.subtract(self.link, &self.point, &best.force, deviation, left);
    }
}
