//! Weighted sums over samples of a posterior.

use nalgebra::{Matrix3, Vector3};

use super::contact_sample::ContactSample;

/// Weighted sums over samples on one link, in its frame.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Moments {
    pub weight: f64,
    pub point: Vector3<f64>,
    square: Matrix3<f64>,
    pub normal: Vector3<f64>,
    pub force: Vector3<f64>,
    pub stiffness: f64,
}

impl Moments {
    #[inline]
    pub fn add(&mut self, sample: &ContactSample, weight: f64) {
        let weighted = sample.point * weight;
        self.weight += weight;
        self.point += weighted;
        self.square += weighted * sample.point.transpose();
        self.normal += sample.normal * weight;
        self.force += sample.force * weight;
        self.stiffness += weight * sample.stiffness;
    }

    pub fn join(&mut self, other: &Moments) {
        self.weight += other.weight;
        self.point += other.point;
        self.square += other.square;
        self.normal += other.normal;
        self.force += other.force;
        self.stiffness += other.stiffness;
    }

    /// Root of the mean squared distance from the mean [m].
    pub fn spread(&self) -> f64 {
        let mean = self.point / self.weight;
        (self.square.trace() / self.weight - mean.norm_squared()).max(0.0).sqrt()
    }

    /// Weighted second moment about `centre` (link frame), not divided by the weight.
    pub fn about(&self, centre: &Vector3<f64>) -> Matrix3<f64> {
        self.square - self.point * centre.transpose() - centre * self.point.transpose()
            + centre * centre.transpose() * self.weight
    }
}
