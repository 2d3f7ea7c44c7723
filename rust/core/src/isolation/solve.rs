//! The rows that several forces have to explain, and forces that do.

use super::found::Scene;
use super::isolator::{ContactIsolator, CONTRADICTION, LEFT_OVER};
use super::rows::Root;
use super::wrench::WrenchEstimate;
use super::wrench_rows::WrenchRows;
use crate::detection::is_over;
use crate::robot::Kinematics;

impl ContactIsolator {
    /// The bodies at the ends of what the joints feel, and their number; `share` of what sensors have explained
    /// already is no torque.
    pub(super) fn find_tips(&mut self, share: f64) -> usize {
        let Self { robot, tips, region, residual, limit, measured, .. } = self;
        let over = |k: usize| is_over(residual[k], limit[k].max(share * measured[k]));
        tips.find(robot, |k| region.feels[k] && over(k)).len()
    }

    pub(super) fn set_rows(&mut self, kinematics: &Kinematics, root: Option<&Root>, widened: bool) {
        let noise = widened.then_some(&self.noise);
        self.rows.set(&self.robot, kinematics, &self.residual, &self.measured, &self.limit, noise);
        self.rows.root = root.map(|root| if widened { *root } else { root.narrow() });
    }

    /// Contacts that explain the torques but for rounding.
    pub(super) fn solve_exactly(&mut self, kinematics: &Kinematics, root: Option<&Root>) -> bool {
        self.set_rows(kinematics, root, true);
        let scene = Scene { robot: &self.robot, kinematics, region: &self.region };
        let exact = self.several.solve_exactly(scene, &mut self.rows);
        if exact {
            self.several.narrow(self.rows.widest_threshold(&self.limit));
        }
        exact
    }

    /// Several forces that explain the torques within the thresholds, or within `widened` tolerances; tips are found.
    pub(super) fn solve_roughly(
        &mut self,
        kinematics: &Kinematics,
        root: Option<&Root>,
        widened: bool,
    ) -> bool {
        self.set_rows(kinematics, root, widened);
        let scene = Scene { robot: &self.robot, kinematics, region: &self.region };
        self.several.solve_roughly(scene, &self.rows, self.tips.tips(), widened)
    }

    /// Whether one force explains the torques within their tolerances.
    pub(super) fn roughly(&self, tip: usize) -> bool {
        let mut rows = WrenchRows::new();
        for joint in self.region.chain(&self.robot, tip) {
            self.rows.push_joint(&self.robot, joint, &mut rows);
        }
        WrenchEstimate::from_rows(rows).misfit() <= CONTRADICTION
    }

    /// Several forces that explain a sensor's wrench and the torques behind it; where one force does, only if they fit
    /// but for rounding.
    pub(super) fn solve_several(&mut self, kinematics: &Kinematics, root: &Root, one_does: bool) -> bool {
        let exact = self.solve_exactly(kinematics, Some(root));
        if one_does && !(exact && self.several.verified) {
            return false;
        }
        self.find_tips(LEFT_OVER);
        let roughly = |isolator: &mut Self, widened| isolator.solve_roughly(kinematics, Some(root), widened);
        let solved = exact || roughly(self, false) || roughly(self, true);
        if solved {
            self.identify(kinematics, Some(root));
        }
        solved
    }

    pub(super) fn identify(&mut self, kinematics: &Kinematics, root: Option<&Root>) {
        self.set_rows(kinematics, root, true);
        let scene = Scene { robot: &self.robot, kinematics, region: &self.region };
        self.several.identify(scene, &self.rows);
    }
}
