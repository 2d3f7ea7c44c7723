//! Rigid transforms.

use nalgebra::{Matrix3, Vector3};

/// Largest entry of `R^T R - 1` of a rotation R: above the rounding of rotations in single precision, and of those
/// written with six digits.
const NOT_RIGID: f64 = 1e-5;

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

    /// Whether this is a rotation and a finite translation; a mirrored frame is none. An error says why not, as the
    /// end of a sentence.
    ///
    /// ```
    /// use contactsense::spatial::Pose;
    ///
    /// let mut pose = Pose::identity();
    /// assert!(pose.check_rigid().is_ok());
    /// pose.rotation.m33 = -1.0;
    /// assert_eq!(
    ///     pose.check_rigid().unwrap_err(),
    ///     "must be a rotation and a translation; the rotation's columns are off orthonormal by 0e0, its determinant is -1.000"
    /// );
    /// ```
    pub fn check_rigid(&self) -> Result<(), String> {
        let rotation = &self.rotation;
        if !rotation.iter().chain(&self.translation).all(|x| x.is_finite()) {
            return Err("is not finite".into());
        }
        let off = (rotation.tr_mul(rotation) - Matrix3::identity()).amax();
        if off > NOT_RIGID || rotation.determinant() < 0.0 {
            return Err(format!(
                "must be a rotation and a translation; the rotation's columns are off orthonormal by {off:.0e}, its \
                 determinant is {:.3}",
                rotation.determinant()
            ));
        }
        Ok(())
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

#[cfg(test)]
mod tests {
    use nalgebra::Rotation3;

    use super::*;

    #[test]
    fn a_rotation_and_a_finite_translation_are_rigid() {
        let turned = Pose {
            rotation: Rotation3::from_euler_angles(0.3, -1.2, 2.5).into_inner(),
            translation: Vector3::new(1.0, -2.0, 1e6),
        };
        // Single precision, and six digits.
        for coarse in [|x: f64| f64::from(x as f32), |x: f64| (1e6 * x).round() / 1e6] {
            let pose = Pose { rotation: turned.rotation.map(coarse), ..turned };
            assert_eq!(pose.check_rigid(), Ok(()));
        }
    }

    #[test]
    fn mirrored_scaled_sheared_and_infinite_frames_are_not() {
        let rotation = Rotation3::from_euler_angles(0.3, -1.2, 2.5).into_inner();
        let with = |rotation| Pose { rotation, translation: Vector3::zeros() };
        let mut sheared = rotation;
        sheared.m12 += 1e-3;
        for (pose, reason) in [
            (with(-rotation), "determinant is -1.000"),
            (with(rotation * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0))), "determinant is -1.000"),
            (with(1.001 * rotation), "off orthonormal by 2e-3"),
            (with(sheared), "off orthonormal"),
            (with(Matrix3::zeros()), "off orthonormal by 1e0"),
            (with(Matrix3::from_element(f64::NAN)), "is not finite"),
            (Pose { translation: Vector3::new(0.0, f64::INFINITY, 0.0), ..with(rotation) }, "is not finite"),
        ] {
            let found = pose.check_rigid().unwrap_err();
            assert!(found.contains(reason), "{found}");
        }
    }
}
