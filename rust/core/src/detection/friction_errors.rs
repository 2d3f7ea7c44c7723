//! Friction is known least while a joint starts, stops or turns round.

use crate::observer::Order;

/// Below this speed a joint's friction depends on more than its velocity (rad/s; m/s): on how it came to rest.
pub(crate) const SLOW: f64 = 0.02;
/// An error of friction at a start or stop is forgotten in this time (s).
const FORGOTTEN: f64 = 0.25;
/// Share of its variance that stays while the joint is at rest, and while it moves so slowly (rad/s; m/s) that friction is another
/// than in fast motion (Stribeck).
const AT_REST: f64 = 0.25;
const STRIBECK: f64 = 0.15;
/// How long the error lasts, which an observer smooths (s): motor currents of a real arm (UR10) show it for about so long.
const DURATION: f64 = 0.1;

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

    /// A step of `dt` (s) to a velocity `(nv,)`.
    #[inline]
    pub fn advance(&mut self, v: &[f64], dt: f64) {
        let decay = (1.0 - dt / FORGOTTEN).max(0.0);
        for ((share, slow), v) in self.share.iter_mut().zip(&mut self.slow).zip(v) {
            let is_slow = v.abs() < SLOW;
            let left = (*share * decay).max(if v.abs() < STRIBECK { AT_REST } else { 0.0 });
            *share = if is_slow == *slow { left } else { 1.0 };
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
            (0..ticks).for_each(|_| errors.advance(&[v], 1e-3));
            errors.shares()[0]
        };
        assert_eq!(after(0.0, 3000), AT_REST);
        assert_eq!(after(0.5, 1), 1.0);
        assert!(after(0.5, 1000) < 0.03);
        assert_eq!(after(0.0, 1), 1.0);
    }
}
