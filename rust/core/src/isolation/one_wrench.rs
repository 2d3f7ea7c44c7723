//! How well one wrench on a body explains the torques.

use super::isolator::ContactIsolator;
use super::wrench::{estimate_wrench, WrenchEstimate, DEVIATION, LINE_UNKNOWNS};
use crate::math::chi_square::upper_limit;
use crate::robot::Kinematics;

/// A misfit that chance brings about once in a thousand times [thresholds].
pub(super) const EXACT_FIT: f64 = 1e-3;

impl ContactIsolator {
    /// The wrench on a body that explains the torques before it best.
    pub(super) fn estimate(&self, kinematics: &Kinematics, body: usize) -> WrenchEstimate {
        estimate_wrench(&self.robot, kinematics, body, &self.residual, &self.limit)
    }

    /// Whether one force explains the torques but for rounding.
    pub(super) fn is_single(&self, kinematics: &Kinematics, tip: usize) -> bool {
        let wrench = self.estimate(kinematics, tip);
        wrench.rank == 6 && wrench.misfit() <= EXACT_FIT
    }

    /// Of all torques, for one force on a body; none where they do not determine it.
    pub(super) fn chi_square_of_one(&self, kinematics: &Kinematics, body: usize) -> Option<f64> {
        let wrench = self.estimate(kinematics, body);
        (wrench.rank == 6).then(|| wrench.chi_square().0 + self.chi_square_outside(body))
    }

    /// What noise alone leaves of that.
    pub(super) fn most_of_one(&self) -> f64 {
        upper_limit(self.torque_count().saturating_sub(LINE_UNKNOWNS))
    }

    /// Sum of squares of the torques of joints that a force on `body` does not move, in standard deviations.
    pub(super) fn chi_square_outside(&self, body: usize) -> f64 {
        let chain = self.robot.chain(body);
        let mut next = 0;
        let mut sum = 0.0;
        for joint in 1..self.robot.body_count() {
            // Chains are in rising order.
            if chain.get(next) == Some(&joint) {
                next += 1;
            } else if self.region.joints[joint] {
                let range = self.robot.velocity_range(joint);
                sum += range.map(|k| (self.residual[k] / self.limit[k]).powi(2)).sum::<f64>();
            }
        }
        sum / (DEVIATION * DEVIATION)
    }

    /// Torques of the region.
    pub(super) fn torque_count(&self) -> usize {
        self.region.feels.iter().filter(|feels| **feels).count()
    }
}
