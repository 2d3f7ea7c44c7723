//! One force: link, line of action, point (Vorndamme 2017, steps 1 to 4, eqs. 22-26).

use super::found::Scene;
use super::isolator::{ContactIsolator, SIGNIFICANCE};
use super::line::best_first;
use super::one_wrench::EXACT_FIT;
use super::result::{Candidate, Isolation};
use super::wrench::WrenchEstimate;
use crate::robot::Kinematics;

/// Rounds until the contact link stands still; ten, as in Vorndamme 2017.
const ROUNDS: usize = 10;

impl ContactIsolator {
    /// A force on one branch: steps 1 to 4, repeated with the link that was hit.
    pub(super) fn isolate_single(&mut self, kinematics: &Kinematics, tip: usize) {
        let mut body = tip;
        for _ in 0..ROUNDS {
            let wrench = self.estimate(kinematics, body);
            self.isolation.rank_deficit = 6 - wrench.rank;
            // Also where the comparison fails for want of a number.
            let significant = SIGNIFICANCE * wrench.force_spread() < 1.0;
            if wrench.rank < 6 || !significant {
                if body == tip && wrench.rank == 5 && self.isolate_behind(kinematics, tip) {
                    return;
                }
                self.name_link(tip);
                self.isolation.candidates.clear();
                // The torques do not exclude the links behind: a line can cross their joints' axes.
                self.bodies.grow_all(&self.robot, &self.region, tip);
                self.isolation.link_candidates.clear();
                self.isolation.link_candidates.extend(self.bodies.links(&self.robot, &self.region));
                self.explain(kinematics, body, &wrench);
                return;
            }
            self.bodies.grow(
                Scene { robot: &self.robot, kinematics, region: &self.region },
                tip,
                &wrench,
                &self.residual,
                &self.limit,
            );
            let hit = self.cast(kinematics, &wrench).or_else(|| {
                self.bodies.grow_all(&self.robot, &self.region, tip);
                self.cast(kinematics, &wrench)
            });
            let Some(hit) = hit else {
                self.name_link(tip);
                self.report_wrench(kinematics, &wrench);
                self.explain(kinematics, body, &wrench);
                return;
            };
            let hit_body = self.robot[hit.link].body;
            if hit_body == body {
                self.report_point(kinematics, &wrench, &hit);
                return;
            }
            body = hit_body;
        }
        // Two links that take turns: the link cannot be determined.
        self.name_link(tip);
        let wrench = self.estimate(kinematics, body);
        self.report_wrench(kinematics, &wrench);
        self.explain(kinematics, body, &wrench);
    }

    /// The torques up to `tip` leave one component of the wrench open. With the silence of the joints behind, a body
    /// there may be determined: a force on it whose line crosses those joints' axes. Only an exact fit tells it from
    /// a force on `tip`, where such a coincidence has no reason (with more components open, it often has).
    fn isolate_behind(&mut self, kinematics: &Kinematics, tip: usize) -> bool {
        for body in tip + 1..self.robot.body_count() {
            if !self.robot.moves(tip, body) || self.region.links_of(&self.robot, body).next().is_none() {
                continue;
            }
            let wrench = self.estimate(kinematics, body);
            if wrench.rank < 6 || wrench.misfit() > EXACT_FIT {
                continue;
            }
            self.bodies.grow(
                Scene { robot: &self.robot, kinematics, region: &self.region },
                body,
                &wrench,
                &self.residual,
                &self.limit,
            );
            if let Some(hit) = self.cast(kinematics, &wrench) {
                if self.robot[hit.link].body == body {
                    self.isolation.rank_deficit = 0;
                    self.report_point(kinematics, &wrench, &hit);
                    return true;
                }
            }
        }
        false
    }

    /// Casts the line of action on the links in question; the first hit where the force enters.
    fn cast(&mut self, kinematics: &Kinematics, wrench: &WrenchEstimate) -> Option<Candidate> {
        let Isolation { candidates, link_candidates, .. } = &mut self.isolation;
        candidates.clear();
        link_candidates.clear();
        link_candidates.extend(self.bodies.links(&self.robot, &self.region));
        let (start, direction) = wrench.line_of_action()?;
        for &link in link_candidates.iter() {
            self.line.cast(&self.robot, kinematics, link, &start, &direction, candidates);
        }
        best_first(candidates);
        let best = candidates.first().copied().filter(|hit| hit.pushing)?;
        if let Some(position) = link_candidates.iter().position(|link| *link == best.link) {
            link_candidates[..=position].rotate_right(1);
        }
        Some(best)
    }
}
