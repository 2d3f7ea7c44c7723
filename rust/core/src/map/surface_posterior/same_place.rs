//! Whether the newest measurement of a contact is of the same place on its link as the older ones, by the evidence of the samples.

use super::super::measurements::Logs;
use crate::torque::LANES;

/// Terms of a sum whose logarithm is so much less than the greatest one's do not matter.
const NO_SHARE: f64 = -40.0;

/// The logarithm of a sum, of logarithms of its terms.
#[derive(Debug, Clone, Copy)]
struct LogSum {
    greatest: f64,
    sum: f64,
}

impl LogSum {
    const NONE: LogSum = LogSum { greatest: f64::NEG_INFINITY, sum: 0.0 };

    #[inline]
    fn add(&mut self, log: f64, factor: f64) {
        if log > self.greatest {
            self.sum = self.sum * (self.greatest - log).exp() + factor;
            self.greatest = log;
        } else if log - self.greatest > NO_SHARE {
            self.sum += factor * (log - self.greatest).exp();
        }
    }

    fn log(&self) -> f64 {
        self.greatest + self.sum.ln()
    }
}

/// Evidence of the newest measurement, of the older ones, which together count as one, and of both at one place.
#[derive(Debug, Clone)]
pub(super) struct SamePlace {
    newest: LogSum,
    older: LogSum,
    together: LogSum,
}

impl SamePlace {
    pub fn new() -> Self {
        SamePlace { newest: LogSum::NONE, older: LogSum::NONE, together: LogSum::NONE }
    }

    /// Takes in a block of samples with their prior probabilities: what the newest measurement says of them, and the older ones.
    pub fn add(&mut self, newest: &Logs, older: &Logs, priors: &[f64]) {
        for (newest, older) in newest.iter().zip(older) {
            for ((newest, older), &prior) in newest.iter().zip(older).zip(&priors[..priors.len().min(LANES)])
            {
                self.newest.add(*newest, prior);
                self.older.add(*older, prior);
                self.together.add(newest + older, prior);
            }
        }
    }

    /// Whether one place is at least as likely as two; beforehand they are. A second place is anywhere on the surface.
    pub fn is_likely(&self) -> bool {
        self.together.log() >= self.newest.log() + self.older.log()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COUNT: usize = 100;

    /// Samples in a row a centimetre apart, each with a square centimetre; both say a place with 2 cm as standard deviation.
    fn told(newest: f64, older: f64) -> bool {
        let mut same = SamePlace::new();
        let logs = |start: usize, place: f64| -> Logs {
            let log = |k: usize| -0.5 * (((start + k) as f64 - place) / 2.0).powi(2);
            [std::array::from_fn(log), [-100.0; LANES]]
        };
        for start in (0..COUNT).step_by(LANES) {
            same.add(&logs(start, newest), &logs(start, older), &vec![1.0 / COUNT as f64; COUNT - start]);
        }
        same.is_likely()
    }

    #[test]
    fn places_that_are_apart_by_more_than_their_errors_are_two() {
        assert!(told(50.0, 50.0) && told(50.0, 53.0));
        assert!(!told(50.0, 60.0) && !told(20.0, 80.0));
        // The ratio of two normal distributions' overlap to that of anywhere: the root of 2 ln(100 / (4 sqrt(pi))) times the
        // deviation of the difference, 2 cm times the root of 2.
        let border = 2.0 * (4.0 * (100.0 / (4.0 * std::f64::consts::PI.sqrt())).ln()).sqrt();
        assert!(told(50.0, 50.0 + border - 0.1) && !told(50.0, 50.0 + border + 0.1));
    }
}
