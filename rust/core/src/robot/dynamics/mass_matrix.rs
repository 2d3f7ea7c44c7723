//! The joint-space mass matrix by the composite rigid body algorithm.

use nalgebra::{DMatrix, Vector6};

use super::inertia::SpatialInertia;
use crate::error::Result;
use crate::robot::joint_axis::motion_axis;
use crate::robot::kinematics::Kinematics;
use crate::robot::Robot;
use crate::spatial::vector::{split, stack};

/// The mass matrix of one configuration, whose columns are worked out when they are asked for: a control loop can spread
/// the work over several ticks.
#[derive(Debug, Clone)]
pub(crate) struct MassMatrixPass {
    composite: Vec<SpatialInertia>,
    /// By velocity variable: its motion axis, and the momentum of all that it moves at unit velocity.
    axes: Vec<Vector6<f64>>,
    momenta: Vec<Vector6<f64>>,
    /// By velocity variable: the body that its joint moves, and its rotor inertia.
    bodies: Vec<usize>,
    armature: Vec<f64>,
}

impl MassMatrixPass {
    /// Space for a robot's bodies.
    pub fn new(robot: &Robot) -> Self {
        let (mut bodies, mut armature) = (vec![0; robot.nv()], vec![0.0; robot.nv()]);
        for (index, body) in robot.bodies.iter().enumerate().skip(1) {
            bodies[robot.velocity_range(index)].fill(index);
            armature[robot.velocity_range(index)].fill(body.armature);
        }
        MassMatrixPass {
            composite: vec![SpatialInertia::zero(); robot.bodies.len()],
            axes: vec![Vector6::zeros(); robot.nv()],
            momenta: vec![Vector6::zeros(); robot.nv()],
            bodies,
            armature,
        }
    }

    /// Takes in a configuration.
    pub fn begin(&mut self, robot: &Robot, kinematics: &Kinematics) {
        self.composite.fill(SpatialInertia::zero());
        for (index, body) in robot.bodies.iter().enumerate().skip(1).rev() {
            let state = &kinematics.bodies[index];
            self.composite[index].add(&SpatialInertia::of(body, state));
            let inertia = self.composite[index];
            self.composite[body.parent].add(&inertia);
            for column in 0..body.kind.nv() {
                let k = body.idx_v + column;
                self.axes[k] = motion_axis(body.kind, state, column);
                let (linear, angular) = split(&self.axes[k]);
                let (force, moment) = inertia.apply(&linear, &angular);
                self.momenta[k] = stack(&force, &moment);
            }
        }
    }

    /// Writes column `k` of the matrix, `(nv,)`.
    #[inline]
    pub fn column(&self, robot: &Robot, k: usize, column: &mut [f64]) {
        let body = self.bodies[k];
        for (i, value) in column.iter_mut().enumerate() {
            let other = self.bodies[i];
            *value = if robot.moves(other, body) {
                self.axes[i].dot(&self.momenta[k])
            } else if robot.moves(body, other) {
                self.axes[k].dot(&self.momenta[i])
            } else {
                0.0
            };
        }
        column[k] += self.armature[k];
    }
}

impl Robot {
    /// `M(q)`, `(nv, nv)`.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the argument.
    pub fn mass_matrix(&self, q: &[f64]) -> Result<DMatrix<f64>> {
        self.check_configuration(q)?;
        let mut kinematics = Kinematics::new(self);
        kinematics.set_configuration(self, q);
        let mut pass = MassMatrixPass::new(self);
        pass.begin(self, &kinematics);
        let mut matrix = DMatrix::zeros(self.nv(), self.nv());
        for k in 0..self.nv() {
            pass.column(self, k, matrix.column_mut(k).as_mut_slice());
        }
        Ok(matrix)
    }
}
