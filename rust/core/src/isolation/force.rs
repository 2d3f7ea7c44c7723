//! The force at a known point of contact (Vorndamme 2017, eqs. 29-30, without moment).

use nalgebra::{Matrix3, Vector3};

use super::region::Region;
use crate::robot::jacobian::{for_each_column, jacobian_column};
use crate::robot::{Kinematics, Robot};
use crate::spatial::vector::split;

/// Smallest pivot of the normal matrix's root, as a share of the largest: its square is the condition of the matrix,
/// which costs the force that share of its digits.
const LEAST_PIVOT: f64 = 1e-5;

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
    for_each_column(robot, kinematics, body, at, |k, column| {
        let (row, _) = split(&column);
        let weight = 1.0 / (threshold[k] * threshold[k]);
        matrix += row * row.transpose() * weight;
        rhs += row * (torque[k] * weight);
    });
    let factor = matrix.cholesky()?;
    let pivots = factor.l_dirty().diagonal();
    // Beyond this condition the normal equations lose the force to rounding.
    (pivots.min() > LEAST_PIVOT * pivots.max()).then(|| factor.solve(&rhs))
}

/// Takes what a force at `at` of `body` explains out of the region's unexplained torque.
pub(super) fn explain_force(
    robot: &Robot,
    kinematics: &Kinematics,
    region: &Region,
    body: usize,
    at: &Vector3<f64>,
    force: &Vector3<f64>,
    unexplained: &mut [f64],
) {
    for joint in region.chain(robot, body) {
        for (column, k) in robot.velocity_range(joint).enumerate() {
            let axis = jacobian_column(robot, kinematics, joint, column, at);
            unexplained[k] -= split(&axis).0.dot(force);
        }
    }
}
