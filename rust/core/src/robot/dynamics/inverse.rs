//! Inverse dynamics by the recursive Newton-Euler algorithm.

use nalgebra::Vector3;

use super::inertia::SpatialInertia;
use crate::error::Result;
use crate::robot::joint_axis::{cross_force, cross_motion, motion_axis};
use crate::robot::kinematics::Kinematics;
use crate::robot::{Robot, WORLD};
use crate::spatial::vector::{split, stack};

impl Robot {
    /// `M(q) a + C(q, v) v + g(q)`, `(nv,)`.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the argument.
    pub fn inverse_dynamics(&self, q: &[f64], v: &[f64], a: &[f64]) -> Result<Vec<f64>> {
        self.check_configuration(q)?;
        self.check_tangent("v", v)?;
        self.check_tangent("a", a)?;
        let mut kinematics = Kinematics::new(self);
        kinematics.set_configuration(self, q);
        kinematics.set_velocity(self, v);

        let zero = Vector3::zeros();
        let mut acceleration = vec![stack(&zero, &zero); self.bodies.len()];
        let mut wrench = acceleration.clone();
        // Gravity as an upward acceleration of the world.
        acceleration[WORLD] = stack(&-self.gravity, &zero);
        for (index, body) in self.bodies.iter().enumerate().skip(1) {
            let state = &kinematics.bodies[index];
            let mut rate = acceleration[body.parent];
            for column in 0..body.kind.nv() {
                let axis = motion_axis(body.kind, state, column);
                rate += axis * a[body.idx_v + column] + cross_motion(state, &axis) * v[body.idx_v + column];
            }
            acceleration[index] = rate;
            let inertia = SpatialInertia::of(body, state);
            let (linear, angular) = split(&rate);
            let (force, moment) = inertia.apply(&linear, &angular);
            let (f, n) = inertia.apply(&state.linear, &state.angular);
            let (gyro_force, gyro_moment) = cross_force(state, &f, &n);
            wrench[index] = stack(&(force + gyro_force), &(moment + gyro_moment));
        }
        let mut tau = vec![0.0; self.nv()];
        for (index, body) in self.bodies.iter().enumerate().skip(1).rev() {
            for column in 0..body.kind.nv() {
                let axis = motion_axis(body.kind, &kinematics.bodies[index], column);
                let k = body.idx_v + column;
                tau[k] = axis.dot(&wrench[index]) + body.armature * a[k];
            }
            let carried = wrench[index];
            wrench[body.parent] += carried;
        }
        Ok(tau)
    }
}
