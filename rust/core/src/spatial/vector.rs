//! Spatial vectors, linear part first.

use nalgebra::{Vector3, Vector6};

/// A spatial vector of its two halves.
#[inline]
pub(crate) fn stack(linear: &Vector3<f64>, angular: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
}

/// The halves of a spatial vector.
#[inline]
pub(crate) fn split(vector: &Vector6<f64>) -> (Vector3<f64>, Vector3<f64>) {
    (Vector3::new(vector[0], vector[1], vector[2]), Vector3::new(vector[3], vector[4], vector[5]))
}

/// A wrench about a point that lies `arm` before its own.
#[inline]
pub(crate) fn moved(wrench: &Vector6<f64>, arm: &Vector3<f64>) -> Vector6<f64> {
    let (force, moment) = split(wrench);
    stack(&force, &(moment + arm.cross(&force)))
}
