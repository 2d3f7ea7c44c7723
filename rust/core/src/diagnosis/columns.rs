//! Series low-passed as the rows are: delayed torques, and the torque of gravity along each axis.

use nalgebra::DMatrix;

use super::motion::Motion;
use super::terms::DELAYS;
use crate::calibration::rows::{Filter, Row};
use crate::robot::{JointKind, Kinematics, Robot};

/// The torques at other times, low-passed, at the rows found: one matrix a delay, `(rows, nv)`.
pub(super) fn delayed(motion: &Motion, filter: &Filter, found: &[Row]) -> Vec<DMatrix<f64>> {
    let one =
        |delay: &f64| low_passed(motion, &motion.shifted(&motion.tau, *delay), motion.nv, filter, found);
    DELAYS.iter().map(one).collect()
}

/// Series low-passed as `rows` does, at the rows found.
fn low_passed(motion: &Motion, values: &[f64], width: usize, filter: &Filter, found: &[Row]) -> DMatrix<f64> {
    let mut out = DMatrix::zeros(found.len(), width);
    let mut state = vec![0.0; width];
    let mut next = 0;
    for row in 0..motion.len() {
        let step = if row == 0 { f64::INFINITY } else { motion.time[row] - motion.time[row - 1] };
        if step > filter.longest_step {
            state.fill(0.0);
        } else {
            let kept = (-filter.gain * step).exp();
            for (k, y) in state.iter_mut().enumerate() {
                let mean = 0.5 * (values[row * width + k] + values[(row - 1) * width + k]);
                *y = kept * *y + (1.0 - kept) * mean;
            }
        }
        if found.get(next).is_some_and(|found| found.index == row) {
            out.row_mut(next).copy_from_slice(&state);
            next += 1;
        }
    }
    out
}

/// The torque that holds the robot against a unit of gravity along each axis, at the rows found, `(nv, 3)` each.
pub(super) fn gravity_columns(
    robot: &Robot,
    motion: &Motion,
    filter: Option<&Filter>,
    found: &[Row],
) -> Vec<DMatrix<f64>> {
    let (nq, nv) = (robot.nq(), robot.nv());
    let mut kinematics = Kinematics::new(robot);
    let mut of_row = |row: usize| -> DMatrix<f64> {
        kinematics.set_configuration(robot, &motion.q[row * nq..][..nq]);
        unit_gravity(robot, &kinematics)
    };
    let Some(filter) = filter else { return found.iter().map(|row| of_row(row.index)).collect() };
    let mut values = Vec::with_capacity(motion.len() * nv * 3);
    for row in 0..motion.len() {
        values.extend_from_slice(of_row(row).as_slice());
    }
    let passed = low_passed(motion, &values, 3 * nv, filter, found);
    (0..found.len()).map(|row| DMatrix::from_iterator(nv, 3, passed.row(row).iter().copied())).collect()
}

/// The torque that holds the robot against a unit of gravity along each axis.
fn unit_gravity(robot: &Robot, kinematics: &Kinematics) -> DMatrix<f64> {
    let mut columns = DMatrix::zeros(robot.nv(), 3);
    for (index, body) in robot.bodies.iter().enumerate().skip(1) {
        let state = &kinematics.bodies[index];
        let com = state.position + state.rotation * body.com;
        for &joint in robot.chain(index) {
            let moved = &robot.bodies[joint];
            let state = &kinematics.bodies[joint];
            let lever = match moved.kind {
                JointKind::Prismatic => state.axis(),
                JointKind::FreeFlyer => continue,
                _ => state.axis().cross(&(com - state.position)),
            };
            for direction in 0..3 {
                columns[(moved.idx_v, direction)] -= body.mass * lever[direction];
            }
        }
    }
    columns
}
