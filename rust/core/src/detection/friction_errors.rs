//! Friction is known least while a joint starts, stops or turns round.

use crate::observer::Order;

/// Below this speed a joint's friction depends on more than its velocity (rad/s; m/s): on how it came to rest.
pub(crate) const SLOW: f64 = 0.02;
/// Below this speed it stands (rad/s; m/s): what friction then holds is constant, and learnt as a part of the bias.
const STANDING: f64 = 0.002;
/// An error of friction at a start or stop is forgotten in this time (s), and where the joint stands in this one, since the bias has
/// to follow it.
const FORGOTTEN: f64 = 0.25;
const LEARNT: f64 = 0.5;
/// Share of its variance that stays while the joint is slow, and while it stands.
const CREEPING: f64 = 0.25;
const AT_REST: f64 = 0.04;
/// How long the error lasts, which an observer smooths (s).
const DURATION: f64 = 0.05;

/// Which joints have just started or stopped.
#[derive(Debug, Clone)]
pub(crate) struct FrictionErrors {
    /// Share of the variance, by velocity variable.
    share: Vec<f64>,
    slow: Vec<bool>,
}

impl FrictionErrors {
    /// Of joints of which nothing is known yet.
    pub fn new(nv: usize) -> Self {
        FrictionErrors { share: vec![1.0; nv], slow: vec![true; nv] }
    }

    /// A step of `dt` (s) to velocities `(nv,)`; `known`: these are measured.
    #[inline]
    pub fn advance(&mut self, v: &[f64], known: bool, dt: f64) {
        let [decay, learnt] = [FORGOTTEN, LEARNT].map(|time| (1.0 - dt / time).max(0.0));
        for ((share, slow), v) in self.share.iter_mut().zip(&mut self.slow).zip(v) {
            let speed = v.abs();
            let is_slow = speed < SLOW;
            let least = match () {
                () if known && speed < STANDING => (share.min(CREEPING) * learnt).max(AT_REST),
                () if is_slow => CREEPING,
                () => 0.0,
            };
            *share = if is_slow == *slow { (*share * decay).max(least) } else { 1.0 };
            *slow = is_slow;
        }
    }

    /// Share of the variance of friction's errors, by velocity variable.
    pub fn shares(&self) -> &[f64] {
        &self.share
    }

    /// What an observer of a `gain` (1/s) makes of the variance.
    pub fn response(gain: f64, order: Order) -> f64 {
        order.step_response(gain, DURATION).powi(2)
    }

    /// Forgets all steps.
    pub fn reset(&mut self) {
        self.share.fill(1.0);
        self.slow.fill(true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_start_and_a_stop_make_friction_uncertain() {
        let mut errors = FrictionErrors::new(1);
        let mut after = |v: f64, ticks: usize| {
            (0..ticks).for_each(|_| errors.advance(&[v], true, 1e-3));
            errors.shares()[0]
        };
        assert_eq!(after(0.01, 3000), CREEPING);
        assert_eq!(after(0.0, 3000), AT_REST);
        assert_eq!(after(0.5, 1), 1.0);
        assert!(after(0.5, 1000) < 0.03);
        assert_eq!(after(0.0, 1), 1.0);
    }
}
