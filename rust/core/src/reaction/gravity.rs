//! The torque that carries a robot's weight.

use crate::robot::jacobian::for_each_column;
use crate::robot::{Kinematics, Robot};
use crate::spatial::vector::split;

/// Writes the torque of gravity compensation at the pose of `kinematics` (Nm, N), without allocation.
pub(super) fn carry(robot: &Robot, kinematics: &Kinematics, torque: &mut [f64]) {
    torque.fill(0.0);
    let gravity = robot.gravity();
    for body in 1..robot.body_count() {
        let state = &kinematics.bodies[body];
        let centre = state.position + state.rotation * robot.bodies[body].com;
        let weight = robot.bodies[body].mass * gravity;
        for_each_column(robot, kinematics, body, &centre, |k, column| {
            torque[k] -= split(&column).0.dot(&weight);
        });
    }
}
