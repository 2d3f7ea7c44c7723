//! Rigid transforms.

use nalgebra::{Matrix3, Vector3};

/// A rigid transform: `world = rotation * local + translation`.
///
/// ```
/// use contactsense::spatial::Pose;
/// use nalgebra::{Rotation3, Vector3};
///
/// let pose = Pose {
///     rotation: Rotation3::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_2).into_inner(),
///     translation: Vector3::new(1.0, 0.0, 0.0),
/// };
/// let point = pose.transform_point(&Vector3::x());
/// assert!((point - Vector3::new(1.0, 1.0, 0.0)).norm() < 1e-12);
/// assert!((pose.inverse_transform_point(&point) - Vector3::x()).norm() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Pose {
    /// Rotation from the local to the outer frame.
    pub rotation: Matrix3<f64>,
    /// The local origin in the outer frame (m).
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
