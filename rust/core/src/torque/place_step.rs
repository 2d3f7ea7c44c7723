//! How far a contact's point moves along the surface to explain a torque better: a step of Gauss and Newton.

use nalgebra::{Matrix2, Matrix6x2, Matrix6x3, Vector2, Vector3};

use super::force_model::directions;
use super::force_model::NO_FRICTION;
use super::frames::Frame;
use super::link_target::LinkTarget;
use crate::spatial::vector::stack;

/// Normal equations of a displacement along the surface, from which the force of the contact is eliminated.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlaceStep {
    point: Vector3<f64>,
    /// Along the inward normal, and across it.
    axes: [Vector3<f64>; 3],
    gram: Matrix2<f64>,
    product: Vector2<f64>,
}

impl PlaceStep {
    /// At a point of a link, with its outward normal (link's frame).
    pub fn at(point: &Vector3<f64>, normal: &Vector3<f64>) -> Self {
        PlaceStep {
            point: *point,
            axes: directions(normal),
            gram: Matrix2::zeros(),
            product: Vector2::zeros(),
        }
    }

    /// Takes in a torque, which counts as `share` of a measurement. `sign` is one for a contact that pushes, minus one for one
    /// that pulls; a force across the normal has a standard deviation of `slack` times the normal force. Nothing is taken in where
    /// the best force has the other sign.
    #[inline]
    pub fn take_in(&mut self, frame: &Frame, target: &LinkTarget, sign: f64, slack: f64, share: f64) {
        let forces = Matrix6x3::from_columns(&self.axes.map(|axis| stack(&axis, &self.point.cross(&axis))));
        let responses = frame.gram * forces;
        let (mut gram, products) = (forces.tr_mul(&responses), forces.tr_mul(&target.product));
        let size = sign * products[0] / gram[(0, 0)];
        // Also where it is no number.
        let possible = |size: f64| size > 0.0 && size.is_finite();
        if !possible(size) {
            return;
        }
        let precision = (slack * size).powi(-2).min(NO_FRICTION);
        gram[(1, 1)] += precision;
        gram[(2, 2)] += precision;
        let Some(inverse) = gram.try_inverse() else { return };
        let found = inverse * products;
        if !possible(sign * found[0]) {
            return;
        }
        let force = self.axes[0] * found[0] + self.axes[1] * found[1] + self.axes[2] * found[2];
        let moved = [self.axes[1], self.axes[2]].map(|axis| stack(&Vector3::zeros(), &axis.cross(&force)));
        let moved = Matrix6x2::from_columns(&moved);
        let beside = responses.tr_mul(&moved);
        self.gram += (moved.tr_mul(&(frame.gram * moved)) - beside.tr_mul(&(inverse * beside))) * share;
        self.product += moved.tr_mul(&(target.product - responses * found)) * share;
    }

    /// Root mean square of the distance from where the torques are likeliest (m), where it is about `size` in each direction without
    /// them; that where it is no number.
    #[inline]
    pub fn spread(&self, size: f64) -> f64 {
        let covariance = (self.gram + Matrix2::identity() / (size * size)).try_inverse();
        let squared = covariance.map_or(f64::NAN, |covariance| covariance.trace());
        if squared > 0.0 {
            squared.sqrt()
        } else {
            size
        }
    }

    /// The displacement (m), known beforehand to be about `size`; none where it is no number.
    #[inline]
    pub fn displacement(&self, size: f64) -> Option<Vector3<f64>> {
        let along = (self.gram + Matrix2::identity() / (size * size)).try_inverse()? * self.product;
        let displacement = self.axes[1] * along[0] + self.axes[2] * along[1];
        displacement.iter().all(|x| x.is_finite()).then_some(displacement)
    }
}
