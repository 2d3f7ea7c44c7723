//! What may be wrong with torques or model, each as a target and a prior.

use nalgebra::DMatrix;

use super::assignment::assign;
use super::evidence::{Evidence, DELAYS, OWN};
use super::fit::{fit, Fit};
use super::prior::{Prior, Reference};
use super::target::Target;
use crate::calibration::rows::Term;
use crate::robot::Robot;

/// Terms that a fault of a joint's own torque may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum OwnFault {
    Armature,
    Friction,
    Bias,
}

impl OwnFault {
    pub fn terms(self) -> &'static [Term] {
        match self {
            OwnFault::Armature => &[Term::Armature],
            OwnFault::Friction => &[Term::Coulomb, Term::Viscous],
            OwnFault::Bias => &[Term::Bias],
        }
    }
}

/// A fault of torques or model.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Fault {
    /// Torques of these joints with the wrong sign.
    Sign(Vec<usize>),
    /// Torque of one joint, or of all, times a factor.
    Scale(Option<usize>, f64),
    GravityFree,
    /// Gravity of the robot.
    Gravity([f64; 3]),
    /// The torque of joint k is in this column.
    Permuted(Vec<usize>),
    /// Something else is fixed to a body.
    Load(usize),
    Own(OwnFault, Vec<usize>),
    /// Torque late by so much.
    Delay(f64),
}

impl Fault {
    /// Whether both are about the same thing, whatever its size.
    pub fn is_like(&self, other: &Fault) -> bool {
        match (self, other) {
            (Fault::Scale(a, _), Fault::Scale(b, _)) => a == b,
            (Fault::Gravity(_) | Fault::GravityFree, Fault::Gravity(_) | Fault::GravityFree) => true,
            (Fault::Delay(_), Fault::Delay(_)) => true,
            (Fault::Permuted(_), Fault::Permuted(_)) => true,
            (Fault::Own(a, joints), Fault::Own(b, others)) => {
                a == b && joints.iter().all(|j| others.contains(j))
            }
            _ => self == other,
        }
    }
}

/// A fault with the explanation that it gives.
#[derive(Debug, Clone)]
pub(super) struct Explained {
    pub fault: Fault,
    pub fit: Fit,
    pub target: Target,
    /// Of the marginal likelihood's logarithm, what choosing among faults costs taken off.
    pub score: f64,
}

/// Free numbers that a likelihood was maximised over, and faults that were tried, cost evidence (nats).
const PER_NUMBER: f64 = 2.5;
const PER_CHOICE: f64 = 1.0;

/// What hypotheses are tried on.
pub(super) struct Trial<'a> {
    pub robot: &'a Robot,
    pub evidence: &'a Evidence,
    pub prior: &'a Prior,
    pub reference: &'a Reference,
}

