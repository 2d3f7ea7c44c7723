//! How many contacts noisy torques show: as few as leave no more than noise of them.

use super::found::Scene;
use super::isolator::ContactIsolator;
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
}
