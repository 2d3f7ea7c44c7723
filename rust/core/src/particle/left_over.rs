//! The torque that the best particle leaves over.

use super::cloud::Cloud;
use super::instant::Instant;
use super::likelihood::{misfit, Belief};

/// Torque that is left over.
pub(super) struct LeftOver {
    /// The best particle.
    pub best: usize,
    /// Its squared norm in units of the noise.
    pub misfit: f64,
    /// Its part of what was measured.
    pub share: f64,
    joints: usize,
}

impl LeftOver {
    /// What the best particle leaves over of the torques of an instant.
    pub fn of(cloud: &Cloud, instant: &Instant) -> Self {
        let Cloud { particles, weights, .. } = cloud;
        let (measured, joints) = (instant.squared, instant.torque.len());
        let (mut best, mut greatest) = (0, -1.0);
        for (k, &weight) in weights.iter().enumerate() {
            if weight > greatest {
                (best, greatest) = (k, weight);
            }
        }
        let misfit = misfit(&Belief::of(particles, best));
        let share = if measured > 0.0 { (misfit / measured).sqrt() } else { 0.0 };
        LeftOver { best, misfit, share, joints }
    }

    /// Whether it is more than a share of the torque, and more than noise.
    pub fn is_much(&self, share: f64) -> bool {
        self.share > share && self.misfit > 9.0 * self.joints as f64
    }

    /// About as much moment at the joints that turn [Nm].
    pub fn moment(&self, instant: &Instant) -> f64 {
        let Instant { torque, deviation: noise, is_force, .. } = instant;
        let (mut moment, mut deviations) = (0.0, 0.0);
        for ((torque, noise), _) in torque.iter().zip(noise).zip(is_force).filter(|(_, is_force)| !**is_force)
        {
            moment += torque * torque;
            deviations += (torque / noise).powi(2);
        }
        // Moment per standard deviation of its noise, where the torque is.
        let unit = if deviations > 0.0 { (moment / deviations).sqrt() } else { 0.0 };
        self.misfit.sqrt() * unit
    }
}
