//! The torque that the best particle leaves over.

use super::columns::Columns;
use super::likelihood::{misfit, Belief};
use crate::robot::{JointKind, Robot};

/// Torque that is left over.
pub(super) struct LeftOver {
    /// The best particle.
    pub best: usize,
    /// Its squared norm in units of the noise.
    pub misfit: f64,
    /// Its part of what was measured.
    pub share: f64,
    joints: usize,
}

impl LeftOver {
    /// Of so many joints' torques, of which the squared norm was measured, in units of the noise.
    pub fn of(particles: &Columns, weights: &[f64], measured: f64, joints: usize) -> Self {
        let (mut best, mut greatest) = (0, -1.0);
        for (k, &weight) in weights.iter().enumerate() {
            if weight > greatest {
                (best, greatest) = (k, weight);
            }
        }
        let misfit = misfit(&Belief::of(particles, best));
        let share = if measured > 0.0 { (misfit / measured).sqrt() } else { 0.0 };
        LeftOver { best, misfit, share, joints }
    }

    /// Whether it is more than a share of the torque, and more than noise.
    pub fn is_much(&self, share: f64) -> bool {
        self.share > share && self.misfit > 9.0 * self.joints as f64
    }

    /// About as much moment at the joints that turn, where torques were measured with a noise [Nm].
    pub fn moment(&self, torque: &[f64], noise: &[f64], turning: &[bool]) -> f64 {
        let (mut moment, mut deviations) = (0.0, 0.0);
        for ((torque, noise), _) in torque.iter().zip(noise).zip(turning).filter(|(_, turns)| **turns) {
            moment += torque * torque;
            deviations += (torque / noise).powi(2);
        }
        // Moment per standard deviation of its noise, where the torque is.
        let unit = if deviations > 0.0 { (moment / deviations).sqrt() } else { 0.0 };
        self.misfit.sqrt() * unit
    }
}

/// Whether each velocity variable is a rotation's.
pub(super) fn turning(robot: &Robot) -> Vec<bool> {
    let mut turning = vec![false; robot.nv()];
    for body in 0..robot.bodies.len() {
        let range = robot.velocity_range(body);
        // A free flyer's linear part comes first.
        let first = match robot.bodies[body].kind {
            JointKind::Prismatic => range.end,
            JointKind::FreeFlyer => range.start + 3,
            JointKind::Revolute | JointKind::Continuous => range.start,
        };
        turning[first..range.end].fill(true);
    }
    turning
}
