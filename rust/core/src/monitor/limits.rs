//! Joints at limits of their positions: a stop's torque is no contact.

use crate::robot::{JointKind, Robot, WORLD};

/// Nearer than this a joint is at its limit: stops yield, and limits are rounded (rad; m for sliding joints),
const NEAR: f64 = 0.005;
const NEAR_SLIDING: f64 = 0.001;
/// or nearer than this share of its range, if that is less.
const NEAR_SHARE: f64 = 0.002;

/// The limits of one joint.
#[derive(Debug, Clone, Copy)]
struct Limits {
    /// Among all joints.
    joint: usize,
    q: usize,
    v: usize,
    /// From here on upwards and downwards it is at a limit.
    upper: f64,
    lower: f64,
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
                upper: upper - near,
                lower: lower + near,
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
            let position = q[limits.q];
            self.inward[limits.v] = if position >= limits.upper {
                -1.0
            } else if position <= limits.lower {
                1.0
            } else {
                0.0
            };
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
