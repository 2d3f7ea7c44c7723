//! The joint-space mass matrix by the composite rigid body algorithm.

use nalgebra::DMatrix;

use super::inertia::SpatialInertia;
use crate::error::Result;
use crate::robot::joint_axis::motion_axis;
use crate::robot::kinematics::Kinematics;
use crate::robot::{Robot, WORLD};
use crate::spatial::vector::{split, stack};

impl Robot {
    /// `M(q)`, `(nv, nv)`.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the argument.
    pub fn mass_matrix(&self, q: &[f64]) -> Result<DMatrix<f64>> {
        self.check_configuration(q)?;
        let mut kinematics = Kinematics::new(self);
        kinematics.set_configuration(self, q);
        let mut composite = vec![SpatialInertia::zero(); self.bodies.len()];
        let mut matrix = DMatrix::zeros(self.nv(), self.nv());
        for (index, body) in self.bodies.iter().enumerate().skip(1).rev() {
            let state = &kinematics.bodies[index];
            composite[index].add(&SpatialInertia::of(body, state));
            let inertia = composite[index];
            composite[body.parent].add(&inertia);
            for column in 0..body.kind.nv() {
                let k = body.idx_v + column;
                let (linear, angular) = split(&motion_axis(body.kind, state, column));
                let (force, moment) = inertia.apply(&linear, &angular);
                let force = stack(&force, &moment);
                let mut above = index;
                while above != WORLD {
                    let other = &self.bodies[above];
                    for row in 0..other.kind.nv() {
                        let axis = motion_axis(other.kind, &kinematics.bodies[above], row);
                        let value = axis.dot(&force);
                        matrix[(other.idx_v + row, k)] = value;
                        matrix[(k, other.idx_v + row)] = value;
                    }
                    above = other.parent;
                }
            }
            for k in body.idx_v..body.idx_v + body.kind.nv() {
                matrix[(k, k)] += body.armature;
            }
        }
        Ok(matrix)
    }
}
