//! Normal equations of a wrench at a link's origin, in its frame: what a force at a point does to the rows of a measurement, each over
//! its noise, beside what was measured.

use nalgebra::{Matrix3, Matrix6, Matrix6x3, Vector3, Vector6};

use crate::spatial::vector::stack;

/// Gram matrix of the rows' columns, and their product with a measurement.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NormalEquations {
    pub gram: Matrix6<f64>,
    pub product: Vector6<f64>,
}

impl NormalEquations {
    /// Squared norm of the torques of a unit force along the inward normal, and their product with the measurement (Bimbo 2019,
    /// eqs. 6 and 7).
    #[inline]
    pub fn response(&self, point: &Vector3<f64>, normal: &Vector3<f64>) -> (f64, f64) {
        response(&self.gram, &self.product, point, normal)
    }

    /// As [`response`](Self::response), of unit forces in three directions: the Gram matrix of their torques, and the products with
    /// the measurement.
    #[inline]
    pub fn responses(
        &self,
        point: &Vector3<f64>,
        forces: &[Vector3<f64>; 3],
    ) -> (Matrix3<f64>, Vector3<f64>) {
        responses(&self.gram, &self.product, point, forces)
    }
}

#[inline]
pub(super) fn response(
    gram: &Matrix6<f64>,
    product: &Vector6<f64>,
    point: &Vector3<f64>,
    normal: &Vector3<f64>,
) -> (f64, f64) {
    let wrench = stack(normal, &point.cross(normal));
    (wrench.dot(&(gram * wrench)), -wrench.dot(product))
}

#[inline]
pub(super) fn responses(
    gram: &Matrix6<f64>,
    product: &Vector6<f64>,
    point: &Vector3<f64>,
    forces: &[Vector3<f64>; 3],
) -> (Matrix3<f64>, Vector3<f64>) {
    let wrenches = Matrix6x3::from_columns(&forces.map(|force| stack(&force, &point.cross(&force))));
    (wrenches.tr_mul(&(gram * wrenches)), wrenches.tr_mul(product))
}
