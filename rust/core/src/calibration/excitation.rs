//! Contact-free motion from which calibration learns most (algorithm D2 needs it): rest to rest, within limits, clear of
//! itself.
//!
//! A motion is a chain of moves between poses at rest. For each move, several random ones are drawn, and the one with the
//! most information per second about bias, friction, rotor inertia and inertial parameters is improved joint by joint;
//! the best one that is clear of collisions is taken (greedy D-optimal design). Each joint moves fast, slowly or with sines
//! by itself, so that friction near standstill is seen as well.

mod clearance;
mod cover;
mod draw;
mod gap;
mod information;
mod limits;
mod motion;
mod planner;

pub use motion::Motion;
pub use planner::ExcitationPlanner;

use crate::error::Result;
use crate::robot::Robot;

/// What motion is wanted.
///
/// ```
/// use contactsense::calibration::{exciting_motion, Excitation};
///
/// let robot = contactsense::robot::Robot::example_arm();
/// let wanted = Excitation { max_velocity: vec![0.8], seed: 3, ..Excitation::new(10.0) };
/// let motion = exciting_motion(&robot, &wanted)?;
/// assert_eq!(motion.len(), 10_001);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Excitation {
    /// Length (s).
    pub seconds: f64,
    /// Largest speed of each joint, or one for all (rad/s; m/s for sliding joints), where the description does not
    /// allow less; empty: half of what it allows, 1 rad/s and 0.25 m/s where it says nothing.
    pub max_velocity: Vec<f64>,
    /// Time between rows (s).
    pub dt: f64,
    /// The joints that move, by their velocity variables; empty: all. The others stay where they load these most.
    pub joints: Vec<usize>,
    /// Of the random numbers.
    pub seed: u64,
}

impl Excitation {
    /// A motion of all joints, at 1 kHz, with the velocity limits of the description.
    pub fn new(seconds: f64) -> Self {
        Excitation { seconds, max_velocity: vec![], dt: 1e-3, joints: vec![], seed: 0 }
    }
}

/// Plans a motion in one go; [`ExcitationPlanner`] plans it move by move.
///
/// # Errors
/// As of [`ExcitationPlanner::new`].
pub fn exciting_motion(robot: &Robot, wanted: &Excitation) -> Result<Motion> {
    let mut planner = ExcitationPlanner::new(robot, wanted)?;
    while planner.advance() {}
    Ok(planner.finish())
}
