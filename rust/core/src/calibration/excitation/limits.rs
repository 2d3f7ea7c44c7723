//! What each joint may do.

use super::Excitation;
use crate::error::{Error, Result};
use crate::math::random::Stream;
use crate::robot::integrate::working_range;
use crate::robot::{JointKind, Robot};

/// Share of the velocity limits of a description that motion without a wish for a velocity uses.
const VELOCITY_SHARE: f64 = 0.5;
/// Largest speeds where a description says nothing: turning (rad/s), sliding (m/s).
const USUAL_VELOCITY: [f64; 2] = [1.0, 0.25];
/// From rest to the largest speed at the largest acceleration (s): gentle for the drives of arms.
const RAMP: f64 = 0.25;
/// Share of a joint's range that stays free at either end, and at most so much (rad or m).
const MARGIN: f64 = 0.05;
const LARGEST_MARGIN: f64 = 0.1;
/// Joints go no further than this from zero (rad or m), where their limits allow it: nothing new is to be learnt beyond.
const FURTHEST: f64 = std::f64::consts::TAU;
/// Share of the effort limits that motion uses.
const EFFORT_SHARE: f64 = 0.9;

/// Limits of all joints, one number a velocity variable.
#[derive(Debug, Clone)]
pub(super) struct Limits {
    /// Positions (rad or m).
    pub range: Vec<[f64; 2]>,
    /// rad/s or m/s.
    pub velocity: Vec<f64>,
    /// rad/s^2 or m/s^2.
    pub acceleration: Vec<f64>,
    /// Nm or N; infinite where there is none.
    pub effort: Vec<f64>,
    /// Whether it may move.
    pub moves: Vec<bool>,
}

impl Limits {
    /// Of a robot with a fixed base.
    pub fn new(robot: &Robot, wanted: &Excitation) -> Result<Self> {
        let velocity = velocity(robot, &wanted.max_velocity)?;
        let mut moves = vec![wanted.joints.is_empty(); robot.nv()];
        for &joint in &wanted.joints {
            let wrong =
                || Error::input("joints", format!("there is no joint {joint}; there are {}", robot.nv()));
            *moves.get_mut(joint).ok_or_else(wrong)? = true;
        }
        let range = robot.bodies[1..].iter().map(|body| {
            let [lower, upper] = working_range(body);
            let near = [lower.max(-FURTHEST), upper.min(FURTHEST)];
            let [lower, upper] = if near[0] < near[1] { near } else { [lower, upper] };
            let margin = (MARGIN * (upper - lower)).min(LARGEST_MARGIN);
            [lower + margin, upper - margin]
        });
        let effort = robot.effort_limits().into_iter().map(|effort| match effort {
            0.0 => f64::INFINITY, // written where nobody knew it
            effort => EFFORT_SHARE * effort,
        });
        Ok(Limits {
            range: range.collect(),
            acceleration: velocity.iter().map(|velocity| velocity / RAMP).collect(),
            velocity,
            effort: effort.collect(),
            moves,
        })
    }

    /// Positions in the middle of the ranges.
    pub fn middle(&self) -> Vec<f64> {
        self.range.iter().map(|[lower, upper]| 0.5 * (lower + upper)).collect()
    }

    /// Random positions within the ranges.
    pub fn random(&self, stream: &Stream) -> Vec<f64> {
        let ranges = self.range.iter().enumerate();
        ranges.map(|(joint, [lower, upper])| lower + (upper - lower) * stream.uniform(joint as u64)).collect()
    }

    /// Whether all positions are within the ranges.
    pub fn hold(&self, positions: &[f64]) -> bool {
        positions
            .iter()
            .zip(&self.range)
            .all(|(position, [lower, upper])| (lower..=upper).contains(&position))
    }
}

fn velocity(robot: &Robot, wanted: &[f64]) -> Result<Vec<f64>> {
    let limits = robot.velocity_limits().into_iter();
    if wanted.is_empty() {
        let one = |(limit, kind): (f64, JointKind)| {
            let usual = USUAL_VELOCITY[usize::from(kind == JointKind::Prismatic)];
            known(limit).map_or(usual, |limit| VELOCITY_SHARE * limit)
        };
        return Ok(limits.zip(robot.joint_kinds()).map(one).collect());
    }
    let velocity = robot.per_velocity("max_velocity", wanted)?;
    if let Some(wrong) = velocity.iter().find(|velocity| **velocity <= 0.0) {
        return Err(Error::input("max_velocity", format!("must be positive [rad/s, m/s], not {wrong}")));
    }
    // What a wish says is no reason to leave what the joint can do.
    let smaller = |(wanted, limit): (f64, f64)| known(limit).map_or(wanted, |limit| wanted.min(limit));
    Ok(velocity.into_iter().zip(limits).map(smaller).collect())
}

/// A velocity limit (rad/s or m/s), where the description has one: zero is written where nobody knew it.
fn known(limit: f64) -> Option<f64> {
    (limit.is_finite() && limit > 0.0).then_some(limit)
}
