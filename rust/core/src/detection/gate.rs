//! What "in contact" means, in one place: thresholds, with hysteresis and a hold time (Vorndamme 2017, eq. 21).

use nalgebra::Vector6;

use crate::error::{Error, Result};
use crate::robot::Robot;
use crate::sensor::SensorTree;

/// No sensor resolves less (Nm, N), and squares of it are far from the smallest numbers.
const SMALLEST_THRESHOLD: f64 = 1e-12;

/// Whether a signal is over its threshold. One that is no number is not.
#[inline]
pub(crate) fn is_over(value: f64, threshold: f64) -> bool {
    value.abs() > threshold
}

/// Signals that are on while they are over their thresholds, and for a time after.
#[derive(Debug, Clone)]
pub(crate) struct Gate {
    threshold: Vec<f64>,
    /// What was on goes off below this share of its threshold.
    release: f64,
    hold_time: f64,
    /// Time left until a signal goes off; negative where it is off (s).
    remaining: Vec<f64>,
    on: bool,
}

impl Gate {
    /// Of checked thresholds; signals stay on for `hold_time` (s) after they were last over.
    pub fn new(threshold: Vec<f64>, hold_time: f64) -> Self {
        Gate { remaining: vec![-1.0; threshold.len()], threshold, release: 1.0, hold_time, on: false }
    }

    /// Without a hold time, but what is on goes off only below a share of the thresholds.
    pub fn with_hysteresis(threshold: Vec<f64>, release: f64) -> Self {
        Gate { release, ..Gate::new(threshold, 0.0) }
    }

    /// Takes in the signals of a step of `dt` (s); returns whether any is on.
    pub fn update(&mut self, signals: &[f64], dt: f64) -> bool {
        let share = if self.on { self.release } else { 1.0 };
        self.on = false;
        for ((remaining, threshold), signal) in self.remaining.iter_mut().zip(&self.threshold).zip(signals) {
            *remaining = if is_over(*signal, share * threshold) { self.hold_time } else { *remaining - dt };
            self.on |= *remaining >= 0.0;
        }
        self.on
    }

    /// Whether any signal is on.
    pub fn any_on(&self) -> bool {
        self.on
    }

    /// Whether a signal is on.
    pub fn is_on(&self, signal: usize) -> bool {
        self.remaining[signal] >= 0.0
    }

    /// Whether any of the signals is over its threshold, whatever was before.
    pub fn any_over(&self, signals: impl IntoIterator<Item = f64>) -> bool {
        signals.into_iter().zip(&self.threshold).any(|(signal, threshold)| is_over(signal, *threshold))
    }

    /// Other checked thresholds, as many; what is on stays on for its time.
    pub fn set_threshold(&mut self, threshold: Vec<f64>) {
        self.threshold = threshold;
    }

    /// Turns all signals off.
    pub fn reset(&mut self) {
        self.remaining.fill(-1.0);
        self.on = false;
    }
}

/// A hold time (s) that can be used.
pub(crate) fn check_hold_time(hold_time: f64) -> Result<()> {
    if hold_time.is_finite() && hold_time >= 0.0 {
        return Ok(());
    }
    Err(Error::input("hold_time", format!("must be finite and not negative [s], not {hold_time}")))
}

/// One threshold for all velocity variables, or one for each; positive and finite.
pub(crate) fn check_threshold(robot: &Robot, threshold: &[f64]) -> Result<Vec<f64>> {
    let threshold = robot.per_velocity("torque_threshold", threshold)?;
    if let Some(wrong) = threshold.iter().find(|x| **x < SMALLEST_THRESHOLD) {
        let text = format!("must be positive, at least {SMALLEST_THRESHOLD:e} [Nm], not {wrong:e}");
        return Err(Error::input("torque_threshold", text));
    }
    Ok(threshold)
}

/// One threshold for all components of all sensors, six for each sensor, or six times the number of sensors.
pub(crate) fn check_wrench_threshold(sensors: &SensorTree, threshold: &[f64]) -> Result<Vec<Vector6<f64>>> {
    if let Some(wrong) = threshold.iter().find(|x| !(x.is_finite() && **x >= SMALLEST_THRESHOLD)) {
        let text =
            format!("must be positive and finite, at least {SMALLEST_THRESHOLD:e} [N, Nm], not {wrong:e}");
        return Err(Error::input("wrench_threshold", text));
    }
    match threshold.len() {
        1 => Ok(vec![Vector6::repeat(threshold[0]); sensors.len()]),
        6 => Ok(vec![Vector6::from_column_slice(threshold); sensors.len()]),
        count if count == 6 * sensors.len() && count > 0 => {
            Ok(threshold.chunks_exact(6).map(Vector6::from_column_slice).collect())
        }
        count => Err(Error::input(
            "wrench_threshold",
            format!("expected one number, 6, or shape ({}, 6), got {count} numbers", sensors.len()),
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_signal_is_held_for_its_time() {
        let mut gate = Gate::new(vec![1.0, 1.0], 0.002);
        assert!(!gate.update(&[0.9, -1.0], 0.001));
        assert!(gate.update(&[0.0, -1.1], 0.001));
        assert!(gate.is_on(1) && !gate.is_on(0));
        assert!(gate.update(&[0.0, 0.0], 0.001) && gate.update(&[0.0, 0.0], 0.001));
        assert!(!gate.update(&[0.0, f64::NAN], 0.001));
    }

    #[test]
    fn what_is_on_goes_off_below_its_share() {
        let mut gate = Gate::with_hysteresis(vec![3.0], 1.0 / 3.0);
        let on: Vec<bool> = [2.0, 4.0, 1.5, 0.9, 2.0].iter().map(|x| gate.update(&[*x], 1.0)).collect();
        assert_eq!(on, [false, true, true, false, false]);
    }
}
