//! Goodness of fit: whether a single push at the estimated point explains the torques of the last updates.
//!
//! One update has too few redundant torques to tell a push from a moment, from two pushes or from a bias of the joints,
//! and its noise hides the difference. Noise averages out over updates, a wrong model does not: so the mean residual over
//! a window is tested, in a chi-square test.

use nalgebra::Vector3;

use super::frames::Frames;
use super::measurement::{across, Measurement};
use crate::math::chi_square::upper_limit;
use crate::robot::Robot;

/// Updates over which residuals are averaged: enough that noise of three times the stated size averages out to that size.
const WINDOW: f64 = 10.0;
/// Noise that is granted before updates have shown their own, in stated standard deviations, and for how many updates
/// that counts.
const GRANTED: f64 = 3.0;
const GRANTED_UPDATES: f64 = 1.0;
/// Parameters of a push: its force and two coordinates on the surface.
pub(super) const FITTED: usize = 3;

/// Residuals of the last updates.
#[derive(Debug, Clone)]
pub(super) struct Fit {
    torque_noise: Vec<f64>,
    relative_noise: f64,
    /// One a velocity variable [Nm].
    residual: Vec<f64>,
    mean: Vec<f64>,
    square: Vec<f64>,
    variance: Vec<f64>,
    updates: f64,
}

impl Fit {
    pub fn new(torque_noise: Vec<f64>, relative_noise: f64) -> Self {
        let empty = vec![0.0; torque_noise.len()];
        Fit {
            relative_noise,
            residual: empty.clone(),
            mean: empty.clone(),
            square: empty.clone(),
            variance: empty,
            torque_noise,
            updates: 0.0,
        }
    }

    /// Forgets all updates: another contact is looked at.
    pub fn restart(&mut self) {
        self.updates = 0.0;
    }

    /// Takes in the residual of a push, or of another one that fits better; returns its root mean square, in standard
    /// deviations of the stated noise.
    pub fn take_in(&mut self, push: &Push<'_>, other: Option<&Push<'_>>, torque: &[f64]) -> f64 {
        let mut squared = self.subtract(push, torque);
        if let Some(other) = other {
            let own = squared;
            squared = self.subtract(other, torque);
            if squared > own {
                squared = self.subtract(push, torque);
            }
        }
        self.updates += 1.0;
        let newest = (1.0 / self.updates).max(1.0 / WINDOW);
        for (k, &residual) in self.residual.iter().enumerate() {
            let variance = self.noise_variance(k, torque[k]);
            for (mean, value) in [
                (&mut self.mean[k], residual),
                (&mut self.square[k], residual * residual),
                (&mut self.variance[k], variance),
            ] {
                // The first one replaces what was there.
                *mean = if newest < 1.0 { *mean + newest * (value - *mean) } else { value };
            }
        }
        (squared / self.residual.len() as f64).sqrt()
    }

    /// Sets the residual of a push; returns its squared norm in units of the noise.
    fn subtract(&mut self, push: &Push<'_>, torque: &[f64]) -> f64 {
        self.residual.copy_from_slice(torque);
        push.subtract(&mut self.residual);
        (0..torque.len()).map(|k| self.residual[k].powi(2) / self.noise_variance(k, torque[k])).sum()
    }

    fn noise_variance(&self, k: usize, torque: f64) -> f64 {
        self.torque_noise[k].powi(2) + (self.relative_noise * torque).powi(2)
    }

    /// Squared norm of the mean residual, each joint over what noise makes of it: errors of the stated size may be slow,
    /// what scatters from update to update averages out.
    pub fn statistic(&self) -> f64 {
        let averaged = self.updates.min(2.0 * WINDOW - 1.0);
        let seen = self.updates - 1.0;
        (0..self.mean.len())
            .map(|k| {
                let squared = self.mean[k] * self.mean[k];
                let scatter = (self.square[k] - squared).max(0.0) * self.updates;
                let granted = GRANTED * GRANTED * self.variance[k] * GRANTED_UPDATES;
                let noise = (scatter + granted) / (seen + GRANTED_UPDATES);
                squared / (self.variance[k] + noise / averaged)
            })
            .sum()
    }

    /// Whether a single push explains the window.
    pub fn explained(&self) -> bool {
        self.statistic() <= upper_limit(self.mean.len().saturating_sub(FITTED))
    }
}

/// A push that is fitted to the torques: point and outward normal in the link's frame.
#[derive(Clone, Copy)]
pub(super) struct Push<'a> {
    pub robot: &'a Robot,
    pub frames: &'a Frames,
    pub measurement: Measurement,
    pub link: usize,
    pub point: Vector3<f64>,
    pub normal: Vector3<f64>,
}

impl Push<'_> {
    /// Squared norm of the torques of a unit force along the inward normal, and their product with those measured, each
    /// joint over its noise.
    pub fn response(&self) -> (f64, f64) {
        self.frames.links[self.link].response(&self.point, &self.normal)
    }

    /// Takes from the torques what the best force of this push does, which does not pull.
    fn subtract(&self, torque: &mut [f64]) {
        let (gain, product) = self.response();
        if !(gain > 0.0 && product > 0.0) {
            return;
        }
        let mut force = -self.normal * (product / gain);
        if let Measurement::FrictionCone(friction) = self.measurement {
            force = self.with_friction(force.norm(), friction).unwrap_or(force);
        }
        self.frames.subtract(self.robot, self.link, &self.point, &force, torque);
    }

    /// The best force where the part across the normal is Gaussian, as for the particles.
    fn with_friction(&self, normal_force: f64, friction: f64) -> Option<Vector3<f64>> {
        let first = across(&self.normal);
        let directions = [-self.normal, first, self.normal.cross(&first)];
        let (mut gram, products) = self.frames.links[self.link].responses(&self.point, &directions);
        let precision = (0.5 * friction * normal_force).powi(-2);
        gram[(1, 1)] += precision;
        gram[(2, 2)] += precision;
        let found = gram.cholesky()?.solve(&products);
        let usable = found[0] > 0.0 && found.iter().all(|x| x.is_finite());
        usable.then(|| directions[0] * found[0] + directions[1] * found[1] + directions[2] * found[2])
    }
}
