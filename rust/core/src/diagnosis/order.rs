//! Joints in another order in positions, velocities and torques alike, as when names were sorted.

use super::evidence::Evidence;
use super::finding::{FaultCode, Finding};
use super::fit::fit;
use super::hypothesis::Trial;
use super::motion::Motion;
use super::prior::{Prior, Reference};
use super::target::Target;
use crate::robot::Robot;

/// Only robots with at most so many joints are looked at: every pair of joints is tried.
const MOST_JOINTS: usize = 10;

/// Rows that orders are tried on.
const ROWS: usize = 600;

/// Swaps that make up an order.
const MOST_SWAPS: usize = 4;

/// Share of a joint's torque that a model leaves unexplained where something is grossly wrong.
const GROSS: f64 = 0.35;

/// What a joint's error must become less by, for an order is never the likely fault: the factor's logarithm, summed.
const LEAST_GAIN: f64 = 30.0;

/// The order in which the robot's joints are in the columns, if it is another and explains the log.
pub(super) fn find(robot: &Robot, motion: &Motion) -> Option<(Vec<usize>, Finding)> {
    let nv = motion.nv;
    if robot.nq() != nv || !(2..=MOST_JOINTS).contains(&nv) || !motion.consecutive {
        return None;
    }
    let few = thinned(motion, (motion.len() / ROWS).max(1));
    let identity: Vec<usize> = (0..nv).collect();
    let (plain, unexplained) = likelihood(robot, &few, &identity)?;
    if unexplained < GROSS {
        return None;
    }
    let (mut best, mut order) = (plain, identity.clone());
    for _ in 0..MOST_SWAPS {
        let mut better = None;
        for a in 0..nv {
            for b in a + 1..nv {
                let mut tried = order.clone();
                tried.swap(a, b);
                if let Some((score, _)) = likelihood(robot, &few, &tried) {
                    if score > best + (nv as f64).ln() {
                        best = score;
                        better = Some(tried);
                    }
                }
            }
        }
        match better {
            Some(next) => order = next,
            None => break,
        }
    }
    let (_, left) = likelihood(robot, &few, &order)?;
    // One fault of the torques alone is simpler.
    if order == identity || best - plain < LEAST_GAIN.max(single_fault(robot, &few).unwrap_or(0.0)) {
        return None;
    }
    let moved: Vec<String> = order
        .iter()
        .enumerate()
        .filter(|(joint, column)| joint != *column)
        .map(|(joint, column)| format!("'{}' is in column {column}", robot.joint_names()[joint]))
        .collect();
    let text = format!("q, v and tau are in another order than the robot's joints: {}", moved.join(", "));
    let share = 1.0 - (left / unexplained).min(1.0).powi(2);
    Some((order, Finding::new(FaultCode::Permuted, text).explaining(share).major_if(true)))
}

/// The motion with joint `k` taken from column `order[k]`.
pub(super) fn reordered(motion: &Motion, order: &[usize]) -> Motion {
    let nv = motion.nv;
    let take = |values: &[f64]| -> Vec<f64> {
        values.chunks_exact(nv).flat_map(|row| order.iter().map(|column| row[*column])).collect()
    };
    Motion {
        q: take(&motion.q),
        angle: take(&motion.angle),
        v: take(&motion.v),
        tau: take(&motion.tau),
        ..motion.clone()
    }
}

fn likelihood(robot: &Robot, motion: &Motion, order: &[usize]) -> Option<(f64, f64)> {
    let motion = reordered(motion, order);
    let evidence = Evidence::new(robot, &motion);
    if evidence.indices.is_empty() {
        return None;
    }
    let reference = Reference::new(robot, &evidence, &poses(robot, &motion));
    let fit = fit(&evidence, &Target::plain(evidence.parts), &Prior::normal(robot, &reference))?;
    let share = |k: usize| fit.sigma[k] / evidence.square(k, evidence.parts.torque(k)).sqrt().max(1e-9);
    let worst =
        (0..motion.nv).filter(|k| fit.sigma[*k] > 2.0 * evidence.floor[*k]).map(share).fold(0.0, f64::max);
    Some((fit.score, worst))
}

/// By how much the likeliest single fault is likelier than none.
fn single_fault(robot: &Robot, motion: &Motion) -> Option<f64> {
    let evidence = Evidence::new(robot, motion);
    let reference = Reference::new(robot, &evidence, &poses(robot, motion));
    let prior = Prior::normal(robot, &reference);
    let trial = Trial { robot, evidence: &evidence, prior: &prior, reference: &reference };
    Some(trial.all().first()?.score - trial.faultless()?.score)
}

fn poses(robot: &Robot, motion: &Motion) -> Vec<Vec<f64>> {
    motion.q.chunks_exact(robot.nq()).step_by((motion.len() / 10).max(1)).map(<[f64]>::to_vec).collect()
}

/// Every so manieth row.
fn thinned(motion: &Motion, every: usize) -> Motion {
    let take = |values: &[f64], width: usize| -> Vec<f64> {
        values.chunks_exact(width).step_by(every).flatten().copied().collect()
    };
    Motion {
        time: take(&motion.time, 1),
        stamps: take(&motion.stamps, 1),
        q: take(&motion.q, motion.q.len() / motion.len()),
        angle: take(&motion.angle, motion.nv),
        v: take(&motion.v, motion.nv),
        tau: take(&motion.tau, motion.nv),
        ..motion.clone()
    }
}
