//! Any number of contacts at once, and the forces of all of them (Vorndamme 2017, eqs. 28-30).

use super::found::{Found, Scene};
use super::rows::TorqueRows;
use super::several::SeveralContacts;
use crate::math::least_squares::exceeds;

/// Rounds until the contact links stand still; ten, as in Vorndamme 2017.
const ROUNDS: usize = 10;
/// Contacts that are solved for together: more would take too long.
const MOST: usize = 6;
/// Bodies on which one more contact is tried, best first.
const TRIED: usize = 4;

impl SeveralContacts {
    /// Forces on all of `bodies`, or on one more before them, that explain the torques but for `limit` and are
    /// determined by them.
    pub(super) fn solve_together(&mut self, scene: Scene, rows: &TorqueRows, limit: f64) -> bool {
        let (found, tips) = (self.found.len(), self.bodies.len());
        if !(2..=MOST).contains(&tips) || found + tips > self.max_contacts {
            return false;
        }
        if self.stack(scene, rows, limit).is_some() {
            return true;
        }
        if found + tips == self.max_contacts || tips == MOST {
            return false;
        }
        self.rank_one_more(scene, rows, limit);
        let mut best: Option<(f64, usize)> = None;
        for index in 0..self.one_more.len() {
            self.bodies.push(self.one_more[index].1);
            if let Some(misfit) = self.stack(scene, rows, limit) {
                if best.is_none_or(|(least, _)| misfit < least) {
                    best = Some((misfit, self.one_more[index].1));
                }
            }
            self.found.truncate(found);
            self.bodies.truncate(tips);
        }
        let Some((_, before)) = best else { return false };
        self.bodies.push(before);
        self.stack(scene, rows, limit).is_some()
    }

    /// The bodies before the tips on which one more wrench explains the torques best, by least squares alone, but for
    /// `limit`.
    fn rank_one_more(&mut self, scene: Scene, rows: &TorqueRows, limit: f64) {
        let Self { one_more, stacked, bodies, work, .. } = self;
        one_more.clear();
        if !work.spend(stacked.work(bodies.len()) * 2) {
            return;
        }
        stacked.estimate(scene, rows, bodies);
        stacked.prepare_one_more();
        for before in 1..scene.robot.body_count() {
            let carries = |tip: &usize| scene.region.chain(scene.robot, *tip).any(|joint| joint == before);
            if bodies.contains(&before) || !bodies.iter().any(carries) {
                continue;
            }
            let Some(misfit) = stacked.misfit_with(scene, before) else { continue };
            if exceeds(misfit, limit) {
                continue;
            }
            let rank = one_more.partition_point(|(other, _)| *other <= misfit);
            if rank < TRIED {
                one_more.insert(rank, (misfit, before));
                one_more.truncate(TRIED);
            }
        }
    }

    /// Least squares for forces on `bodies`, or on bodies behind them that their lines hit; the misfit if they are
    /// determined and explain the torques but for `limit`.
    fn stack(&mut self, scene: Scene, rows: &TorqueRows, limit: f64) -> Option<f64> {
        let found = self.found.len();
        let mut bodies = std::mem::take(&mut self.bodies);
        let mut misfit = None;
        for _ in 0..ROUNDS {
            let work = self.stacked.work(bodies.len());
            if !self.work.spend(work) || self.stacked.estimate(scene, rows, &bodies) > 0 {
                break;
            }
            let Some(left) = self.stacked.misfit(limit) else { break };
            let mut moved = false;
            for body in &mut bodies {
                let wrench = self.stacked.wrench(self.found.len() - found);
                let Some(entry) = self.caster.hit_behind(scene, rows, *body, &wrench, limit) else { break };
                let hit_body = scene.robot[entry.hit.link].body;
                moved |= hit_body != *body;
                *body = hit_body;
                self.found.push(Found::new(wrench, entry));
            }
            if self.found.len() == found + bodies.len() && !moved {
                misfit = Some(left);
                break;
            }
            let missed = self.found.len() < found + bodies.len();
            self.found.truncate(found);
            if missed {
                break;
            }
        }
        self.bodies = bodies;
        self.verified = misfit.is_some();
        misfit
    }

    /// The forces of all contacts at their points, those of the first solution among them (Vorndamme 2017,
    /// eqs. 29-30).
    pub fn identify(&mut self, scene: Scene, rows: &TorqueRows) {
        let best = self.solutions.first().into_iter().flat_map(|solution| &solution.contacts);
        self.places.clear();
        self.places.extend(
            self.found
                .iter()
                .chain(best)
                .map(|found| (scene.robot[found.hit.link].body, found.hit.point - scene.kinematics.origin)),
        );
        if !self.stacked.identify(scene, rows, &self.places) {
            return;
        }
        let best = self.solutions.first_mut().into_iter().flat_map(|solution| &mut solution.contacts);
        for (index, found) in self.found.iter_mut().chain(best).enumerate() {
            found.force = self.stacked.force(index);
        }
    }
}
