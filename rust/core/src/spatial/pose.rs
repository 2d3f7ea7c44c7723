//! Rigid transforms.

use nalgebra::{Matrix3, Vector3};

/// A rigid transform: `world = rotation * local + translation`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Rotation from the local to the outer frame.
    pub rotation: Matrix3<f64>,
    /// The local origin in the outer frame [m].
    pub translation: Vector3<f64>,
}

impl Pose {
    /// The identity.
    pub fn identity() -> Self {
        Self { rotation: Matrix3::identity(), translation: Vector3::zeros() }
    }

    /// `self` after `inner`: takes a point of `inner`'s local frame to `self`'s outer frame.
    #[inline]
    pub fn compose(&self, inner: &Pose) -> Pose {
        Pose {
            rotation: self.rotation * inner.rotation,
            translation: self.rotation * inner.translation + self.translation,
        }
    }

    /// A local point in the outer frame.
    #[inline]
    pub fn transform_point(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * point + self.translation
    }

    /// A point of the outer frame in the local frame.
    #[inline]
    pub fn inverse_transform_point(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.tr_mul(&(point - self.translation))
    }

    /// A direction of the outer frame in the local frame.
    #[inline]
    pub fn inverse_transform_vector(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.tr_mul(vector)
    }
}
