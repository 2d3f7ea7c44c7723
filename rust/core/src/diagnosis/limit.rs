//! Joints that stand at a limit of their position: the stop bears a torque that no model has.

use super::evidence::Evidence;
use super::finding::{FaultCode, Finding};
use super::motion::Motion;
use crate::robot::{JointKind, Robot};

/// Nearer than this a joint is at its limit (rad; m), or nearer than this share of its range.
const NEAR: f64 = 2e-3;
const NEAR_SHARE: f64 = 1e-3;

/// A joint stands where it is slower than this share of its usual speed, or than this (rad/s; m/s).
const STANDS_SHARE: f64 = 0.05;
const STANDS: f64 = 5e-3;

/// It stands there at least so long without a break (s), or so many rows.
const LEAST_TIME: f64 = 0.25;
const LEAST_ROWS: usize = 10;

/// Torque of the stop that matters (Nm), or as a share of what the joint is made for.
const PUSH: f64 = 1.0;
const PUSH_SHARE: f64 = 0.03;

/// A joint at a limit.
pub(super) struct AtLimit {
    pub joint: usize,
    upper: bool,
    rows: Vec<bool>,
    always: bool,
}

/// Joints that stand at a limit, in the rows of the motion.
pub(super) fn at_limits(robot: &Robot, motion: &Motion) -> Vec<AtLimit> {
    let nv = motion.nv;
    let n = motion.len();
    let mut found = vec![];
    for body in &robot.bodies[1..] {
        if !matches!(body.kind, JointKind::Revolute | JointKind::Prismatic) {
            continue;
        }
        let joint = body.idx_v;
        let [lower, upper] = body.position_limits;
        let near = NEAR.max(NEAR_SHARE * (upper - lower).min(10.0));
        let usual = (motion.v.iter().skip(joint).step_by(nv).map(|v| v * v).sum::<f64>() / n as f64).sqrt();
        let slow = STANDS.max(STANDS_SHARE * usual);
        for (is_upper, limit) in [(false, lower), (true, upper)] {
            if !limit.is_finite() {
                continue;
            }
            let mut rows: Vec<bool> = (0..n)
                .map(|row| {
                    let (q, v) = (motion.angle[row * nv + joint], motion.v[row * nv + joint]);
                    (q - limit).abs() < near && v.abs() < slow
                })
                .collect();
            if !stands_long(motion, &rows) {
                continue;
            }
            let always = rows.iter().filter(|row| **row).count() * 10 > n * 9;
            // The rows around are half of the stop.
            if !always && motion.consecutive {
                widen(motion, &mut rows);
            }
            found.push(AtLimit { joint, upper: is_upper, rows, always });
        }
    }
    found
}

/// Rows in which any joint stands at a limit, those left out where one always does.
pub(super) fn rows_at_limits(limits: &[AtLimit], count: usize) -> Vec<bool> {
    (0..count).map(|row| limits.iter().any(|limit| !limit.always && limit.rows[row])).collect()
}

fn stands_long(motion: &Motion, rows: &[bool]) -> bool {
    if !motion.consecutive {
        return rows.iter().filter(|row| **row).count() >= LEAST_ROWS;
    }
    let (mut since, mut longest) = (None, 0.0_f64);
    for (row, stands) in rows.iter().enumerate() {
        since = if *stands { since.or(Some(row)) } else { None };
        if let Some(first) = since {
            longest = longest.max(motion.time[row] - motion.time[first]);
        }
    }
    longest >= LEAST_TIME
}

/// Includes the rows just before and after: low-passed torques reach into them.
fn widen(motion: &Motion, rows: &mut [bool]) {
    /// (s)
    const BEFORE: f64 = 0.05;
    const AFTER: f64 = 0.4;
    let at: Vec<f64> =
        rows.iter().zip(&motion.time).filter(|(stands, _)| **stands).map(|(_, time)| *time).collect();
    for (row, stands) in rows.iter_mut().enumerate() {
        let time = motion.time[row];
        let first = at.partition_point(|other| *other < time - AFTER);
        *stands = at.get(first).is_some_and(|other| *other < time + BEFORE);
    }
}

/// What the stops bear: the torque that is unexplained at the limit more than elsewhere.
pub(super) fn findings(robot: &Robot, motion: &Motion, limits: &[AtLimit]) -> Vec<Finding> {
    if limits.is_empty() {
        return vec![];
    }
    let evidence = Evidence::new(robot, motion);
    let one = |limit: &AtLimit| {
        let name = &robot.joint_names()[joint_of(robot, limit.joint)];
        let left = evidence.unexplained(limit.joint);
        let mean = |at: bool| -> f64 {
            let rows: Vec<f64> = evidence
                .indices
                .iter()
                .zip(&left)
                .filter(|(row, _)| limit.rows[**row] == at)
                .map(|(_, torque)| *torque)
                .collect();
            if rows.is_empty() {
                0.0
            } else {
                rows.iter().sum::<f64>() / rows.len() as f64
            }
        };
        let push = mean(true) - if limit.always { 0.0 } else { mean(false) };
        let effort = robot.effort_limits()[limit.joint];
        let large = PUSH.min(if effort > 0.0 { PUSH_SHARE * effort } else { PUSH });
        let variance: f64 = left.iter().map(|torque| torque * torque).sum();
        let inside: f64 = evidence
            .indices
            .iter()
            .zip(&left)
            .filter(|(row, _)| limit.rows[**row])
            .map(|(_, torque)| torque * torque)
            .sum();
        let which = if limit.upper { "upper" } else { "lower" };
        let text = format!(
            "'{name}' stands at its {which} position limit, whose stop bears {push:+.2} Nm: such rows cannot show contacts of this joint"
        );
        // A joint parked at its limit all the time may as well rest there.
        Finding::new(FaultCode::Limit, text)
            .of_joint(name)
            .sized(push, "Nm")
            .explaining(if variance > 0.0 { inside / variance } else { 0.0 })
            .major_if(push.abs() > large || !limit.always)
    };
    limits.iter().map(one).collect()
}

fn joint_of(robot: &Robot, velocity: usize) -> usize {
    robot.bodies[1..].iter().position(|body| body.idx_v == velocity).unwrap_or(0)
}
