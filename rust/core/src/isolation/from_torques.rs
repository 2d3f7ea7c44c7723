//! The contacts that torques alone tell of: one force, else several, else links.

use super::found::Scene;
use super::isolator::{ContactIsolator, LEFT_OVER};
use crate::detection::is_over;
use crate::robot::Kinematics;

impl ContactIsolator {
    /// The contacts that no sensor sees: one force if that explains the torques but for rounding; else several; one
    /// again if it explains them roughly; else the links are named.
    pub(super) fn isolate_from_torques(&mut self, kinematics: &Kinematics) {
        if self.find_tips(0.0) == 0 {
            return;
        }
        let single = |isolator: &Self| match isolator.tips.tips() {
            [tip] => Some(*tip),
            _ => None,
        };
        if let Some(tip) = single(self).filter(|tip| self.is_single(kinematics, *tip)) {
            return self.isolate_single(kinematics, tip);
        }
        let exact = self.solve_exactly(kinematics, None);
        if exact && self.several.verified {
            self.identify(kinematics, None);
            return self.report_several(kinematics);
        }
        // Two contacts without proof: more than one force only if a free base tells the sum of all.
        let exact = exact && self.robot.floating_base();
        // Beside strong contacts that sensors see, a weak torque may be their error.
        if self.find_tips(LEFT_OVER) == 0 {
            return;
        }
        if let Some(tip) = self.lone_tip(kinematics) {
            return self.isolate_single(kinematics, tip);
        }
        self.set_rows(kinematics, None, true);
        match single(self) {
            Some(tip) if self.estimate(kinematics, tip).rank < 6 || self.roughly(tip) => {
                if !self.isolate_two(kinematics, tip) {
                    self.isolate_single(kinematics, tip);
                }
            }
            tip => {
                if exact || self.solve_roughly(kinematics, None, false) {
                    self.identify(kinematics, None);
                    self.report_several(kinematics);
                } else if tip.is_none() && self.isolate_partly(kinematics) {
                } else if self.solve_roughly(kinematics, None, true) {
                    self.identify(kinematics, None);
                    self.report_several(kinematics);
                } else if let Some(tip) = tip {
                    self.isolate_single(kinematics, tip);
                } else {
                    self.name_links(kinematics);
                }
            }
        }
    }

    /// The contacts that the joints behind all others determine; links are named for the rest. False if there are none.
    fn isolate_partly(&mut self, kinematics: &Kinematics) -> bool {
        if self.several.peeled == 0 {
            return false;
        }
        self.set_rows(kinematics, None, true);
        let scene = Scene { robot: &self.robot, kinematics, region: &self.region };
        self.several.peel_all(scene, &mut self.rows);
        self.several.narrow(self.rows.widest_threshold(&self.limit));
        self.report_found_alone(kinematics);
        let Self { robot, tips, region, rows, limit, .. } = self;
        tips.find(robot, |k| region.feels[k] && is_over(rows.torque[k], limit[k]));
        self.name_links(kinematics);
        true
    }
}
