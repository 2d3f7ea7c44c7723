//! Which two bodies are touched where torques have noise. The last joint over its threshold does not tell: a force on a
//! body around may explain the torques as well or better. The most likely pair contradicts all torques least.

use super::found::{Entry, Scene};
use super::hypothesis::{Hypothesis, TRIED};
use super::pair::{estimate_pair, PairEstimate};
use super::rows::TorqueRows;
use super::several::{SeveralContacts, GOOD, PAIR_WORK};
use super::surface_search::steepness;
use super::wrench::{DEVIATION, LINE_UNKNOWNS, UNLIKELY};
use crate::math::chi_square::upper_limit;
use crate::robot::WORLD;

/// A contact is looked for on bodies at most so many joints away.
const AROUND: usize = 2;
/// Rounds over both contacts until the bodies stand still.
const ROUNDS: usize = 3;
/// What a pair may leave of the torques.
#[derive(Clone, Copy)]
enum Most {
    /// No more than noise: where the pair is to do without a tip, or to take the place of one force.
    Noise,
    /// What any solution may leave.
    Good,
}

impl Most {
    fn chi_square(self, checks: usize) -> f64 {
        match self {
            Most::Noise => upper_limit(checks),
            Most::Good => checks as f64 * (GOOD / DEVIATION).powi(2),
        }
    }
}

/// Of all torques; `inside` is the sum of squares, in tolerances, of those that a force on one of the bodies moves.
fn chi_square(scene: Scene, rows: &TorqueRows, pair: &PairEstimate, inside: f64) -> f64 {
    let robot = scene.robot;
    let moved = |joint: usize| pair.bodies.iter().any(|body| robot.moves(joint, *body));
    let mut squares = inside;
    for joint in (1..robot.body_count()).filter(|joint| scene.region.joints[*joint] && !moved(*joint)) {
        squares +=
            robot.velocity_range(joint).map(|k| (rows.torque[k] / rows.tolerance[k]).powi(2)).sum::<f64>();
    }
    squares / (DEVIATION * DEVIATION)
}

/// Whether there are few joints between the bodies.
fn is_around(scene: Scene, body: usize, other: usize) -> bool {
    let (chain, others) = (scene.robot.chain(body), scene.robot.chain(other));
    let common = chain.iter().zip(others).take_while(|(a, b)| a == b).count();
    chain.len() + others.len() <= 2 * common + AROUND
}

impl SeveralContacts {
    /// The most likely pair of bodies around those of the solution, or around two of `tips` that feel contacts, takes the
    /// place of the solution; false, and nothing changed, where there is none that is determined and explains the torques
    /// better.
    pub(super) fn choose_bodies(&mut self, scene: Scene, rows: &TorqueRows, tips: &[usize]) -> bool {
        let most = if tips.len() > 2 { Most::Noise } else { Most::Good };
        self.choose(scene, rows, tips, most)
    }

    /// Two forces that leave no more than noise of the torques that one does not explain.
    pub(super) fn choose_two(&mut self, scene: Scene, rows: &TorqueRows, tip: usize) -> bool {
        self.clear();
        self.choose(scene, rows, &[tip], Most::Noise)
    }

    fn choose(&mut self, scene: Scene, rows: &TorqueRows, tips: &[usize], most: Most) -> bool {
        if self.max_contacts < 2 {
            return false;
        }
        self.tried.clear();
        let solved = self.solved_bodies(scene);
        let open = solved.filter(|_| self.rank_deficit > 0);
        let least = open.map_or(f64::INFINITY, |bodies| self.open_chi_square(scene, rows, bodies));
        let mut best =
            Hypothesis { bodies: solved.unwrap_or([WORLD; 2]), chi_square: least, entries: [None; 2] };
        match (solved, tips) {
            (Some(bodies), _) => self.try_pair(scene, rows, bodies, &mut best),
            (None, [tip]) => {
                for before in scene.region.chain(scene.robot, *tip).filter(|before| before != tip) {
                    self.try_pair(scene, rows, [before, *tip], &mut best);
                }
            }
            (None, _) => {
                for (index, first) in tips.iter().enumerate() {
                    for second in &tips[index + 1..] {
                        self.try_pair(scene, rows, [*second, *first], &mut best);
                    }
                }
            }
        }
        if best.bodies == [WORLD; 2] {
            // None of these is determined; those around may be.
            let Some(first) = tips.first() else { return false };
            let second = tips.get(1).copied().or_else(|| scene.region.chain(scene.robot, *first).next());
            best.bodies = [second.unwrap_or(*first), *first];
        }
        for _ in 0..ROUNDS {
            let bodies = best.bodies;
            for side in 0..2 {
                for other in WORLD + 1..scene.robot.body_count() {
                    if is_around(scene, bodies[side], other) {
                        let mut pair = best.bodies;
                        pair[side] = other;
                        self.try_pair(scene, rows, pair, &mut best);
                    }
                }
            }
            if best.bodies == bodies {
                break;
            }
        }
        let kept = best.chi_square < least && self.keep_likely(scene, rows, &best, most);
        self.open = if kept { least < best.chi_square + UNLIKELY } else { self.open };
        kept
    }

