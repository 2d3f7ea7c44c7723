//! Rates of signals, low-passed.

/// Of the low-pass whose error is the rate of a signal (1/s): motion is slower, noise faster.
const GAIN: f64 = 20.0;
/// At rows further apart the low-pass is slower, so that it still follows: the largest step as a share of its time.
const LARGEST_STEP: f64 = 0.3;

/// The rates of signals, of which no noise is differentiated.
#[derive(Debug, Clone)]
pub(crate) struct Rate {
    low: Vec<f64>,
    started: bool,
}

impl Rate {
    /// Of `count` signals.
    pub fn new(count: usize) -> Self {
        Rate { low: vec![0.0; count], started: false }
    }

    /// Forgets the signals.
    pub fn reset(&mut self) {
        self.started = false;
    }

    /// Replaces each signal by its rate after a step of `dt` (s).
    #[inline]
    pub fn advance(&mut self, dt: f64, signals: &mut [f64]) {
        if !self.started {
            self.low.copy_from_slice(signals);
            self.started = true;
        }
        let gain = GAIN.min(LARGEST_STEP / dt.max(f64::MIN_POSITIVE));
        let decay = (-gain * dt).exp();
        for (low, signal) in self.low.iter_mut().zip(signals) {
            let error = *signal - *low;
            *low += (1.0 - decay) * error;
            *signal = gain * decay * error;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_follows_that_of_the_signal() {
        let mut rate = Rate::new(1);
        for k in 0..2000 {
            // The low-pass is late by its time constant.
            let time = f64::from(k) * 1e-3;
            let mut signal = [(2.0 * time).sin()];
            rate.advance(1e-3, &mut signal);
            if k > 500 {
                assert!((signal[0] - 2.0 * (2.0 * (time - 0.05)).cos()).abs() < 0.03, "{}", signal[0]);
            }
        }
    }
}
