//! Places that explain the torques about as well as the one that was found. A joint just under its threshold decides
//! nothing, and a line of action may enter the robot's surface more than once.

use super::isolator::ContactIsolator;
use super::line::{best_first, farthest_entry, is_covered};
use super::result::{Candidate, Isolation};
use super::wrench::{WrenchEstimate, DEVIATION, ORIGIN, UNLIKELY};
use crate::robot::jacobian::jacobian_column;
use crate::robot::Kinematics;

/// What else the torques allow.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rivals {
    /// Distance of the farthest place that is not unlikely from the one found (m).
    pub distance: f64,
    /// Whether a force on a body whose contact points the torques do not determine is not unlikely either.
    pub open: bool,
}

impl ContactIsolator {
    /// Rivals of a force on one line that enters the surface at `hit`. Their points are added to the candidates, and
    /// their links to the link candidates.
    pub(super) fn find_rivals(
        &mut self,
        kinematics: &Kinematics,
        wrench: &WrenchEstimate,
        hit: &Candidate,
    ) -> Rivals {
        let distance = farthest_entry(&self.isolation.candidates, hit);
        let mut rivals = Rivals { distance, open: false };
        let body = self.robot[hit.link].body;
        let limit = wrench.chi_square().0 + self.chi_square_outside(body) + UNLIKELY;
        self.exclude(kinematics, body, wrench, limit);
        for other in 1..self.robot.body_count() {
            if self.excluded[other] || other == body || self.chi_square_outside(other) > limit {
                continue;
            }
            if self.region.links_of(&self.robot, other).next().is_none() {
                continue;
            }
            let estimate = self.estimate(kinematics, other);
            if estimate.chi_square().0 + self.chi_square_outside(other) > limit {
                continue;
            }
            if estimate.rank < 6 {
                rivals.open = true;
                let Self { robot, region, isolation, .. } = self;
                for link in region.links_of(robot, other) {
                    if !isolation.link_candidates.contains(&link) {
                        isolation.link_candidates.push(link);
                    }
                }
            } else if let Some(distance) = self.add_entries(kinematics, other, &estimate, hit) {
                rivals.distance = rivals.distance.max(distance);
            }
        }
        rivals
    }

    /// Marks the bodies that cannot carry the force, by two tests that are cheap: a torque that is not noise must be of
    /// a joint before the body, and every joint between `body` and one behind it must feel what `wrench` causes there.
    fn exclude(&mut self, kinematics: &Kinematics, body: usize, wrench: &WrenchEstimate, limit: f64) {
        let Self { robot, region, residual, excluded, limit: threshold, .. } = self;
        let is_noise = |k: usize| (residual[k] / (threshold[k] * DEVIATION)).powi(2) <= limit;
        let last = (1..robot.body_count())
            .rev()
            .find(|joint| region.joints[*joint] && !robot.velocity_range(*joint).all(is_noise));
        for other in 1..robot.body_count() {
            excluded[other] = last.is_some_and(|joint| !robot.moves(joint, other));
            if other > body && robot.moves(body, other) {
                let feels = |(column, k): (usize, usize)| {
                    let axis = jacobian_column(robot, kinematics, other, column, &ORIGIN);
                    wrench.innovation(&axis, residual[k], threshold[k]).powi(2) <= limit
                };
                let parent = robot.parent_body(other);
                excluded[other] |= (parent != body && excluded[parent])
                    || !robot.velocity_range(other).enumerate().all(feels);
            }
        }
    }

    /// Adds the places where the line of action, or one displaced by two standard deviations, enters the body's links
    /// to the candidates; the distance of the farthest from `hit` (m), none where no line does.
    fn add_entries(
        &mut self,
        kinematics: &Kinematics,
        body: usize,
        wrench: &WrenchEstimate,
        hit: &Candidate,
    ) -> Option<f64> {
        let (start, direction) = wrench.line_of_action()?;
        let at = start + direction * direction.dot(&(hit.point - kinematics.origin - start));
        let [first, second] = wrench.displacements(&at);
        let mut farthest = None;
        for displacement in [first * 0.0, first * 2.0, first * -2.0, second * 2.0, second * -2.0] {
            self.displaced.clear();
            let found = self.robot[hit.link].body;
            let links =
                self.region.links_of(&self.robot, body).chain(self.region.links_of(&self.robot, found));
            for link in links {
                let start = start + displacement;
                self.line.cast(&self.robot, kinematics, link, &start, &direction, &mut self.displaced);
            }
            best_first(&mut self.displaced);
            let on_body = |entry: &&Candidate| entry.pushing && self.robot[entry.link].body == body;
            let mut entries = self.displaced.iter().filter(on_body);
            let Some(entry) = entries.find(|entry| !is_covered(&self.displaced, entry)) else { continue };
            let distance = (entry.point - hit.point).norm();
            farthest = Some(distance.max(farthest.unwrap_or(0.0)));
            let Isolation { candidates, link_candidates, .. } = &mut self.isolation;
            if candidates.len() < candidates.capacity() {
                let leaving = candidates.iter().position(|other| !other.pushing).unwrap_or(candidates.len());
                candidates.insert(leaving, *entry);
            }
            if !link_candidates.contains(&entry.link) {
                link_candidates.push(entry.link);
            }
        }
        farthest
    }
}
