//! The force at a known point of contact (Vorndamme 2017, eqs. 29-30, without moment).

use nalgebra::{Matrix3, Vector3};

use super::wrench::jacobian_column;
use crate::robot::motion::split;
use crate::robot::{Kinematics, Robot};

/// Calls `each` with the velocity variable and the torque that a unit force at `at` of `body` causes, as a row.
fn force_rows(
    robot: &Robot,
    kinematics: &Kinematics,
    body: usize,
    at: &Vector3<f64>,
    mut each: impl FnMut(usize, Vector3<f64>),
) {
    for &joint in robot.chain(body) {
        for (column, k) in robot.velocity_range(joint).enumerate() {
            each(k, split(&jacobian_column(robot, kinematics, joint, column, at)).0);
        }
    }
}

/// Least squares over the chain of `body`, each torque weighted by its threshold; none where a direction is not felt.
pub(super) fn identify_force(
    robot: &Robot,
    kinematics: &Kinematics,
    body: usize,
    at: &Vector3<f64>,
    torque: &[f64],
    threshold: &[f64],
) -> Option<Vector3<f64>> {
    let (mut matrix, mut rhs) = (Matrix3::zeros(), Vector3::zeros());
    force_rows(robot, kinematics, body, at, |k, row| {
        let weight = 1.0 / (threshold[k] * threshold[k]);
        matrix += row * row.transpose() * weight;
        rhs += row * (torque[k] * weight);
    });
    Some(matrix.cholesky()?.solve(&rhs))
}

/// Takes what a force at `at` of `body` explains out of the unexplained torque.
pub(super) fn explain_force(
    robot: &Robot,
    kinematics: &Kinematics,
    body: usize,
    at: &Vector3<f64>,
    force: &Vector3<f64>,
    unexplained: &mut [f64],
) {
    force_rows(robot, kinematics, body, at, |k, row| unexplained[k] -= row.dot(force));
}
