//! Bounds of a reaction.

use crate::error::{Error, Result};
use crate::robot::Robot;

/// Where a description has no limit of the velocity, and for what reaches it (rad/s, m/s; s).
const VELOCITY: f64 = 1.0;
const SPEED_UP: f64 = 0.25;
/// What a retreat moves by default at most: of each joint (rad, m), and in time (s).
const DISTANCE: f64 = 0.1;
const DURATION: f64 = 1.0;

/// What a [`Reaction`](super::Reaction) never exceeds.
///
/// ```
/// use contactsense::reaction::ReactionLimits;
/// use contactsense::robot::Robot;
///
/// let limits = ReactionLimits::of(&Robot::example_arm());
/// assert_eq!(limits.velocity.len(), 7);
/// assert!(limits.distance > 0.0 && limits.duration > 0.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ReactionLimits {
    /// Of each velocity variable (rad/s, m/s).
    pub velocity: Vec<f64>,
    /// Of each velocity variable (rad/s^2, m/s^2).
    pub acceleration: Vec<f64>,
    /// Of each velocity variable (Nm, N).
    pub torque: Vec<f64>,
    /// Of each joint in a retreat, after it has stopped (rad, m).
    pub distance: f64,
    /// Of a retreat, after which the robot comes to rest (s).
    pub duration: f64,
}

impl ReactionLimits {
    /// Those of a robot's description: a quarter of its velocity limits, reached in 0.25 s, and its efforts.
    pub fn of(robot: &Robot) -> Self {
        let known = |limit: f64| limit.is_finite() && limit > 0.0;
        let velocity: Vec<f64> = robot.velocity_limits();
        let velocity: Vec<f64> =
            velocity.into_iter().map(|limit| if known(limit) { 0.25 * limit } else { VELOCITY }).collect();
        Self {
            acceleration: velocity.iter().map(|limit| limit / SPEED_UP).collect(),
            velocity,
            torque: robot.effort_limits().into_iter().map(|limit| limit.max(0.0)).collect(),
            distance: DISTANCE,
            duration: DURATION,
        }
    }

    pub(super) fn check(&self, nv: usize) -> Result<()> {
        for (name, values, least) in [
            ("velocity_limit", &self.velocity, f64::MIN_POSITIVE),
            ("acceleration_limit", &self.acceleration, f64::MIN_POSITIVE),
            ("torque_limit", &self.torque, 0.0),
        ] {
            if values.len() != nv {
                return Err(Error::input(name, format!("expected {nv} numbers, got {}", values.len())));
            }
            let finite = name == "torque_limit";
            if !values.iter().all(|value| *value >= least && (finite || value.is_finite())) {
                return Err(Error::input(name, "all entries must be positive"));
            }
        }
        for (name, value) in [("distance", self.distance), ("duration", self.duration)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::input(name, format!("must be positive, got {value}")));
            }
        }
        Ok(())
    }
}
