//! How many contacts noisy torques show: as few as leave no more than noise of them.

use super::found::Scene;
use super::isolator::ContactIsolator;
use super::report::LINE_UNKNOWNS;
use crate::math::chi_square::upper_limit;
use crate::robot::Kinematics;

impl ContactIsolator {
    /// Of several tips, the one on which a single force leaves no more than noise: of some thirty torques, one exceeds its
    /// threshold now and then.
    pub(super) fn lone_tip(&self, kinematics: &Kinematics) -> Option<usize> {
        let tips = self.tips.tips();
        if tips.len() < 2 {
            return None;
        }
        let judged = tips.iter().filter_map(|tip| Some((self.chi_square_of_one(kinematics, *tip)?, *tip)));
        let best = judged.min_by(|a, b| a.0.total_cmp(&b.0));
        best.filter(|(chi_square, _)| *chi_square <= self.most_of_one()).map(|(_, tip)| tip)
    }

    /// Two contacts on one branch, where one force leaves more than noise of the torques and two do not.
    pub(super) fn isolate_two(&mut self, kinematics: &Kinematics, tip: usize) -> bool {
        let one = self.chi_square_of_one(kinematics, tip);
        if one.is_none_or(|chi_square| chi_square <= self.most_of_one()) {
            return false;
        }
        self.set_rows(kinematics, None, false);
        let scene = Scene { robot: &self.robot, kinematics, region: &self.region };
        let two = self.several.choose_two(scene, &self.rows, tip);
        if two {
            self.identify(kinematics, None);
            self.report_several(kinematics);
        }
        two
    }

    /// Of all torques, for one force on a body; none where they do not determine it.
    fn chi_square_of_one(&self, kinematics: &Kinematics, body: usize) -> Option<f64> {
        let wrench = self.estimate(kinematics, body);
        (wrench.rank == 6).then(|| wrench.chi_square().0 + self.chi_square_outside(body))
    }

    /// What noise alone leaves of that.
    fn most_of_one(&self) -> f64 {
        upper_limit(self.torque_count().saturating_sub(LINE_UNKNOWNS))
    }
}
