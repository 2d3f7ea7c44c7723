//! Signals that are late, brought forward to the time of the positions.

/// Of the low-pass whose error is the rate of a signal (1/s): motion is slower, noise faster.
const GAIN: f64 = 20.0;
/// At rows further apart the low-pass is slower, so that it still follows: the largest step as a share of its time.
const LARGEST_STEP: f64 = 0.3;

/// Adds `delay` times the rate of a signal that it sees low-passed: no noise is differentiated, and nothing waits.
#[derive(Debug, Clone)]
pub(crate) struct Lead {
    delay: f64,
    low: Vec<f64>,
    started: bool,
}

impl Lead {
    /// For `count` signals that are late by `delay` (s).
    pub fn new(delay: f64, count: usize) -> Self {
        Lead { delay, low: vec![0.0; count], started: false }
    }

    /// Forgets the signals.
    pub fn reset(&mut self) {
        self.started = false;
    }

    /// Brings the signals forward in place after a step of `dt` (s).
    #[inline]
    pub fn advance(&mut self, dt: f64, signals: &mut [f64]) {
        if self.delay == 0.0 {
            return;
        }
        let delay = self.delay;
        self.rates(dt, signals, |signal, rate| *signal += delay * rate);
    }

    /// The rates of the signals after a step of `dt` (s), low-passed.
    #[inline]
    pub fn rates(&mut self, dt: f64, signals: &mut [f64], mut each: impl FnMut(&mut f64, f64)) {
        if !self.started {
            self.low.copy_from_slice(signals);
            self.started = true;
        }
        let gain = GAIN.min(LARGEST_STEP / dt.max(f64::MIN_POSITIVE));
        let decay = (-gain * dt).exp();
        for (low, signal) in self.low.iter_mut().zip(signals) {
            let error = *signal - *low;
            *low += (1.0 - decay) * error;
            each(signal, gain * decay * error);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_late_signal_comes_on_time() {
        let (delay, dt) = (0.005, 1e-3);
        let mut lead = Lead::new(delay, 1);
        for k in 0..2000 {
            let time = f64::from(k) * dt;
            let mut late = [(6.0 * (time - delay)).sin()];
            lead.advance(dt, &mut late);
            if k > 500 {
                assert!((late[0] - (6.0 * time).sin()).abs() < 0.01, "{}", late[0]);
            }
        }
    }
}
