//! Rows without time: the slow ones, as if the robot were at rest.

use nalgebra::{DMatrix, DVector};

use super::motion::Motion;
use super::terms::TERMS;
use crate::calibration::rows::{Row, Term};
use crate::robot::{Kinematics, MomentumRegressor, Robot};

/// A row is slow where no joint has more than this share of its usual velocity.
const SLOW: f64 = 0.1;

/// Slow rows that are enough to judge from; fewer are filled up with the slowest others.
const ENOUGH_SLOW_ROWS: usize = 60;

/// Slow rows as if the robot were at rest: what acceleration does is not known, and little.
pub(super) fn slow_rows(robot: &Robot, motion: &Motion, most: usize) -> Vec<Row> {
    let nv = robot.nv();
    let usual: Vec<f64> = (0..nv)
        .map(|k| {
            (motion.v.iter().skip(k).step_by(nv).map(|v| v * v).sum::<f64>() / motion.len().max(1) as f64)
                .sqrt()
        })
        .collect();
    let speed = |row: usize| -> f64 {
        (0..nv).map(|k| motion.v[row * nv + k].abs() / usual[k].max(1e-9)).fold(0.0, f64::max)
    };
    let mut order: Vec<(usize, f64)> = (0..motion.len()).map(|row| (row, speed(row))).collect();
    order.sort_by(|a, b| a.1.total_cmp(&b.1));
    let slow =
        order.iter().filter(|(_, speed)| *speed < SLOW).count().max(ENOUGH_SLOW_ROWS).max(order.len() / 5);
    let mut chosen: Vec<usize> = order.iter().take(slow).map(|(row, _)| *row).collect();
    chosen.sort_unstable();
    let thin = chosen.len().div_ceil(most.min(2000)).max(1);
    let mut kinematics = Kinematics::new(robot);
    let mut regressor = MomentumRegressor::new(robot);
    let parameters = DVector::from_vec(robot.inertial_parameters().concat());
    chosen
        .into_iter()
        .step_by(thin)
        .map(|index| {
            let v = &motion.v[index * nv..][..nv];
            let tau = &motion.tau[index * nv..][..nv];
            kinematics.set_configuration(robot, &motion.q[index * robot.nq()..][..robot.nq()]);
            kinematics.set_velocity(robot, v);
            regressor.evaluate(robot, &kinematics);
            let inertial = -&regressor.rate;
            let mut terms = DMatrix::zeros(nv, TERMS.len());
            for (column, term) in TERMS.iter().enumerate() {
                for k in 0..nv {
                    terms[(k, column)] = match term {
                        Term::Bias => 1.0,
                        Term::Coulomb(reversal) => reversal.share(0.0, v[k], 0.0),
                        Term::Viscous => v[k],
                        Term::Torque => tau[k],
                        _ => 0.0,
                    };
                }
            }
            let unexplained = DVector::from_column_slice(tau) - &inertial * &parameters;
            Row { index, unexplained, inertial, terms }
        })
        .collect()
}
