//! Which errors of weights, biases and viscous friction a fit leaves possible, and show at other poses than the log's.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::noise::SMALLEST;
use super::unknowns::{Unknowns, BIAS, PARAMETERS, VISCOUS};
use crate::math::random::Stream;
use crate::robot::{Kinematics, Robot};
use crate::torque::ModelError;

/// More are not kept: the rest moves torques less.
const MOST: usize = 8;
/// Random poses at which errors are compared.
const POSES: u64 = 100;
/// Mass and first moment of a body.
const WEIGHT: usize = 4;
/// Errors whose mean square over joints and poses is less, relative to what is left of the torques of the log, are in the noise
/// already.
const SEEN: f64 = 4.0;
/// Speeds at which they are compared, as a share of the limits, and where there are none (rad/s; m/s).
const SPEED: f64 = 0.6;
const FASTEST: f64 = 3.0;

/// Independent errors of one standard deviation each, those that move the torques most at random poses first; `covariance` is that
/// of the unknowns at `z`, and `left` `(nv,)` what is left of the torques of the log (Nm).
pub(super) fn model_errors(
    robot: &Robot,
    unknowns: &Unknowns,
    z: &DVector<f64>,
    covariance: &DMatrix<f64>,
    left: &[f64],
) -> Vec<ModelError> {
    let (bodies, nv) = (unknowns.bodies.len(), robot.nv());
    let first = WEIGHT * bodies;
    let count = first + 2 * nv;
    // What each unknown does to them.
    let mut effect = DMatrix::<f64>::zeros(count, unknowns.len());
    for (k, column) in unknowns.derivative(z).iter().enumerate() {
        if column.first < PARAMETERS * bodies {
            for (i, value) in column.values.iter().take(WEIGHT).enumerate() {
                effect[(WEIGHT * (column.first / PARAMETERS) + i, k)] = *value;
            }
        }
    }
    for j in 0..nv {
        effect[(first + j, unknowns.term(j, BIAS))] = 1.0;
        effect[(first + nv + j, unknowns.term(j, VISCOUS))] = 1.0;
    }
    let root = root(&(&effect * covariance * effect.transpose()));
    let of = |column: &[f64]| ModelError {
        bodies: (0..bodies).map(|body| std::array::from_fn(|i| column[WEIGHT * body + i])).collect(),
        bias: column[first..first + nv].to_vec(),
        viscous: column[first + nv..].to_vec(),
    };
    let columns: Vec<ModelError> = root.column_iter().map(|column| of(column.as_slice())).collect();
    let mut squares = DMatrix::<f64>::zeros(count, count);
    let mut kinematics = Kinematics::new(robot);
    let mut torques = DMatrix::<f64>::zeros(nv, count);
    for (q, v) in random_motion(robot) {
        kinematics.set_configuration(robot, &q);
        for (column, mut torque) in columns.iter().zip(torques.column_iter_mut()) {
            column.torque(robot, &kinematics, &v, torque.as_mut_slice());
            torque.iter_mut().zip(left).for_each(|(torque, left)| *torque /= left.max(SMALLEST));
        }
        squares.gemm_tr(1.0, &torques, &torques, 1.0);
    }
    let eigen = SymmetricEigen::new(squares / (POSES as f64 * nv as f64));
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let kept = order.into_iter().take(MOST).filter(|k| eigen.eigenvalues[*k] > SEEN);
    let error = |k: usize| {
        let share = 1.0 - SEEN / eigen.eigenvalues[k];
        of((&root * eigen.eigenvectors.column(k) * share.sqrt()).as_slice())
    };
    kept.map(error).collect()
}

/// Random poses within the limits, with random velocities.
fn random_motion(robot: &Robot) -> Vec<(Vec<f64>, Vec<f64>)> {
    let speeds = robot.velocity_limits();
    let state = |seed: u64| {
        let stream = Stream::new(seed);
        let speed =
            |(j, limit): (usize, &f64)| SPEED * limit.min(FASTEST) * (2.0 * stream.uniform(j as u64) - 1.0);
        (robot.random_configuration(seed), speeds.iter().enumerate().map(speed).collect())
    };
    (0..POSES).map(state).collect()
}

/// A square root of a covariance: columns that are independent errors.
fn root(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    // Masses and moments have other units and sizes: roots of the diagonal are the scale.
    let scale = covariance.diagonal().map(|variance| variance.max(0.0).sqrt());
    let unit = |k: usize| if scale[k] > 0.0 { scale[k] } else { 1.0 };
    let scaled = DMatrix::from_fn(covariance.nrows(), covariance.ncols(), |a, b| {
        covariance[(a, b)] / (unit(a) * unit(b))
    });
    let eigen = SymmetricEigen::new(scaled);
    DMatrix::from_fn(covariance.nrows(), covariance.ncols(), |a, k| {
        unit(a) * eigen.eigenvectors[(a, k)] * eigen.eigenvalues[k].max(0.0).sqrt()
    })
}
