//! Joints at limits of their positions: a stop's torque is no contact.

use crate::robot::{JointKind, Robot, WORLD};

/// Nearer than this a joint is at its limit: limits are rounded (rad; m for sliding joints), or nearer than a share of its
/// range, if that is less.
const NEAR: f64 = 0.005;
const NEAR_SLIDING: f64 = 0.001;
const NEAR_SHARE: f64 = 0.002;
/// A stop yields by so many times that. A joint farther beyond its limit has another one than the description says.
const YIELD: f64 = 10.0;

/// The limits of one joint.
#[derive(Debug, Clone, Copy)]
struct Limits {
    /// Among all joints.
    joint: usize,
    q: usize,
    v: usize,
    lower: f64,
    upper: f64,
    /// Before and beyond a limit, the joint is at it.
    near: f64,
    beyond: f64,
}

impl Limits {
    /// The sign of a stop's torque at a position, zero where the joint is at no limit.
    #[inline]
    fn inward(&self, position: f64) -> f64 {
        let is_at = |past: f64| past >= -self.near && past <= self.beyond;
        if is_at(position - self.upper) {
            -1.0
        } else if is_at(self.lower - position) {
            1.0
        } else {
            0.0
        }
    }
}

/// Which joints are at a limit.
#[derive(Debug, Clone)]
pub(super) struct JointLimits {
    limits: Vec<Limits>,
    /// By velocity variable: the sign of a stop's torque, zero for a joint that is not at a limit.
    inward: Vec<f64>,
}

impl JointLimits {
    pub fn new(robot: &Robot) -> Self {
        let of_body = |index: usize| {
            let body = &robot.bodies[index];
            let near = match body.kind {
                JointKind::Revolute => NEAR,
                JointKind::Prismatic => NEAR_SLIDING,
                JointKind::Continuous | JointKind::FreeFlyer => return None,
            };
            let [lower, upper] = body.position_limits;
            let near = near.min(NEAR_SHARE * (upper - lower));
            // A joint that cannot move, or whose limits are the wrong way round, is always at one.
            (near > 0.0).then_some(Limits {
                joint: index - 1,
                q: body.idx_q,
                v: body.idx_v,
                lower,
                upper,
                near,
                beyond: YIELD * near,
            })
        };
        JointLimits {
            limits: (WORLD + 1..robot.body_count()).filter_map(of_body).collect(),
            inward: vec![0.0; robot.nv()],
        }
    }

    /// Takes in a configuration.
    #[inline]
    pub fn set_configuration(&mut self, q: &[f64]) {
        for limits in &self.limits {
            self.inward[limits.v] = limits.inward(q[limits.q]);
        }
    }

    /// By velocity variable `(nv,)`: the sign of the torque of a stop that pushes the joint away from the limit it is at,
    /// zero where it is at none.
    pub fn inward(&self) -> &[f64] {
        &self.inward
    }

    /// The joints, counted without the world, that a stop pushes inward by more than a threshold `(nv,)`.
    pub fn pushed<'a>(&'a self, torque: &'a [f64], threshold: &'a [f64]) -> impl Iterator<Item = usize> + 'a {
        let is_pushed = |limits: &&Limits| self.inward[limits.v] * torque[limits.v] > threshold[limits.v];
        self.limits.iter().filter(is_pushed).map(|limits| limits.joint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_far_beyond_a_limit_is_at_none() {
        let limits = Limits { joint: 0, q: 0, v: 0, lower: -1.0, upper: 2.0, near: 0.005, beyond: 0.05 };
        for (past, sign) in [(-0.006, 0.0), (-0.004, -1.0), (0.0, -1.0), (0.04, -1.0), (0.06, 0.0)] {
            assert_eq!(limits.inward(limits.upper + past), sign, "{past}");
            assert_eq!(limits.inward(limits.lower - past), -sign, "{past}");
        }
    }
}
