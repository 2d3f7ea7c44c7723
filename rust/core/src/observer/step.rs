//! The time from one sample to the next.

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
