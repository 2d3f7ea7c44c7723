//! The time from one sample to the next.

use crate::error::{Error, Result};

/// Shortest and longest time step (s).
const TIME_STEPS: std::ops::RangeInclusive<f64> = 1e-9..=LONGEST_STEP;
pub(crate) const LONGEST_STEP: f64 = 1e9;

/// What lies between two samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Step {
    /// The time step that the object was made for.
    Nominal,
    /// Another time (s).
    Of(f64),
    /// A time (s) over which the mean torque is not known from the two samples at its ends: estimates are kept.
    Gap(f64),
}

impl Step {
    /// Its length (s).
    pub fn length(self, nominal: f64) -> f64 {
        match self {
            Step::Nominal => nominal,
            Step::Of(length) | Step::Gap(length) => length,
        }
    }

    pub fn is_gap(self) -> bool {
        matches!(self, Step::Gap(_))
    }
}

/// Refuses what cannot be a time step (s).
pub(crate) fn check_time_step(dt: f64) -> Result<()> {
    if TIME_STEPS.contains(&dt) {
        Ok(())
    } else {
        let (from, to) = (TIME_STEPS.start(), TIME_STEPS.end());
        Err(Error::input("dt", format!("must lie between {from:e} and {to:e} s, not {dt}")))
    }
}
