//! Which bodies are touched if one force does not explain the torques, and where (Vorndamme 2017, IV-B, and beyond).
//!
//! Forces that the joints behind the others determine are found one by one from the tips; two that share their joints
//! are solved for together. What is known of contacts helps: no moment, on the surface, pushing.

use nalgebra::Vector3;

use super::caster::Caster;
use super::found::{Entry, Found, Solution};
use super::hypothesis::{Hypothesis, TRIED};
use super::stacked::Stacked;
use super::surface_search::{steepness, SurfaceSearch};
use super::tips::TipSearch;
use super::work::Work;
use super::wrench::WrenchEstimate;
use crate::robot::Robot;

/// What rounding leaves of an exact solution [tolerances].
pub(super) const EXACT: f64 = 1e-6;
/// Root mean square of what a good solution leaves under noise [tolerances].
pub(super) const GOOD: f64 = 1.0;
/// Multiplications of an estimate of two wrenches.
pub(super) const PAIR_WORK: usize = 6000;
/// Solutions kept.
const SOLUTIONS: usize = 16;

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
    pub(super) tips: TipSearch,
    pub(super) caster: Caster,
    pub(super) search: SurfaceSearch,
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

    /// The tolerances of an exact solution are wide for the sake of its numbers; the errors of the torques are not.
    pub fn narrow(&mut self, share: f64) {
        let pairs = self.solutions.iter_mut().flat_map(|solution| &mut solution.contacts);
        self.found.iter_mut().chain(pairs).for_each(|found| found.wrench.narrow(share));
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
