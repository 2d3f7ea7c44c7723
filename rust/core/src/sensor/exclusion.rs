//! The torque of an external wrench at a sensor (Vorndamme 2017, eq. 20).

use nalgebra::{Vector3, Vector6};

use super::sensor_tree::SensorTree;
use crate::robot::jacobian::for_each_column;
use crate::robot::{Kinematics, Robot};
use crate::spatial::vector::moved;

/// Writes `J(S)^T F_ext,S`, `(nv,)`, for a wrench at the sensor's origin, world axes.
///
/// Joints behind the sensor and on other branches get zero.
pub(crate) fn sensor_torque(
    robot: &Robot,
    kinematics: &Kinematics,
    tree: &SensorTree,
    sensor: usize,
    wrench: &Vector6<f64>,
    torque: &mut [f64],
) {
    torque.fill(0.0);
    let about_origin = moved(wrench, &tree.position(kinematics, sensor));
    for_each_column(robot, kinematics, tree.body(sensor), &Vector3::zeros(), |k, column| {
        torque[k] = column.dot(&about_origin);
    });
}
