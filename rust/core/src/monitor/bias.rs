//! The external torque that a model's errors feign while nothing touches the robot.

use crate::error::{Error, Result};

/// Follows the external torque by a low-pass, except during contact.
#[derive(Debug, Clone)]
pub struct BiasTracker {
    time_constant: f64,
    bias: Vec<f64>,
    free_time: f64,
}

impl BiasTracker {
    /// A tracker for `nv` torques with a time constant [s].
    ///
    /// # Errors
    /// [`Error::Input`] where the time constant is not positive and finite.
    pub fn new(nv: usize, time_constant: f64) -> Result<Self> {
        if !(time_constant.is_finite() && time_constant > 0.0) {
            return Err(Error::Input(format!(
                "bias_time_constant: must be positive and finite [s], not {time_constant}"
            )));
        }
        Ok(Self { time_constant, bias: vec![0.0; nv], free_time: 0.0 })
    }

    /// Whether the first average is complete: one time constant, taken as free of contact.
    pub fn ready(&self) -> bool {
        self.free_time >= self.time_constant
    }

    /// Takes in a torque of a tick of `dt` without contact: a mean at first, then a low-pass.
    pub fn follow(&mut self, torque: &[f64], dt: f64) {
        self.free_time += dt;
        let share = dt / self.free_time.min(self.time_constant).max(dt);
        self.bias.iter_mut().zip(torque).for_each(|(bias, torque)| *bias += share * (torque - *bias));
    }

    /// Takes a torque for the bias at once.
    pub fn set(&mut self, bias: &[f64]) {
        self.bias.copy_from_slice(bias);
    }

    /// The bias `(nv,)`.
    pub fn bias(&self) -> &[f64] {
        &self.bias
    }

    /// Starts anew.
    pub fn reset(&mut self) {
        self.bias.fill(0.0);
        self.free_time = 0.0;
    }
}
