//! Low-passes of an external torque: of first order as a momentum observer is one, or of second order.

use crate::torque::NoiseModel;

/// How many low-passes are in series. Two of twice the gain delay as much as one, and leave far less of the white noise of the momentum,
/// which one passes at each sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Order {
    First,
    Second,
}

impl Order {
    /// The gain of each low-pass (1/s), for a gain that is the reciprocal of the delay.
    pub fn pole(self, gain: f64) -> f64 {
        match self {
            Order::First => gain,
            Order::Second => 2.0 * gain,
        }
    }

    /// What is left of the variance of errors that change over `time` (s).
    pub fn slow_share(self, gain: f64, time: f64) -> f64 {
        let once = NoiseModel::model_share(self.pole(gain), time);
        match self {
            Order::First => once,
            Order::Second => 0.5 * once * (1.0 + once),
        }
    }

    /// What a torque that has lasted for `time` (s) has become, as a share of it.
    pub fn step_response(self, gain: f64, time: f64) -> f64 {
        let phase = self.pole(gain) * time;
        match self {
            Order::First => 1.0 - (-phase).exp(),
            Order::Second => 1.0 - (-phase).exp() * (1.0 + phase),
        }
    }
}
