//! What motion is wanted.

use crate::error::{Error, Result};
use crate::particle::FilterOptions;
use crate::robot::{Robot, LARGEST};
use crate::torque::{NoiseModel, TorqueNoise};

/// Candidates at most: a plan then takes some seconds.
const MOST_CANDIDATES: usize = 10_000;
/// Rows of a motion at most.
const MOST_ROWS: f64 = 1e6;

/// Options of [`next_motion`](super::next_motion).
///
/// ```
/// use contactsense::next_motion::NextMotionOptions;
///
/// let options = NextMotionOptions { count: 100, ..NextMotionOptions::new(40.0, 0.03) };
/// assert_eq!((options.max_force, options.seed), (40.0, 0));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct NextMotionOptions {
    /// What the contact's normal force is not to exceed (N).
    pub max_force: f64,
    /// How far each joint moves at most, one number for all or one a velocity variable (rad; m for sliding joints).
    pub max_step: Vec<f64>,
    /// How many motions are drawn.
    pub count: usize,
    /// Of the random numbers: same seed, same motion.
    pub seed: u64,
    /// Errors of the torques; the particle filter's default where there is none.
    pub noise: Option<NoiseModel>,
    /// Length of the motion (s).
    pub duration: f64,
    /// Time between its rows (s).
    pub dt: f64,
}

impl NextMotionOptions {
    /// With a bound of the force (N) and of the motion of each joint (rad; m for sliding joints).
    pub fn new(max_force: f64, max_step: f64) -> Self {
        let max_step = vec![max_step];
        NextMotionOptions { max_force, max_step, count: 64, seed: 0, noise: None, duration: 0.5, dt: 1e-3 }
    }

    /// How far each joint moves at most, and the errors of the torques.
    pub(super) fn check(&self, robot: &Robot) -> Result<(Vec<f64>, TorqueNoise)> {
        positive("max_force", self.max_force, "[N]")?;
        let steps = robot.per_velocity("max_step", &self.max_step)?;
        for step in &steps {
            positive("max_step", *step, "[rad, m]")?;
        }
        if !(1..=MOST_CANDIDATES).contains(&self.count) {
            let text = format!("must be a whole number from 1 to {MOST_CANDIDATES}, got {}", self.count);
            return Err(Error::input("count", text));
        }
        positive("duration", self.duration, "[s]")?;
        positive("dt", self.dt, "[s]")?;
        if self.duration < self.dt {
            let text = format!("must be at least dt, which is {} s, not {}", self.dt, self.duration);
            return Err(Error::input("duration", text));
        }
        if self.duration / self.dt > MOST_ROWS {
            return Err(Error::input("dt", format!("gives more than {MOST_ROWS:e} rows, got {}", self.dt)));
        }
        let filter = FilterOptions { noise: self.noise.clone(), ..FilterOptions::default() };
        Ok((steps, filter.torque_noise(robot)?))
    }
}

fn positive(name: &'static str, value: f64, unit: &str) -> Result<()> {
    if value > 0.0 && value < LARGEST {
        return Ok(());
    }
    Err(Error::input(name, format!("must be positive and finite {unit}, not {value}")))
}
