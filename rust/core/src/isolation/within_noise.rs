//! Several contacts that explain the torques within their tolerances.

use super::found::Scene;
use super::rows::TorqueRows;
use super::several::{SeveralContacts, GOOD};

impl SeveralContacts {
    /// Contacts that explain the torques within their tolerances. `tips` feel them.
    /// Points are open where the tolerances are `widened` beyond the thresholds.
    pub fn solve_roughly(&mut self, scene: Scene, rows: &TorqueRows, tips: &[usize], widened: bool) -> bool {
        let solved = self.fit(scene, rows, tips);
        self.contradicted = widened;
        solved
    }

    fn fit(&mut self, scene: Scene, rows: &TorqueRows, tips: &[usize]) -> bool {
        self.clear();
        let solved = match *tips {
            [tip] => {
                let mut best: Option<(f64, usize)> = None;
                for before in scene.region.chain(scene.robot, tip).filter(|before| *before != tip) {
                    // Else one wrench explains all that joints behind would tell of a second contact.
                    if rest_is_explained(scene, rows, before, tip) {
                        continue;
                    }
                    let solved = self.solve_pair(scene, rows, [before, tip], GOOD);
                    if let (true, Some(solution)) = (solved, self.solutions.first()) {
                        if best.is_none_or(|(misfit, _)| solution.misfit < misfit) {
                            best = Some((solution.misfit, before));
                        }
                    }
                }
                best.is_some_and(|(_, before)| self.solve_pair(scene, rows, [before, tip], GOOD))
            }
            [first, second] => self.solve_pair(scene, rows, [second, first], GOOD),
            _ => false,
        };
        if self.choose_bodies(scene, rows, tips) || solved {
            return true;
        }
        self.clear();
        self.bodies.clear();
        self.bodies.extend(tips.iter().take(self.max_contacts));
        tips.len() > 1 && self.solve_together(scene, rows, GOOD)
    }
}

/// Whether all joints behind `before` on the way to `tip` feel what the total wrench of the joints up to there causes.
fn rest_is_explained(scene: Scene, rows: &TorqueRows, before: usize, tip: usize) -> bool {
    let robot = scene.robot;
    let total = rows.total_wrench(robot, scene.region, before);
    let behind = |joint: &usize| !robot.moves(*joint, before);
    let mut rest = scene.region.chain(robot, tip).filter(behind);
    total.rank < 6 || rest.all(|joint| rows.explains(robot, joint, &total, 1.0))
}
