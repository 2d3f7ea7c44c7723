//! Forward dynamics by the articulated body algorithm.

use nalgebra::{Matrix6, Vector3, Vector6};

use super::inertia::SpatialInertia;
use crate::error::Result;
use crate::robot::configuration::spread_torque;
use crate::robot::description::JointKind;
use crate::robot::joint_axis::{cross_force, cross_motion, motion_axis};
use crate::robot::kinematics::Kinematics;
use crate::robot::{Robot, WORLD};
use crate::spatial::vector::stack;

/// What one body hands to the forward sweep.
#[derive(Debug, Clone, Copy)]
struct Articulated {
    inertia: Matrix6<f64>,
    bias: Vector6<f64>,
    axis: Vector6<f64>,
    drift: Vector6<f64>,
    effort: Vector6<f64>,
    inverse: f64,
    excess: f64,
    acceleration: Vector6<f64>,
}

/// Workspace of the articulated body algorithm.
///
/// ```
/// use contactsense::robot::{ForwardDynamics, Kinematics, Robot};
///
/// let robot = Robot::example_arm();
/// let (q, v) = (vec![0.4; 7], vec![0.0; 7]);
/// let mut kinematics = Kinematics::new(&robot);
/// kinematics.set_configuration(&robot, &q);
/// kinematics.set_velocity(&robot, &v);
/// // The torque that holds the arm gives no acceleration.
/// let weight = robot.inverse_dynamics(&q, &v, &v)?;
/// let mut acceleration = vec![1.0; 7];
/// ForwardDynamics::new(&robot).evaluate(&robot, &kinematics, &v, &weight, &mut acceleration);
/// assert!(acceleration.iter().all(|a| a.abs() < 1e-9));
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ForwardDynamics {
    bodies: Vec<Articulated>,
}

impl ForwardDynamics {
    /// Space for a robot's bodies.
    pub fn new(robot: &Robot) -> Self {
        let zero = Vector6::zeros();
        let empty = Articulated {
            inertia: Matrix6::zeros(),
            bias: zero,
            axis: zero,
            drift: zero,
            effort: zero,
            inverse: 0.0,
            excess: 0.0,
            acceleration: zero,
        };
        Self { bodies: vec![empty; robot.body_count()] }
    }

    /// Writes `M^-1 (tau - C v - g)` for the total torque `tau` `(nv,)`.
    ///
    /// `kinematics` holds the configuration and `v`. A joint that moves no inertia gets acceleration 0.
    pub fn evaluate(
        &mut self,
        robot: &Robot,
        kinematics: &Kinematics,
        v: &[f64],
        tau: &[f64],
        acceleration: &mut [f64],
    ) {
        for ((body, state), work) in robot.bodies.iter().zip(&kinematics.bodies).zip(&mut self.bodies).skip(1)
        {
            let inertia = SpatialInertia::of(body, state);
            let (f, n) = inertia.apply(&state.linear, &state.angular);
            let (force, moment) = cross_force(state, &f, &n);
            work.inertia = inertia.matrix();
            work.bias = stack(&force, &moment);
            if body.kind != JointKind::FreeFlyer {
                work.axis = motion_axis(body.kind, state, 0);
                work.drift = cross_motion(state, &work.axis) * v[body.idx_v];
            }
        }
        for index in (1..robot.bodies.len()).rev() {
            let body = &robot.bodies[index];
            if body.kind == JointKind::FreeFlyer {
                continue;
            }
            let work = &mut self.bodies[index];
            work.effort = work.inertia * work.axis;
            let diagonal = work.axis.dot(&work.effort) + body.armature;
            work.inverse = if diagonal > 0.0 { 1.0 / diagonal } else { 0.0 };
            work.excess = tau[body.idx_v] - work.axis.dot(&work.bias);
            if body.parent == WORLD {
                continue;
            }
            let scaled = work.effort * work.inverse;
            let inertia = work.inertia - scaled * work.effort.transpose();
            let bias = work.bias + inertia * work.drift + scaled * work.excess;
            let parent = &mut self.bodies[body.parent];
            parent.inertia += inertia;
            parent.bias += bias;
        }
        // Gravity as an upward acceleration of the world.
        self.bodies[WORLD].acceleration = stack(&-robot.gravity, &Vector3::zeros());
        for index in 1..robot.bodies.len() {
            let body = &robot.bodies[index];
            let state = &kinematics.bodies[index];
            let carried = self.bodies[body.parent].acceleration;
            let work = &mut self.bodies[index];
            if body.kind == JointKind::FreeFlyer {
                let mut lhs = Matrix6::zeros();
                let mut rhs = Vector6::zeros();
                let axes: [Vector6<f64>; 6] =
                    std::array::from_fn(|column| motion_axis(body.kind, state, column));
                let load = work.bias + work.inertia * carried;
                for row in 0..6 {
                    rhs[row] = tau[body.idx_v + row] - axes[row].dot(&load);
                    let effort = work.inertia * axes[row];
                    for column in 0..6 {
                        lhs[(row, column)] = axes[column].dot(&effort);
                    }
                    lhs[(row, row)] += body.armature;
                }
                let solution = lhs.cholesky().map_or_else(Vector6::zeros, |factor| factor.solve(&rhs));
                work.acceleration = carried;
                for row in 0..6 {
                    acceleration[body.idx_v + row] = solution[row];
                    work.acceleration += axes[row] * solution[row];
                }
            } else {
                let before = carried + work.drift;
                let rate = (work.excess - work.effort.dot(&before)) * work.inverse;
                acceleration[body.idx_v] = rate;
                work.acceleration = before + work.axis * rate;
            }
        }
    }
}

impl Robot {
    /// `M(q)^-1 (tau + tau_ext - C(q, v) v - g(q))`, `(nv,)`.
    ///
    /// `tau` is `(nv,)`, or `(nv - 6,)` for a floating base; `tau_ext` is `(nv,)`.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the argument.
    pub fn forward_dynamics(
        &self,
        q: &[f64],
        v: &[f64],
        tau: &[f64],
        tau_ext: Option<&[f64]>,
    ) -> Result<Vec<f64>> {
        self.check_configuration(q)?;
        self.check_tangent("v", v)?;
        self.check_torque("tau", tau)?;
        let mut total = vec![0.0; self.nv()];
        spread_torque(tau, &mut total);
        if let Some(tau_ext) = tau_ext {
            self.check_tangent("tau_ext", tau_ext)?;
            total.iter_mut().zip(tau_ext).for_each(|(sum, ext)| *sum += ext);
        }
        let mut kinematics = Kinematics::new(self);
        kinematics.set_configuration(self, q);
        kinematics.set_velocity(self, v);
        let mut acceleration = vec![0.0; self.nv()];
        ForwardDynamics::new(self).evaluate(self, &kinematics, v, &total, &mut acceleration);
        Ok(acceleration)
    }
}
