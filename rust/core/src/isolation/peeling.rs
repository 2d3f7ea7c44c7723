//! Contacts that explain the torques but for rounding: forces that the joints behind the others determine, one by one from the tips.

use super::found::{Found, Scene};
use super::rows::{TorqueRows, SILENT};
use super::several::{SeveralContacts, EXACT};
use super::wrench::WrenchEstimate;
use super::wrench_rows::WrenchRows;
use crate::robot::WORLD;

impl SeveralContacts {
    /// Contacts that explain the torques but for rounding. Uses up `rows`.
    pub fn solve_exactly(&mut self, scene: Scene, rows: &mut TorqueRows) -> bool {
        self.clear();
        self.peeled = 0;
        while self.found.len() < self.max_contacts {
            let tips = self.find_tips(scene, rows);
            let [first, second] = [0, 1].map(|i| tips.get(i).copied().unwrap_or(WORLD));
            match tips.len() {
                0 => {
                    self.verified = true;
                    return !self.found.is_empty();
                }
                1 => {
                    if self.find_last(scene, rows, first) {
                        self.verified = true;
                        return true;
                    }
                    let before =
                        first_unexplained(scene, rows, first).map(|joint| scene.robot.parent_body(joint));
                    if before.is_some_and(|before| self.solve_pair(scene, rows, [before, first], EXACT)) {
                        return true;
                    }
                }
                2 if self.solve_pair(scene, rows, [second, first], EXACT) => return true,
                _ => {}
            }
            if !self.peel_one(scene, rows) {
                self.bodies.clear();
                self.bodies.extend(self.tips.tips().iter().take(self.max_contacts));
                return self.solve_together(scene, rows, EXACT);
            }
            self.peeled += 1;
        }
        false
    }

    /// The contacts among them that their own joints determine, one by one. Uses up `rows`.
    pub fn peel_all(&mut self, scene: Scene, rows: &mut TorqueRows) {
        self.clear();
        while self.found.len() < self.max_contacts {
            self.find_tips(scene, rows);
            if !self.peel_one(scene, rows) {
                break;
            }
        }
    }

    /// The last bodies that feel what is not explained yet.
    fn find_tips(&mut self, scene: Scene, rows: &TorqueRows) -> &[usize] {
        let felt = |k: usize| rows.torque[k].abs() > SILENT * rows.tolerance[k];
        self.tips.find(scene.robot, |k| scene.region.feels[k] && felt(k))
    }

    /// Takes the first of the tips out whose own joints determine its force.
    fn peel_one(&mut self, scene: Scene, rows: &mut TorqueRows) -> bool {
        (0..self.tips.tips().len()).any(|index| self.peel(scene, rows, index))
    }

    /// The last contact: all that is left is one force.
    fn find_last(&mut self, scene: Scene, rows: &TorqueRows, tip: usize) -> bool {
        let wrench = rows.total_wrench(scene.robot, scene.region, tip);
        let exact = wrench.rank == 6 && wrench.misfit() <= EXACT;
        let hit = if exact { self.caster.hit_behind(scene, rows, tip, &wrench, EXACT) } else { None };
        hit.map(|hit| self.found.push(Found::new(wrench, hit))).is_some()
    }

    /// A tip whose force follows from the outermost joints that feel no other tip's: takes it out of the torques.
    fn peel(&mut self, scene: Scene, rows: &mut TorqueRows, index: usize) -> bool {
        let Scene { robot, region, .. } = scene;
        let tips = self.tips.tips();
        let tip = tips[index];
        let shared = |joint: &usize| tips.iter().any(|other| *other != tip && robot.moves(*joint, *other));
        let mut wrench_rows = WrenchRows::new();
        for joint in region.chain(robot, tip).rev().take_while(|joint| !shared(joint)) {
            rows.push_joint(robot, joint, &mut wrench_rows);
            if wrench_rows.count < 6 {
                continue;
            }
            let wrench = WrenchEstimate::from_rows(wrench_rows.clone());
            if wrench.rank < 6 {
                continue;
            }
            if wrench.misfit() > EXACT {
                return false;
            }
            let Some(hit) = self.caster.hit_behind(scene, rows, tip, &wrench, EXACT) else { return false };
            rows.explain(robot, region, tip, &wrench);
            self.found.push(Found::new(wrench, hit));
            return true;
        }
        false
    }
}

/// The first joint on the way from the base to `tip` that contradicts the total wrench of the joints before it.
fn first_unexplained(scene: Scene, rows: &TorqueRows, tip: usize) -> Option<usize> {
    let Scene { robot, region, .. } = scene;
    let mut wrench_rows = WrenchRows::new();
    rows.push_root(&mut wrench_rows);
    let mut total: Option<WrenchEstimate> = None;
    for joint in region.chain(robot, tip) {
        if total.is_none() && wrench_rows.count >= 6 {
            total =
                Some(WrenchEstimate::from_rows(wrench_rows.clone())).filter(|estimate| estimate.rank == 6);
        }
        match &total {
            None => rows.push_joint(robot, joint, &mut wrench_rows),
            Some(total) => {
                if !rows.explains(robot, joint, total, SILENT) {
                    return Some(joint);
                }
            }
        }
    }
    None
}
