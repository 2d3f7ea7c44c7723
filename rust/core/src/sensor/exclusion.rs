//! The torque of an external wrench at a sensor (Vorndamme 2017, eq. 20).

use nalgebra::Vector6;

use super::sensor_tree::SensorTree;
use crate::robot::joint_axis::motion_axis;
use crate::robot::{Kinematics, Robot};
use crate::spatial::vector::{split, stack};

/// Writes `J(S)^T F_ext,S`, `(nv,)`, for a wrench at the sensor's origin, world axes.
///
/// Joints behind the sensor and on other branches get zero.
pub fn sensor_torque(
    robot: &Robot,
    kinematics: &Kinematics,
    tree: &SensorTree,
    sensor: usize,
    wrench: &Vector6<f64>,
    torque: &mut [f64],
) {
    torque.fill(0.0);
    let (force, moment) = split(wrench);
    let about_origin = stack(&force, &(moment + tree.position(kinematics, sensor).cross(&force)));
    for &index in robot.chain(tree.body(sensor)) {
        let body = &robot.bodies[index];
        for column in 0..body.kind.nv() {
            let axis = motion_axis(body.kind, &kinematics.bodies[index], column);
            torque[body.idx_v + column] = axis.dot(&about_origin);
        }
    }
}
