//! Momentum and its known rate as linear functions of the inertial parameters.
//!
//! With the parameters `(m, m c, I)` of a body about its own origin, its momentum is linear in them, and so are
//! `p_i = S_i . h` and `(C^T v - g)_i = (V_i x S_i) . h + S_i . w` (`w` its weight) of every joint below it. Low-passed
//! as a momentum observer does, these columns regress the external torque on the parameters without any acceleration
//! (algorithm D2).

use nalgebra::{DMatrix, Matrix3, Vector3, Vector6};

use crate::robot::joint_axis::{cross_motion, motion_axis};
use crate::robot::kinematics::{BodyState, Kinematics};
use crate::robot::Robot;
use crate::spatial::vector::stack;

/// Inertial parameters of a body: mass, three first moments, and the six moments `xx, xy, yy, xz, yz, zz` about its origin.
pub(crate) const PARAMETERS: usize = 10;

/// The derivative of an inertia matrix by each of its six moments, as pairs of indices.
pub(crate) const MOMENTS: [(usize, usize); 6] = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)];

/// The regressors of momentum and known rate, `(nv, 10 bodies)` each; bodies without the world.
#[derive(Debug, Clone)]
pub(crate) struct MomentumRegressor {
    /// `M v` is this times the parameters.
    pub momentum: DMatrix<f64>,
    /// `C^T v - g` is this times the parameters.
    pub rate: DMatrix<f64>,
}

impl MomentumRegressor {
    pub fn new(robot: &Robot) -> Self {
        let zeros = DMatrix::zeros(robot.nv(), PARAMETERS * (robot.body_count() - 1));
        Self { momentum: zeros.clone(), rate: zeros }
    }

    /// Sets both at the configuration and velocity of `kinematics`.
    pub fn evaluate(&mut self, robot: &Robot, kinematics: &Kinematics) {
        for index in 1..robot.bodies.len() {
            let state = &kinematics.bodies[index];
            let momentum = unit_momenta(state);
            let weight = unit_weights(state, &robot.gravity);
            for &joint in robot.chain(index) {
                let body = &robot.bodies[joint];
                let moving = &kinematics.bodies[joint];
                for row in 0..body.kind.nv() {
                    let axis = motion_axis(body.kind, moving, row);
                    let turned = cross_motion(moving, &axis);
                    for (parameter, (h, w)) in momentum.iter().zip(&weight).enumerate() {
                        let place = (body.idx_v + row, PARAMETERS * (index - 1) + parameter);
                        self.momentum[place] = axis.dot(h);
                        self.rate[place] = turned.dot(h) + axis.dot(w);
                    }
                }
            }
        }
    }
}

/// The momentum of a body about the reference origin, for one of each parameter.
fn unit_momenta(state: &BodyState) -> [Vector6<f64>; PARAMETERS] {
    let at = &state.position;
    let linear = state.velocity_at(at);
    let spin = state.rotation.tr_mul(&state.angular);
    let mut momenta = [Vector6::zeros(); PARAMETERS];
    momenta[0] = stack(&linear, &at.cross(&linear));
    for axis in 0..3 {
        let arm = state.rotation.column(axis).into_owned();
        let force = state.angular.cross(&arm);
        momenta[1 + axis] = stack(&force, &(at.cross(&force) + arm.cross(&linear)));
    }
    for (column, &(row, other)) in MOMENTS.iter().enumerate() {
        let mut unit = Matrix3::zeros();
        unit[(row, other)] = 1.0;
        unit[(other, row)] = 1.0;
        momenta[4 + column] = stack(&Vector3::zeros(), &(state.rotation * (unit * spin)));
    }
    momenta
}

/// The weight of a body about the reference origin, for one of each parameter.
fn unit_weights(state: &BodyState, gravity: &Vector3<f64>) -> [Vector6<f64>; PARAMETERS] {
    let mut weights = [Vector6::zeros(); PARAMETERS];
    weights[0] = stack(gravity, &state.position.cross(gravity));
    for axis in 0..3 {
        weights[1 + axis] = stack(&Vector3::zeros(), &state.rotation.column(axis).cross(gravity));
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::test_tree::{joint, link, robot};
    use crate::robot::{JointKind, MomentumPass};

    /// A floating base that carries a turning, a sliding and a (cos, sin) joint.
    fn tree() -> Robot {
        let mut joints: Vec<_> = (0..4).map(|k| joint(&format!("j{k}"), k)).collect();
        joints[0].kind = JointKind::FreeFlyer;
        joints[2].kind = JointKind::Prismatic;
        joints[3].kind = JointKind::Continuous;
        joints[3].parent = crate::robot::BodyIndex::new(2);
        for (k, joint) in joints.iter_mut().enumerate() {
            let k = k as f64;
            joint.placement.translation = Vector3::new(0.3, 0.1 * k, -0.2);
            joint.axis = Vector3::new(1.0, k, 0.5);
            joint.com = Vector3::new(0.1, -0.2, 0.05 * k);
            joint.inertia = Matrix3::new(0.3, 0.01, 0.02, 0.01, 0.4, 0.03, 0.02, 0.03, 0.5);
        }
        let mut tree = robot(joints, vec![link("base", 1, None)]);
        tree.gravity = Vector3::new(1.0, 2.0, -9.0);
        tree
    }

    #[test]
    fn it_is_the_momentum_pass_written_as_columns() {
        for robot in [tree(), Robot::example_arm()] {
            let phi: Vec<f64> = robot.inertial_parameters().concat();
            let phi = nalgebra::DVector::from_vec(phi);
            let mut q = robot.neutral();
            for step in 0..3 {
                let v: Vec<f64> = (0..robot.nv()).map(|k| ((7 * k + step) as f64).sin()).collect();
                q = robot.integrate(&q, &v).unwrap();
                let mut kinematics = Kinematics::new(&robot);
                kinematics.set_configuration(&robot, &q);
                kinematics.set_velocity(&robot, &v);
                let (mut momentum, mut rate) = (vec![0.0; robot.nv()], vec![0.0; robot.nv()]);
                MomentumPass::new(&robot).evaluate(&robot, &kinematics, &v, &mut momentum, &mut rate);
                let mut regressor = MomentumRegressor::new(&robot);
                regressor.evaluate(&robot, &kinematics);
                let (p, r) = (&regressor.momentum * &phi, &regressor.rate * &phi);
                for body in &robot.bodies[1..] {
                    for k in body.idx_v..body.idx_v + body.kind.nv() {
                        let without_rotor = momentum[k] - body.armature * v[k];
                        assert!((p[k] - without_rotor).abs() < 1e-10 * (1.0 + p[k].abs()), "{k}");
                        assert!((r[k] - rate[k]).abs() < 1e-10 * (1.0 + r[k].abs()), "{k}");
                    }
                }
            }
        }
    }
}
