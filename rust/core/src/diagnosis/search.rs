//! Faults of torques and model one after the other: the likeliest is found, mended, and the log looked at again.

use nalgebra::DMatrix;

use super::evidence::Evidence;
use super::finding::Finding;
use super::fit::{fit, Fit};
use super::hypothesis::{Explained, Fault, OwnFault, Trial};
use super::motion::{median, Motion};
use super::prior::{Prior, Reference};
use super::report;
use super::target::Target;
use super::unjudged;
use crate::robot::Robot;

/// So many faults are looked for.
const MOST: usize = 6;

/// A fault must be likelier than its absence by this factor's logarithm (nats), many kinds being tried.
const LEAST_GAIN: f64 = 7.0;

/// A row is left out where a joint's error is so many times the usual.
const OUTLYING: f64 = 8.0;

/// More outlying rows than this share are no outliers.
const MOST_OUTLYING: f64 = 0.25;

/// Poses at which the robot's inertia is looked at.
const POSES: usize = 20;

/// What is known so far.
struct State {
    robot: Robot,
    motion: Motion,
    widened: Vec<(OwnFault, usize)>,
    loaded: Vec<usize>,
}

impl State {
    fn prior(&self, reference: &Reference) -> Prior {
        let prior = Prior::normal(&self.robot, reference);
        let prior = self
            .widened
            .iter()
            .fold(prior, |prior, (own, joint)| prior.widened(reference, *joint, own.terms()));
        self.loaded.iter().fold(prior, |prior, body| prior.loaded(reference, *body))
    }

    /// Takes a fault out of robot or measurements; whether rows must be computed anew.
    fn mend(&mut self, fault: &Fault) -> bool {
        let nv = self.motion.nv;
        match fault {
            Fault::Sign(joints) => {
                for row in self.motion.tau.chunks_exact_mut(nv) {
                    joints.iter().for_each(|joint| row[*joint] *= -1.0);
                }
            }
            Fault::Scale(joint, factor) => {
                for row in self.motion.tau.chunks_exact_mut(nv) {
                    let joints = joint.map_or(0..nv, |joint| joint..joint + 1);
                    row[joints].iter_mut().for_each(|tau| *tau /= factor);
                }
            }
            Fault::GravityFree => self.robot.gravity.fill(0.0),
            Fault::Gravity(gravity) => self.robot.gravity = (*gravity).into(),
            Fault::Permuted(order) => {
                for row in self.motion.tau.chunks_exact_mut(nv) {
                    let old = row.to_vec();
                    row.iter_mut().zip(order).for_each(|(tau, column)| *tau = old[*column]);
                }
            }
            Fault::Delay(delay) => self.motion.tau = self.motion.shifted(&self.motion.tau, *delay),
            Fault::Load(body) => {
                self.loaded.push(*body);
                return false;
            }
            Fault::Own(own, joints) => {
                self.widened.extend(joints.iter().map(|joint| (*own, *joint)));
                return false;
            }
        }
        true
    }
}

/// Everything found in the torques; `left_out` says for each row of the motion whether it must not be used.
pub(super) fn search(robot: &Robot, motion: &Motion, left_out: &[bool]) -> Vec<Finding> {
    let mut state = State { robot: robot.clone(), motion: motion.clone(), widened: vec![], loaded: vec![] };
    let mut findings = vec![];
    let mut known: Vec<Fault> = vec![];
    let mut evidence = usable(&state, left_out);
    let poses: Vec<Vec<f64>> = (0..POSES)
        .map(|k| motion.q[k * motion.len() / POSES * robot.nq()..][..robot.nq()].to_vec())
        .collect();
    for _ in 0..MOST {
        let reference = Reference::new(&state.robot, &evidence, &poses);
        let prior = state.prior(&reference);
        let trial = |evidence: &Evidence| -> Option<(Fit, Explained)> {
            let trial = Trial { robot: &state.robot, evidence, prior: &prior, reference: &reference };
            let plain = trial.faultless()?;
            let mut all = trial.all();
            all.retain(|explained| !known.iter().any(|fault| explained.fault.is_like(fault)));
            let best = all.into_iter().next()?;
            Some((plain, best))
        };
        let Some((mut plain, mut best)) = trial(&evidence) else { break };
        if leave_outliers_out(&mut evidence, &best, &plain) {
            match trial(&evidence) {
                Some(again) => (plain, best) = again,
                None => break,
            }
        }
        if best.score - plain.score < LEAST_GAIN {
            break;
        }
        if let Fault::Scale(joint, factor) = best.fault {
            if factor < 0.0 {
                best.fault =
                    Fault::Sign(joint.map_or_else(|| (0..evidence.nv).collect(), |joint| vec![joint]));
            }
        }
        findings.extend(report::findings(&state.robot, &evidence, &reference, &plain, &best));
        known.push(best.fault.clone());
        if state.mend(&best.fault) {
            evidence = usable(&state, left_out);
        }
    }
    let reference = Reference::new(&state.robot, &evidence, &poses);
    let prior = state.prior(&reference);
    let left = fit(&evidence, &Target::plain(evidence.parts), &prior);
    findings.extend(unjudged::unexplained_torques(&evidence, &reference, left.as_ref()));
    findings
}

fn usable(state: &State, left_out: &[bool]) -> Evidence {
    let mut evidence = Evidence::new(&state.robot, &state.motion);
    let kept: Vec<bool> = evidence.indices.iter().map(|row| !left_out[*row]).collect();
    if kept.iter().any(|kept| !kept) && kept.iter().any(|kept| *kept) {
        evidence.keep(kept);
    }
    evidence
}

/// Leaves rows out that the best explanation misses by far, as contacts do; whether there were any.
fn leave_outliers_out(evidence: &mut Evidence, best: &Explained, plain: &Fit) -> bool {
    let (target, x) = match best.score > plain.score {
        true => (best.target.clone(), &best.fit.x),
        false => (Target::plain(evidence.parts), &plain.x),
    };
    let left: DMatrix<f64> = evidence.left_over(&target, x);
    let limits: Vec<f64> = (0..evidence.nv)
        .map(|k| {
            let usual = 1.48 * median(left.column(k).iter().map(|r| r.abs()).collect());
            OUTLYING * usual.max(evidence.floor[k] * target.factor[k])
        })
        .collect();
    let kept: Vec<bool> = left
        .row_iter()
        .zip(evidence.kept())
        .map(|(row, kept)| *kept && row.iter().zip(&limits).all(|(r, limit)| r.abs() <= *limit))
        .collect();
    let before = evidence.kept().iter().filter(|kept| **kept).count();
    let after = kept.iter().filter(|kept| **kept).count();
    if after == before || ((before - after) as f64) > MOST_OUTLYING * before as f64 {
        return false;
    }
    evidence.keep(kept);
    true
}
