//! Which bodies are touched if one force does not explain the torques, and where (Vorndamme 2017, IV-B, and beyond).
//!
//! Forces that the joints behind the others determine are found one by one from the tips; two that share their joints
//! are solved for together. What is known of contacts helps: no moment, on the surface, pushing.

use nalgebra::Vector3;

use super::caster::Caster;
use super::found::{Entry, Found, Scene, Solution};
use super::likely::{Hypothesis, TRIED};
use super::open_part::{close, close_near};
use super::pair::{estimate_pair, Open, PairEstimate};
use super::rows::{TorqueRows, SILENT};
use super::stacked::Stacked;
use super::surface_search::{steepness, SurfaceSearch, PAIRS, STARTS};
use super::tips::TipSearch;
use super::work::Work;
use super::wrench::WrenchEstimate;
use super::wrench_rows::WrenchRows;
use crate::math::least_squares::exceeds;
use crate::robot::{Robot, WORLD};

/// What rounding leaves of an exact solution [tolerances].
const EXACT: f64 = 1e-6;
/// Root mean square of what a good solution leaves under noise [tolerances].
pub(super) const GOOD: f64 = 1.0;
/// Misfit of a solution between samples of the surfaces, which is not exact.
const INEXACT: f64 = f64::INFINITY;
/// Solutions kept.
const SOLUTIONS: usize = 16;
/// Rounds until the contact links stand still; ten, as in Vorndamme 2017.
const ROUNDS: usize = 10;
/// Multiplications of an estimate of two wrenches, and of a pair of sampled places.
pub(super) const PAIR_WORK: usize = 6000;
const PLACES_WORK: usize = 80;
/// A search with fewer pairs of places says nothing.
const FEWEST_PAIRS: usize = 400;

/// Workspace, and the answer: contacts found one by one, and solutions for two more, best first.
#[derive(Debug, Clone)]
pub(super) struct SeveralContacts {
    pub found: Vec<Found>,
    pub solutions: Vec<Solution>,
    /// Of the solutions.
    pub rank_deficit: usize,
    /// Whether more conditions were met than unknowns were fitted.
    pub verified: bool,
    /// Whether the thresholds contradict the solution.
    pub contradicted: bool,
    /// Whether nothing checks how the sum of two wrenches was divided: the solutions are as many as conditions allow.
    pub open: bool,
    /// How many contacts were taken out one by one by the exact solution.
    pub peeled: usize,
    /// What is left of the work that one call may take.
    pub work: Work,
    pub(super) max_contacts: usize,
    tips: TipSearch,
    pub(super) caster: Caster,
    search: SurfaceSearch,
    pub(super) stacked: Stacked,
    pub(super) bodies: Vec<usize>,
    /// Misfit of one more wrench, and its body, best first.
    pub(super) one_more: Vec<(f64, usize)>,
    pub(super) places: Vec<(usize, Vector3<f64>)>,
    /// Pairs of bodies that have been judged.
    pub(super) tried: Vec<Hypothesis>,
}

impl SeveralContacts {
    pub fn new(robot: &Robot, max_contacts: usize) -> Self {
        Self {
            found: Vec::with_capacity(max_contacts),
            solutions: Vec::with_capacity(SOLUTIONS + 1),
            rank_deficit: 0,
            verified: false,
            contradicted: false,
            open: false,
            peeled: 0,
            work: Work::new(),
            max_contacts,
            tips: TipSearch::new(robot),
            caster: Caster::new(),
            search: SurfaceSearch::new(robot),
            stacked: Stacked::new(robot, max_contacts),
            bodies: Vec::with_capacity(max_contacts + 1),
            one_more: Vec::with_capacity(robot.body_count()),
            places: Vec::with_capacity(max_contacts + 2),
            tried: Vec::with_capacity(TRIED),
        }
    }

    pub(super) fn clear(&mut self) {
        self.found.clear();
        self.solutions.clear();
        self.rank_deficit = 0;
        self.verified = false;
        self.open = false;
        self.contradicted = false;
    }

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

    /// The tolerances of an exact solution are wide for the sake of its numbers; the errors of the torques are not.
    pub fn narrow(&mut self, share: f64) {
        let pairs = self.solutions.iter_mut().flat_map(|solution| &mut solution.contacts);
        self.found.iter_mut().chain(pairs).for_each(|found| found.wrench.narrow(share));
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

    /// The last contact: all that is left is one force.
    fn find_last(&mut self, scene: Scene, rows: &TorqueRows, tip: usize) -> bool {
        let wrench = total_wrench(scene, rows, tip);
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

    /// Every pair of forces on two bodies, or on bodies behind them that their lines hit, that explains the torques
    /// but for `limit`. Without a proof (more conditions than unknowns) only if the torques are taken to be exact, and a
    /// free base or a sensor tells the sum of both.
    fn solve_pair(&mut self, scene: Scene, rows: &TorqueRows, mut bodies: [usize; 2], limit: f64) -> bool {
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

    /// Adds a solution in its place: those that push most squarely first.
    pub(super) fn keep(&mut self, wrenches: [WrenchEstimate; 2], entries: [Entry; 2], misfit: f64) {
        let steep: f64 = wrenches.iter().zip(&entries).map(|(w, e)| steepness(&w.force, &e.hit.normal)).sum();
        let rank = self.solutions.partition_point(|other| other.steepness <= steep);
        if rank < SOLUTIONS {
            let [first, second] = wrenches;
            let contacts = [Found::new(first, entries[0]), Found::new(second, entries[1])];
            self.solutions.insert(rank, Solution { contacts, misfit, steepness: steep });
            self.solutions.truncate(SOLUTIONS);
        }
    }
}

/// The total wrench that the joints up to `body`, and a sensor, feel.
fn total_wrench(scene: Scene, rows: &TorqueRows, body: usize) -> WrenchEstimate {
    let mut wrench_rows = WrenchRows::new();
    rows.push_root(&mut wrench_rows);
    for joint in scene.region.chain(scene.robot, body) {
        rows.push_joint(scene.robot, joint, &mut wrench_rows);
    }
    WrenchEstimate::from_rows(wrench_rows)
}

/// Whether all joints behind `before` on the way to `tip` feel what the total wrench of the joints up to there causes.
fn rest_is_explained(scene: Scene, rows: &TorqueRows, before: usize, tip: usize) -> bool {
    let robot = scene.robot;
    let total = total_wrench(scene, rows, before);
    let behind = |joint: &usize| !robot.moves(*joint, before);
    let mut rest = scene.region.chain(robot, tip).filter(behind);
    total.rank < 6 || rest.all(|joint| rows.explains(robot, joint, &total, 1.0))
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
