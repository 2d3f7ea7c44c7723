//! The acceleration as force/torque sensors tell it, before the observer does.
//!
//! The observer's acceleration is late by its low-pass (Vorndamme 2017, eq. 10), and so would be every compensated
//! wrench: a fast contact behind a sensor would look like another one in front of it. What the sensors see now makes up
//! for the delay: `a = M^-1 (tau - C v - g + r + x(a) - lag(x(a)))`, with `x(a)` the torque of what they see, which the
//! acceleration compensates. A fixed number of rounds from the observer's acceleration; since `lag` takes in the tick's
//! own `x`, the loop through it stays stable for any gain: a disturbance goes on by a factor `2 c^(rounds + 1) - 1` a
//! tick, `c` between 1/2 and 1.

use crate::observer::MomentumObserver;
use crate::robot::Robot;
use crate::sensor::{LaggedTorques, LoadCompensator, SensorTree};

/// Each leaves the share of the error that the inertia behind the sensors has in the robot's. More follow faster contacts,
/// and carry more of the readings' noise into the acceleration of light wrists.
const ROUNDS: usize = 6;
/// What a joint moves that moves nothing but what is behind sensors is for the observer to say: of the sensors' word
/// only this share counts there, round by round, or all their noise would go into such a joint's acceleration.
const UNDETERMINED_SHARE: f64 = 0.75;

/// Workspace `(nv,)`.
#[derive(Debug, Clone)]
pub(super) struct PromptAcceleration {
    ahead: Vec<f64>,
    /// Velocity variables that move nothing but what is behind sensors.
    undetermined: Vec<bool>,
    acceleration: Vec<f64>,
}

impl PromptAcceleration {
    /// Space for a robot; `tree` holds all sensors.
    pub fn new(robot: &Robot, tree: &SensorTree) -> Self {
        let mut undetermined = vec![false; robot.nv()];
        for body in 1..robot.body_count() {
            undetermined[robot.velocity_range(body)].fill(tree.at_joint(robot, body).is_some());
        }
        Self { ahead: vec![0.0; robot.nv()], acceleration: vec![0.0; robot.nv()], undetermined }
    }

    /// Corrects the observer's acceleration of its last step, and leaves the compensator and `lag` with the external
    /// wrenches that go with it. `tree` is told which sensors gave a reading.
    pub fn correct(
        &mut self,
        observer: &mut MomentumObserver,
        compensator: &mut LoadCompensator,
        lag: &mut LaggedTorques,
        tree: &mut SensorTree,
        readings: &[[f64; 6]],
    ) {
        self.acceleration.copy_from_slice(observer.acceleration());
        for round in 0..=ROUNDS {
            compensator.compensate_at(observer.kinematics(), &self.acceleration, readings);
            tree.set_active(compensator.usable());
            lag.set(observer.robot(), observer.kinematics(), tree, compensator.external());
            if round == ROUNDS {
                break;
            }
            self.ahead.fill(0.0);
            for sensor in 0..tree.len() {
                // Those nearer to the base see what is behind the others, too.
                if tree.is_active(sensor) && tree.parent(sensor).is_none() {
                    lag.add_ahead(sensor, &mut self.ahead);
                }
            }
            self.ahead
                .iter_mut()
                .zip(&self.undetermined)
                .filter(|(_, open)| **open)
                .for_each(|(ahead, _)| *ahead *= UNDETERMINED_SHARE);
            observer.respond(&self.ahead, &mut self.acceleration);
        }
        observer.set_acceleration(&self.acceleration);
    }
}
