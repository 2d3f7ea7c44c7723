//! What may be wrong with torques or model, each as a target and a prior.

use super::evidence::Evidence;
use super::fit::{fit, Fit};
use super::prior::{Prior, Reference};
use super::target::Target;
use super::terms::COULOMB;
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
            OwnFault::Friction => &[COULOMB, Term::Viscous],
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
pub(super) const PER_NUMBER: f64 = 2.5;
pub(super) const PER_CHOICE: f64 = 1.0;

/// What hypotheses are tried on.
pub(super) struct Trial<'a> {
    pub robot: &'a Robot,
    pub evidence: &'a Evidence,
    pub prior: &'a Prior,
    pub reference: &'a Reference,
}

impl Trial<'_> {
    pub(super) fn explained(
        &self,
        fault: Fault,
        target: Target,
        prior: &Prior,
        cost: f64,
    ) -> Option<Explained> {
        let fit = fit(self.evidence, &target, prior)?;
        let score = fit.score - cost;
        Some(Explained { fault, fit, target, score })
    }

    /// What a log without fault looks like.
    pub fn faultless(&self) -> Option<Fit> {
        fit(self.evidence, &Target::plain(self.evidence.parts), self.prior)
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
            found.extend(self.explained(
                Fault::Load(body),
                Target::plain(self.evidence.parts),
                &prior,
                PER_CHOICE,
            ));
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
            joints.iter().fold(Target::plain(self.evidence.parts), |target, joint| {
                target.scaled(self.evidence.parts, *joint, -1.0)
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
        self.explained(Fault::Own(own, joints), Target::plain(self.evidence.parts), &prior, cost)
    }
}
