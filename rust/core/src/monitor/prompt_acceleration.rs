//! The acceleration as force/torque sensors tell it, before the observer does.
//!
//! The observer's acceleration is late by its low-pass (Vorndamme 2017, eq. 10), and so would be every compensated
//! wrench: a fast contact behind a sensor would look like another one in front of it. What the sensors see now makes up
//! for the delay: `a = M^-1 (tau - C v - g + r + x(a) - lag(x(a)))`, with `x(a)` the torque of what they see, which the
//! acceleration compensates. A fixed number of rounds from the observer's acceleration; since `lag` takes in the tick's
//! own `x`, the loop through it stays stable for any gain: a disturbance goes on by a factor `2 c^(rounds + 1) - 1` a
//! tick, `c` between 1/2 and 1.

use crate::observer::MomentumObserver;
use crate::sensor::{LaggedTorques, LoadCompensator, SensorTree};

/// Each leaves the share of the error that the inertia behind the sensors has in the robot's.
const ROUNDS: usize = 6;

/// Workspace `(nv,)`.
#[derive(Debug, Clone)]
pub(super) struct PromptAcceleration {
    ahead: Vec<f64>,
    acceleration: Vec<f64>,
}

impl PromptAcceleration {
    /// Space for `nv` velocity variables.
    pub fn new(nv: usize) -> Self {
        Self { ahead: vec![0.0; nv], acceleration: vec![0.0; nv] }
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
            observer.respond(&self.ahead, &mut self.acceleration);
        }
        observer.set_acceleration(&self.acceleration);
    }
}
