//! The time between two samples, of which some never come or are refused.

use crate::observer::Step;
use crate::sample::{check_time_step, LONGEST_STEP};

/// A step is bridged, torques and momentum taken as changing evenly over it, up to so many nominal steps, or
/// [`BRIDGE_TIME`] if that is longer.
const BRIDGED_STEPS: f64 = 5.0;
/// An arm in fast motion (2 rad/s, 1 Hz) is still known to a few tenths of a Nm over a step of this length (s).
const BRIDGE_TIME: f64 = 0.05;

/// Nominal steps that are counted at most, so that counting one more cannot overflow.
const MOST_MISSED: u64 = u64::MAX / 2;

/// Counts the time from one accepted sample to the next.
#[derive(Debug, Clone)]
pub(super) struct SampleClock {
    /// Nominal step (s).
    dt: f64,
    started: bool,
    /// Between the last accepted sample and the last refused one: a measured time (s), and nominal steps after it.
    measured_gap: f64,
    missed: u64,
    /// Nominal steps from the first accepted sample to the last.
    ticks: u64,
    /// Of the steps with a length of their own (s).
    measured: f64,
}

impl SampleClock {
    pub fn new(dt: f64) -> Self {
        Self { dt, started: false, measured_gap: 0.0, missed: 0, ticks: 0, measured: 0.0 }
    }

    /// The step that ends with the next sample; `dt` (s), where measured, is the time since the last accepted one.
    pub fn step(&self, dt: Option<f64>) -> Step {
        let length = match dt {
            Some(dt) => dt,
            None if self.missed == 0 && self.measured_gap == 0.0 => return Step::Nominal,
            None => (self.measured_gap + self.dt * (self.missed + 1) as f64).min(LONGEST_STEP),
        };
        if length <= BRIDGE_TIME.max(BRIDGED_STEPS * self.dt) {
            Step::Of(length)
        } else {
            Step::Gap(length)
        }
    }

    /// The sample was accepted, with the argument of [`SampleClock::step`].
    pub fn accept(&mut self, dt: Option<f64>) {
        if self.started {
            match dt {
                Some(dt) => self.measured += dt,
                None => {
                    self.ticks = self.ticks.saturating_add(self.missed + 1);
                    self.measured += self.measured_gap;
                }
            }
        }
        self.started = true;
        (self.missed, self.measured_gap) = (0, 0.0);
    }

    /// The sample was refused.
    pub fn miss(&mut self, dt: Option<f64>) {
        match dt.filter(|dt| check_time_step(*dt).is_ok()) {
            _ if !self.started => {}
            Some(dt) => (self.measured_gap, self.missed) = (dt, 0),
            None => self.missed = self.missed.saturating_add(1).min(MOST_MISSED),
        }
    }

    /// Whether a sample has been accepted.
    pub fn started(&self) -> bool {
        self.started
    }

    /// From the first accepted sample to the last (s).
    pub fn time(&self) -> f64 {
        self.ticks as f64 * self.dt + self.measured
    }

    /// Nominal step (s).
    pub fn dt(&self) -> f64 {
        self.dt
    }

    pub fn reset(&mut self) {
        *self = Self::new(self.dt);
    }
}

#[cfg(test)]
mod tests {
    use super::SampleClock;
    use crate::observer::Step;

    #[test]
    fn a_missed_sample_lengthens_the_next_step() {
        let mut clock = SampleClock::new(1e-3);
        clock.miss(None);
        assert_eq!(clock.step(None), Step::Nominal, "no time passes before the first sample");
        clock.accept(None);
        clock.miss(None);
        clock.miss(None);
        assert_eq!(clock.step(None), Step::Of(3e-3));
        assert_eq!(clock.step(Some(2e-3)), Step::Of(2e-3), "a measured step is as measured");
        clock.accept(None);
        assert_eq!(clock.step(None), Step::Nominal);
        assert!((clock.time() - 3e-3).abs() < 1e-15);
        clock.miss(None);
        clock.accept(Some(0.02));
        assert!((clock.time() - 23e-3).abs() < 1e-15);
        clock.miss(Some(0.01));
        clock.miss(Some(f64::NAN));
        assert!(matches!(clock.step(None), Step::Of(length) if (length - 0.012).abs() < 1e-15));
        clock.accept(None);
        assert!((clock.time() - 35e-3).abs() < 1e-15);
    }

    #[test]
    fn long_gaps_are_not_bridged() {
        let mut clock = SampleClock::new(1e-3);
        clock.accept(None);
        assert_eq!(clock.step(Some(0.05)), Step::Of(0.05));
        assert_eq!(clock.step(Some(0.06)), Step::Gap(0.06));
        for _ in 0..99 {
            clock.miss(None);
        }
        assert!(matches!(clock.step(None), Step::Gap(length) if (length - 0.1).abs() < 1e-12));
        assert_eq!(SampleClock::new(0.1).step(Some(0.3)), Step::Of(0.3), "a slow log is sampled so");
    }
}