impl Trial<'_> {
    fn explained(&self, fault: Fault, target: Target, prior: &Prior, cost: f64) -> Option<Explained> {
        let fit = fit(self.evidence, &target, prior)?;
        let score = fit.score - cost;
        Some(Explained { fault, fit, target, score })
    }

    /// What a log without fault looks like.
    pub fn faultless(&self) -> Option<Fit> {
        fit(self.evidence, &Target::plain(self.evidence), self.prior)
    }

    /// All faults, the likeliest first.
    pub fn all(&self) -> Vec<Explained> {
        let mut found = vec![];
        let nv = self.evidence.nv;
        let choice = PER_CHOICE * (nv as f64).ln();
        found.extend(self.signs());
        for joint in std::iter::once(None).chain((0..nv).map(Some)) {
            let cost = PER_NUMBER + if joint.is_some() { choice } else { 0.0 };
            found.extend(self.scale(joint, cost));
        }
        found.extend(self.gravity());
        found.extend(self.permuted());
        for body in self.tips() {
            let prior = self.prior.clone().loaded(self.reference, body);
            found.extend(self.explained(Fault::Load(body), Target::plain(self.evidence), &prior, PER_CHOICE));
        }
        for own in [OwnFault::Armature, OwnFault::Friction, OwnFault::Bias] {
            if own == OwnFault::Armature && !self.evidence.moving {
                continue;
            }
            for joint in 0..nv {
                found.extend(self.own(own, vec![joint], choice));
            }
            found.extend(self.own(own, (0..nv).collect(), 0.0));
        }
        found.extend(self.delay());
        found.sort_by(|a, b| b.score.total_cmp(&a.score));
        found
    }

    fn signs(&self) -> Vec<Explained> {
        let nv = self.evidence.nv;
        let flipped = |joints: &[usize]| {
            joints.iter().fold(Target::plain(self.evidence), |target, joint| {
                target.scaled(self.evidence, *joint, -1.0)
            })
        };
        let choice = PER_CHOICE * (nv as f64).ln();
        let plain = self.faultless().map_or(f64::NEG_INFINITY, |fit| fit.score);
        let mut found: Vec<Explained> = (0..nv)
            .filter_map(|joint| {
                self.explained(Fault::Sign(vec![joint]), flipped(&[joint]), self.prior, choice)
            })
            .collect();
        let better: Vec<usize> = (0..found.len()).filter(|k| found[*k].score > plain).collect();
        if better.len() > 1 && better.len() < nv {
            let cost = choice * better.len() as f64;
            found.extend(self.explained(Fault::Sign(better.clone()), flipped(&better), self.prior, cost));
        }
        let all: Vec<usize> = (0..nv).collect();
        found.extend(self.explained(Fault::Sign(all.clone()), flipped(&all), self.prior, 0.0));
        found
    }

    /// A factor of torques by turns with what else explains them.
    fn scale(&self, joint: Option<usize>, cost: f64) -> Option<Explained> {
        const ROUNDS: usize = 3;
        /// First and last step of the search for the factor, relative.
        const SEARCH: f64 = 0.3;
        const FINEST: f64 = 0.01;
        let evidence = self.evidence;
        let joints: Vec<usize> = joint.map_or_else(|| (0..evidence.nv).collect(), |joint| vec![joint]);
        let mut factor = 0.0;
        let mut x = nalgebra::DVector::zeros(evidence.unknowns());
        // All joints count alike at first: the noise of a fit with the wrong factor says little.
        let mut sigma: Vec<f64> = (0..evidence.nv)
            .map(|k| evidence.square(k, evidence.parts.torque(k)).sqrt().max(evidence.floor[k]))
            .collect();
        let mut best: Option<Explained> = None;
        for _ in 0..ROUNDS {
            let (mut along, mut square) = (0.0, 0.0);
            for &k in &joints {
                let sums = &evidence.sums[k];
                let (torque, model) = (evidence.parts.torque(k), evidence.parts.model());
                let own = nalgebra::DVector::from_iterator(
                    sums.unknowns.nrows(),
                    (0..sums.unknowns.nrows()).map(|column| x[evidence.global(k, column)]),
                );
                let explained = &sums.unknowns * &own;
                let weight = 1.0 / (sigma[k] * sigma[k]);
                along += weight * (sums.parts[(torque, model)] + own.dot(&sums.cross.column(torque)));
                square += weight
                    * (sums.parts[(model, model)]
                        + 2.0 * own.dot(&sums.cross.column(model))
                        + own.dot(&explained));
            }
            let next = along / square.max(1e-12);
            if next.abs() < 1e-4 || !next.is_finite() {
                return best;
            }
            let settled = (next - factor).abs() < 1e-3 * next.abs();
            factor = next;
            let target =
                joints.iter().fold(Target::plain(evidence), |target, k| target.scaled(evidence, *k, factor));
            let explained = self.explained(Fault::Scale(joint, factor), target, self.prior, cost)?;
            x = explained.fit.x.clone();
            sigma = explained.fit.sigma.iter().zip(&explained.target.factor).map(|(s, f)| s / f).collect();
            if best.as_ref().is_none_or(|best| explained.score > best.score) {
                best = Some(explained);
            }
            if settled {
                break;
            }
        }
        // Masses and factor make up for each other, so that taking turns converges slowly.
        let mut step = SEARCH;
        while step > FINEST {
            let Fault::Scale(_, middle) = best.as_ref()?.fault else { break };
            for factor in [middle * (1.0 + step), middle / (1.0 + step)] {
                let target = joints
                    .iter()
                    .fold(Target::plain(evidence), |target, k| target.scaled(evidence, *k, factor));
                let explained = self.explained(Fault::Scale(joint, factor), target, self.prior, cost)?;
                if best.as_ref().is_none_or(|best| explained.score > best.score) {
                    best = Some(explained);
                }
            }
            step *= 0.5;
        }
        best
    }

    fn gravity(&self) -> Vec<Explained> {
        /// Of the earth (m/s^2), for models that have none.
        const EARTH: f64 = 9.81;
        let evidence = self.evidence;
        let known = self.robot.gravity;
        let plain = Target::plain(evidence);
        let mut found = vec![];
        if known.norm() > 1.0 {
            let none = plain.clone().with_gravity_change(evidence, &[-known.x, -known.y, -known.z]);
            found.extend(self.explained(Fault::GravityFree, none, self.prior, 0.0));
        }
        let size = if known.norm() > 1.0 { known.norm() } else { EARTH };
        let free = self.prior.clone().any_gravity();
        let Some(mut loose) = fit(evidence, &plain, &free) else { return found };
        // The direction alone is free; along it the rest is found anew.
        let at = evidence.unknowns() - 3;
        for _ in 0..4 {
            let wanted = nalgebra::Vector3::from_fn(|k, _| known[k] + loose.x[at + k]);
            if wanted.norm() < 0.2 * size {
                return found;
            }
            let turned = wanted * (size / wanted.norm());
            let change = [turned.x - known.x, turned.y - known.y, turned.z - known.z];
            let target = plain.clone().with_gravity_change(evidence, &change);
            let fault = Fault::Gravity([turned.x, turned.y, turned.z]);
            let Some(explained) = self.explained(fault, target.clone(), self.prior, 2.0 * PER_NUMBER) else {
                break;
            };
            // A small turn from here.
            let mut near = self.prior.clone();
            near.gravity = Some(0.3 * size);
            found.push(explained);
            let Some(next) = fit(evidence, &target, &near) else { break };
            loose = next;
            for k in 0..3 {
                loose.x[at + k] += change[k];
            }
        }
        found
    }

    /// Torques in another order: the assignment under which each fits its joint best.
    fn permuted(&self) -> Option<Explained> {
        /// Error of a model relative to its torque that does not speak against an order.
        const ERROR: f64 = 0.05;
        /// A joint keeps its own torque where another fits no better than by so much (nats).
        const STAY: f64 = 3.0;
        let evidence = self.evidence;
        let nv = evidence.nv;
        let own = evidence.inertial..evidence.inertial + OWN.len();
        let weight = evidence.effective / evidence.rows;
        let mut cost = DMatrix::zeros(nv, nv);
        for k in 0..nv {
            let sums = &evidence.sums[k];
            let model = evidence.parts.model();
            let floor = (ERROR * ERROR * sums.parts[(model, model)] / evidence.rows).sqrt();
            for other in 0..nv {
                let torque = evidence.parts.torque(other);
                let floor = floor.hypot(evidence.floor[other]);
                let mut matrix = sums.unknowns.view((own.start, own.start), (own.len(), own.len())) * weight
                    / (floor * floor);
                for (term, sd) in self.prior.own[k].iter().enumerate() {
                    matrix[(term, term)] += 1.0 / (sd * sd);
                }
                let right = (sums.cross.view((own.start, torque), (own.len(), 1))
                    - sums.cross.view((own.start, model), (own.len(), 1)))
                    * weight
                    / (floor * floor);
                let square = sums.parts[(torque, torque)] - 2.0 * sums.parts[(torque, model)]
                    + sums.parts[(model, model)];
                let explained =
                    nalgebra::Cholesky::new(matrix).map_or(0.0, |factor| factor.solve(&right).dot(&right));
                let misfit = (weight * square / (floor * floor) - explained).max(0.0) / evidence.effective;
                cost[(k, other)] = 0.5 * evidence.effective * (misfit + 1.0).ln()
                    + evidence.effective * floor.ln()
                    - if k == other { STAY } else { 0.0 };
            }
        }
        let order = assign(&cost);
        let moved = order.iter().enumerate().filter(|(k, column)| k != *column).count();
        let choices: f64 = (0..moved).map(|k| ((nv - k) as f64).ln()).sum();
        let target = Target::reordered(evidence, &order);
        (moved > 0)
            .then(|| self.explained(Fault::Permuted(order), target, self.prior, PER_CHOICE * choices))?
    }

    /// Bodies that may carry something: ends of chains, and what several chains start from.
    fn tips(&self) -> Vec<usize> {
        let count = self.robot.body_count();
        let children =
            |body: usize| (1..count).filter(|other| self.robot.parent_body(*other) == body).count();
        (1..count).filter(|body| children(*body) != 1).collect()
    }

    fn own(&self, own: OwnFault, joints: Vec<usize>, cost: f64) -> Option<Explained> {
        let prior = joints
            .iter()
            .fold(self.prior.clone(), |prior, joint| prior.widened(self.reference, *joint, own.terms()));
        self.explained(Fault::Own(own, joints), Target::plain(self.evidence), &prior, cost)
    }

    /// The delay of all torques that explains them best.
    fn delay(&self) -> Option<Explained> {
        if !self.evidence.moving {
            return None;
        }
        let at = |delay: f64| {
            let target = Target::plain(self.evidence).later(self.evidence, delay, None);
            self.explained(Fault::Delay(delay), target, self.prior, PER_NUMBER)
        };
        let coarse: Vec<Explained> = DELAYS.iter().filter_map(|delay| at(*delay)).collect();
        let best = (0..coarse.len()).max_by(|a, b| coarse[*a].score.total_cmp(&coarse[*b].score))?;
        let delay = DELAYS[best];
        let half = if best + 1 < DELAYS.len() { 0.5 * (DELAYS[best + 1] - delay) } else { 0.0 };
        let near = [-half, -0.5 * half, 0.5 * half, half].into_iter().filter_map(|step| at(delay + step));
        near.chain(std::iter::once(coarse[best].clone())).max_by(|a, b| a.score.total_cmp(&b.score))
    }
}
