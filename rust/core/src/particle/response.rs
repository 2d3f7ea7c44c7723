//! What a particle's force does to the joints, beside what they measured.

use super::columns::Slice;
use super::instant::Instant;
use crate::torque::{directions, ForceModel, NormalFit};

/// What computing a response needs to know.
#[derive(Debug, Clone, Copy)]
pub(super) struct ResponseModel {
    pub force_model: ForceModel,
    /// Variance of the torques' error, in units of their noise.
    pub variance: f64,
}

impl ResponseModel {
    /// Sets what particle k's force does to the joints at the present pose.
    #[inline]
    pub fn apply(&self, instant: &Instant, particles: &mut Slice<'_>, k: usize) -> NormalFit {
        let link = particles.link[k] as usize;
        let (point, normal) = (&particles.point[k], &particles.normal[k]);
        let (equations, squared) = (&instant.equations[link], instant.squared);
        let fit = match self.force_model.deviation_across(particles.force[k]) {
            Some(deviation) => {
                let (gram, products) = equations.responses(point, &directions(normal));
                NormalFit::without_friction(&gram, &products, squared, deviation.powi(2) / self.variance)
            }
            None => {
                let (gain, product) = equations.response(point, normal);
                NormalFit { gain, product, target: squared, penalty: 0.0 }
            }
        };
        particles.gain[k] = fit.gain;
        particles.product[k] = fit.product;
        particles.measured[k] = fit.target;
        particles.penalty[k] = fit.penalty;
        fit
    }
}
