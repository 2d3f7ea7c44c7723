//! Spatial inertia about the reference origin, in world axes.

use nalgebra::{Matrix3, Matrix6, Vector3};

use crate::robot::kinematics::BodyState;
use crate::robot::robot::Body;

/// Ten numbers of a rigid body (or a composite of bodies) about the reference origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SpatialInertia {
    pub mass: f64,
    /// Mass times centre of mass.
    pub moment: Vector3<f64>,
    /// Rotational inertia about the reference origin.
    pub rotational: Matrix3<f64>,
}

impl SpatialInertia {
    #[inline]
    pub fn of(body: &Body, state: &BodyState) -> Self {
        let com = state.position + state.rotation * body.com;
        let about_com = state.rotation * body.inertia * state.rotation.transpose();
        let shift = Matrix3::from_diagonal_element(com.norm_squared()) - com * com.transpose();
        Self { mass: body.mass, moment: com * body.mass, rotational: about_com + shift * body.mass }
    }

    pub fn zero() -> Self {
        Self { mass: 0.0, moment: Vector3::zeros(), rotational: Matrix3::zeros() }
    }

    #[inline]
    pub fn add(&mut self, other: &Self) {
        self.mass += other.mass;
        self.moment += other.moment;
        self.rotational += other.rotational;
    }

    /// Momentum (linear, angular) of a motion.
    #[inline]
    pub fn apply(&self, linear: &Vector3<f64>, angular: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        (
            linear * self.mass + angular.cross(&self.moment),
            self.moment.cross(linear) + self.rotational * angular,
        )
    }

    /// As a 6 x 6 matrix, linear part first.
    #[inline]
    pub fn matrix(&self) -> Matrix6<f64> {
        let cross = self.moment.cross_matrix();
        let mut matrix = Matrix6::zeros();
        matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&Matrix3::from_diagonal_element(self.mass));
        matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-cross));
        matrix.fixed_view_mut::<3, 3>(3, 0).copy_from(&cross);
        matrix.fixed_view_mut::<3, 3>(3, 3).copy_from(&self.rotational);
        matrix
    }
}