    /// The bodies of the solution.
    fn solved_bodies(&self, scene: Scene) -> Option<[usize; 2]> {
        let contacts = self.solutions.first().map(|solution| &solution.contacts)?;
        Some(contacts.each_ref().map(|found| scene.robot[found.hit.link].body))
    }

    /// Of the solution, which leaves a part of the wrenches open: at least this.
    fn open_chi_square(&self, scene: Scene, rows: &TorqueRows, bodies: [usize; 2]) -> f64 {
        let across = self.solutions.first().map_or(0.0, |solution| solution.steepness);
        estimate_pair(scene.robot, scene.region, rows, bodies)
            .map_or(f64::INFINITY, |pair| across + chi_square(scene, rows, &pair, pair.unexplained_squares()))
    }

    /// The hypothesis becomes the solution.
    fn keep_likely(&mut self, scene: Scene, rows: &TorqueRows, best: &Hypothesis, most: Most) -> bool {
        let [Some(first), Some(second)] = best.entries else { return false };
        let count =
            scene.region.feels.iter().filter(|feels| **feels).count() + 6 * usize::from(rows.root.is_some());
        let checks = count.saturating_sub(2 * LINE_UNKNOWNS).max(1);
        if best.chi_square > most.chi_square(checks) {
            return false;
        }
        let Some(pair) = estimate_pair(scene.robot, scene.region, rows, best.bodies) else { return false };
        let wrenches = pair.wrenches(&[0.0; 6]);
        let misfit = pair.misfit(&wrenches);
        self.found.clear();
        self.solutions.clear();
        self.rank_deficit = 0;
        self.verified = pair.checks() > 0;
        self.open = false;
        let mut entries = [first, second];
        for (side, entry) in entries.iter_mut().enumerate() {
            let likely = self.tried.iter().filter(|other| other.chi_square < best.chi_square + UNLIKELY);
            let rivals = likely.filter_map(|other| other.entries[side]);
            let distance = |rival: Entry| (rival.hit.point - entry.hit.point).norm();
            entry.apart = rivals.map(distance).fold(entry.apart, f64::max);
        }
        self.keep(wrenches, entries, misfit);
        true
    }

    /// Judges forces on two bodies, unless that is done already.
    fn try_pair(&mut self, scene: Scene, rows: &TorqueRows, bodies: [usize; 2], best: &mut Hypothesis) {
        let known = |other: &Hypothesis| other.bodies == bodies;
        if bodies[0] == bodies[1] || self.tried.iter().any(known) || self.tried.len() == TRIED {
            return;
        }
        let Some(hypothesis) = self.judge_pair(scene, rows, bodies) else { return };
        self.tried.push(hypothesis);
        if hypothesis.chi_square < best.chi_square {
            *best = hypothesis;
        }
    }

    /// None where the torques do not determine both wrenches.
    fn judge_pair(&mut self, scene: Scene, rows: &TorqueRows, bodies: [usize; 2]) -> Option<Hypothesis> {
        let touchable = |body: usize| scene.region.links_of(scene.robot, body).next().is_some();
        if !bodies.iter().all(|body| touchable(*body)) || !self.work.spend(PAIR_WORK) {
            return None;
        }
        let pair = estimate_pair(scene.robot, scene.region, rows, bodies).filter(|pair| pair.deficit == 0)?;
        let wrenches = pair.wrenches(&[0.0; 6]);
        let inside = pair.misfit(&wrenches).powi(2) * pair.checks().max(1) as f64;
        let mut chi_square = chi_square(scene, rows, &pair, inside);
        let mut entries = [None; 2];
        for (side, entry) in entries.iter_mut().enumerate() {
            let (hit, distance) = self.caster.hit_displaced(scene, bodies[side], &wrenches[side]);
            // Forces along a surface are as unlikely as at a coefficient of friction of one.
            let across = hit.map_or(0.0, |entry| steepness(&wrenches[side].force, &entry.hit.normal));
            (*entry, chi_square) = (hit, chi_square + distance + across);
        }
        chi_square.is_finite().then_some(Hypothesis { bodies, chi_square, entries })
    }
}
