//! A joint that stands still has no noise of velocity: its encoder counts the same position again and again.

/// Observers have forgotten the noise of a motion that has ended after about so long (s).
const FORGOTTEN: f64 = 0.1;
/// Share of the variance that is left of a robot that stands still: encoders between two counts.
const SMALLEST: f64 = 0.04;

/// How much of the velocities' noise can be present: its mean square is no larger than that of the velocities.
#[derive(Debug, Clone)]
pub(crate) struct Standstill {
    /// Standard deviations of the velocities' noise in motion (rad/s; m/s).
    deviations: Vec<f64>,
    share: f64,
}

impl Standstill {
    /// For standard deviations of the velocities' noise `(nv,)`.
    pub fn new(deviations: &[f64]) -> Self {
        Standstill { deviations: deviations.to_vec(), share: SMALLEST }
    }

    /// A step of `dt` (s) to velocities `(nv,)`: the share of the variance of the velocities' noise. All joints count as the one that
    /// moves most, relative to its noise.
    #[inline]
    pub fn advance(&mut self, v: &[f64], dt: f64) -> f64 {
        let noisy = v.iter().zip(&self.deviations).filter(|(_, deviation)| **deviation > 0.0);
        let largest = noisy.map(|(v, deviation)| (v / deviation).abs()).fold(0.0, f64::max).min(1.0);
        let left = self.share * (1.0 - dt / FORGOTTEN).max(0.0);
        self.share = left.max(largest * largest).max(SMALLEST);
        self.share
    }

    /// As at the start.
    pub fn reset(&mut self) {
        self.share = SMALLEST;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::Stream;

    const DT: f64 = 1e-3;

    #[test]
    fn a_robot_that_stands_has_no_noise_of_velocity_and_one_that_starts_all_of_it() {
        let mut standstill = Standstill::new(&[5e-3, 0.0]);
        assert_eq!(standstill.advance(&[0.0, 3.0], 0.0), SMALLEST);
        assert_eq!(standstill.advance(&[0.01, 3.0], DT), 1.0);
        assert!(standstill.advance(&[1e-6, 3.0], 0.05) >= 0.5);
        let share = (0..1000).fold(1.0, |_, _| standstill.advance(&[1e-6, 3.0], DT));
        assert_eq!(share, SMALLEST);
        assert_eq!(standstill.advance(&[-0.1, 0.0], DT), 1.0);
    }

    #[test]
    fn noise_at_rest_stays_noise() {
        let noise = Stream::new(2);
        let mut standstill = Standstill::new(&[5e-3; 2]);
        standstill.advance(&[5e-3; 2], DT);
        let smallest = (0..10_000).map(|k| standstill.advance(&noise.normals(2 * k).map(|x| 5e-3 * x), DT));
        assert!(smallest.fold(1.0, f64::min) > 0.7);
    }
}
