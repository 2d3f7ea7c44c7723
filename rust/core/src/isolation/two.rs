//! Two forces that share their joints, solved for together; what the torques leave open is closed by what is known of contacts: no
//! moment, on the surface, pushing.

use super::found::{Entry, Scene, Solution};
use super::open_part::{close, close_near};
use super::pair::{estimate_pair, Open, PairEstimate};
use super::rows::TorqueRows;
use super::several::{SeveralContacts, EXACT, PAIR_WORK};
use super::surface_search::{PAIRS, STARTS};
use crate::math::least_squares::exceeds;

/// Misfit of a solution between samples of the surfaces, which is not exact.
const INEXACT: f64 = f64::INFINITY;
/// Rounds until the contact links stand still; ten, as in Vorndamme 2017.
const ROUNDS: usize = 10;
/// Multiplications of a pair of sampled places.
const PLACES_WORK: usize = 80;
/// A search with fewer pairs of places says nothing.
const FEWEST_PAIRS: usize = 400;

impl SeveralContacts {
    /// Every pair of forces on two bodies, or on bodies behind them that their lines hit, that explains the torques
    /// but for `limit`. Without a proof (more conditions than unknowns) only if the torques are taken to be exact, and a
    /// free base or a sensor tells the sum of both.
    pub(super) fn solve_pair(
        &mut self,
        scene: Scene,
        rows: &TorqueRows,
        mut bodies: [usize; 2],
        limit: f64,
    ) -> bool {
        self.solutions.clear();
        if self.found.len() + 2 > self.max_contacts {
            return false;
        }
        let proof = limit > EXACT || !(scene.robot.floating_base() || rows.root.is_some());
        for _ in 0..ROUNDS {
            if !self.work.spend(PAIR_WORK) {
                return false;
            }
            let Some(pair) = estimate_pair(scene.robot, scene.region, rows, bodies) else { return false };
            self.rank_deficit = pair.deficit;
            self.verified = pair.checks() > 0;
            // What closes a deficit has errors that the covariance of the wrenches leaves out.
            self.open = pair.deficit > usize::from(limit <= EXACT);
            if proof && !self.verified {
                return false;
            }
            if pair.deficit > 0 {
                // Between sensors the bodies are fewer.
                let pairs = if scene.region.whole { PAIRS } else { PAIRS / 3 };
                self.close(scene, &pair, pairs, limit);
                return !self.solutions.is_empty();
            }
            let wrenches = pair.wrenches(&[0.0; 6]);
            let misfit = pair.misfit(&wrenches);
            if exceeds(misfit, limit) {
                return false;
            }
            let hits = [0, 1].map(|i| self.caster.hit_behind(scene, rows, bodies[i], &wrenches[i], limit));
            let [Some(first), Some(second)] = hits else { return false };
            let hit_bodies = [first, second].map(|entry| scene.robot[entry.hit.link].body);
            if hit_bodies == bodies {
                self.keep(wrenches, [first, second], misfit);
                return true;
            }
            if hit_bodies[0] == hit_bodies[1] {
                return false;
            }
            bodies = hit_bodies;
        }
        false
    }

    /// Closes a rank deficit by what is known of contacts.
    fn close(&mut self, scene: Scene, pair: &PairEstimate, pairs: usize, limit: f64) {
        if pair.deficit <= 2 {
            let (closed, count) = close(pair);
            for open in &closed[..count] {
                self.try_open(scene, pair, open, limit);
            }
            return;
        }
        if exceeds(pair.unexplained_share(), limit) {
            return;
        }
        let pairs = pairs.min(self.work.left() / PLACES_WORK);
        if !self.work.spend(pairs.max(FEWEST_PAIRS) * PLACES_WORK) {
            return;
        }
        self.search.search(scene, pair, pairs);
        for rank in 0..STARTS {
            let Some((places, start)) = self.search.start(scene, pair, rank) else { break };
            let exact = close_near(pair, start).is_some_and(|open| self.try_open(scene, pair, &open, limit));
            if !exact {
                self.keep(pair.wrenches(&start), places.map(|hit| Entry { hit, apart: 0.0 }), INEXACT);
            }
        }
        let means = self.search.means.map(|mean| mean + scene.kinematics.origin);
        let far = |solution: &Solution| {
            (0..2).map(|i| (solution.contacts[i].hit.point - means[i]).norm_squared()).sum::<f64>()
        };
        if means[0].x.is_finite() {
            self.solutions.sort_unstable_by(|a, b| far(a).total_cmp(&far(b)));
        }
    }

    fn try_open(&mut self, scene: Scene, pair: &PairEstimate, open: &Open, limit: f64) -> bool {
        let wrenches = pair.wrenches(open);
        let misfit = pair.misfit(&wrenches);
        if exceeds(misfit, limit) {
            return false;
        }
        let hits = [0, 1].map(|i| self.caster.hit_on(scene, pair.bodies[i], &wrenches[i]));
        let [Some(first), Some(second)] = hits else { return false };
        self.keep(wrenches, [first, second], misfit);
        true
    }
}
