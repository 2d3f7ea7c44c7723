//! A complete fit of a log: shapes of friction and delays by trial, rows without contacts, and the solution.

use nalgebra::DVector;

use super::contacts::without_contact;
use super::folds::{fit, hold_out, HeldOut, CHANGES, USUAL_CHANGE};
use super::hysteresis::{USUAL_WIDTH, WIDTHS};
use super::log::Log;
use super::noise::white;
use super::normal::{own_terms, Joints, Shape};
use super::rows::{torque_deviations, Filter, Row};
use super::shapes::{Choice, CLEAR_OF_NOISE};
use super::solve::Solution;
use super::uncertainty::{self, weight, Uncertainty};
use super::unknowns::{Unknowns, ARMATURE, BIAS, COULOMB, TERMS};
use super::CalibrationOptions;
use crate::error::{Error, Result};
use crate::robot::Robot;

/// After a contact the filters need so many time constants to forget it.
const FORGOTTEN: f64 = 3.0;
/// Rounds in which weights, left-out contacts and reversals of friction settle.
const ROUNDS: usize = 4;
/// The first of these settle shapes alone: bodies stay near the description, and joints keep hysteresis.
const UNSETTLED: usize = 2;
/// A joint whose torques are smaller counts as if they were this large (Nm).
const SMALLEST_TORQUE: f64 = 1e-3;
/// A joint that moves more slowly counts as if it moved so fast (rad/s; m/s).
const SMALLEST_VELOCITY: f64 = 1e-2;
/// Any shape: the rotor's term has none.
const FIRST: Shape = Shape { friction: 0, hysteresis: None };
/// One that speeds up more slowly, as if it did so this fast (rad/s^2; m/s^2).
const SMALLEST_ACCELERATION: f64 = 1e-1;
/// Sensors are off by some tenths of Nm (N), or per cent of their load: one standard deviation.
const USUAL_BIAS: f64 = 0.3;
const BIAS_SHARE: f64 = 0.02;
/// Gears keep back some per cent of a change of the torque: one standard deviation before the log is seen.
const USUAL_HYSTERESIS: f64 = 0.05;

/// The rows of a log and what explains them.
pub(super) struct Fit {
    pub unknowns: Unknowns,
    pub joints: Joints,
    pub rows: Vec<Row>,
    pub used: Vec<bool>,
    pub held_out: HeldOut,
    pub solution: Solution,
    pub uncertainty: Uncertainty,
    pub velocity_delay: f64,
    /// Standard deviation of each torque (Nm; N).
    pub deviations: Vec<f64>,
}

impl Fit {
    pub fn of(
        robot: &Robot,
        log: &Log<'_>,
        options: &CalibrationOptions,
        filter: &Filter,
        velocity_delay: f64,
        step: f64,
        rows: Vec<Row>,
    ) -> Result<Self> {
        let mut term_units = term_units(robot, log, &rows);
        if options.torque_is_external {
            // All of an external torque may be bias.
            term_units.iter_mut().for_each(|units| units[BIAS] += units[COULOMB]);
        }
        let unknowns = Unknowns::new(robot, options.payload_link, term_units);
        let nv = robot.nv();
        let unexplained: Vec<DVector<f64>> = rows.iter().map(|row| row.unexplained.clone()).collect();
        let mut used = vec![true; rows.len()];
        let weights = (0..nv).map(|j| weight(&unexplained, &used, j)).collect();
        let deviations = torque_deviations(robot, log);
        let clear = (0..nv).map(|j| {
            let noise = CLEAR_OF_NOISE * white(|k| log.tau_of(k)[j], log.time, step);
            WIDTHS
                .iter()
                .position(|width| width * deviations[j] > noise)
                .filter(|_| !options.torque_is_external)
                .unwrap_or(WIDTHS.len())
        });
        let clear: Vec<usize> = clear.collect();
        // All have hysteresis at first: without it, masses would have to explain what it does.
        let shape = |first: &usize| Shape {
            friction: 0,
            hysteresis: (*first < WIDTHS.len()).then_some((*first).max(USUAL_WIDTH)),
        };
        let mut joints = Joints { weights, shapes: clear.iter().map(shape).collect() };
        let margin = (FORGOTTEN / filter.gain / filter.spacing).ceil() as usize;
        let failed =
            || Error::input("log", "cannot be fitted: joints must move, and torques must be of a usual size");
        let mut held_out = hold_out(&unknowns, &joints, &rows, &used, &USUAL_CHANGE).ok_or_else(failed)?;
        for round in 0..ROUNDS {
            used = without_contact(&held_out.residuals, margin);
            let choice = Choice {
                unknowns: &unknowns,
                joints: &joints,
                rows: &rows,
                used: &used,
                held_out: &held_out,
                clear: &clear,
            };
            joints.shapes = choice.shapes(round >= UNSETTLED);
            joints.weights = (0..nv).map(|j| weight(&held_out.residuals, &used, j)).collect();
            let changes = if round + 1 < UNSETTLED { &USUAL_CHANGE[..] } else { &CHANGES };
            held_out = hold_out(&unknowns, &joints, &rows, &used, changes).ok_or_else(failed)?;
        }
        let solution = fit(&unknowns, &joints, &rows, &used, held_out.change).ok_or_else(failed)?;
        let uncertainty = uncertainty::covariance(
            &unknowns,
            &joints,
            &rows,
            &used,
            &held_out,
            &solution,
            &rated(robot, log),
        )
        .ok_or_else(failed)?;
        Ok(Fit { unknowns, joints, rows, used, held_out, solution, uncertainty, velocity_delay, deviations })
    }
}

/// The torque of each joint that it is built for; where the description does not say, twice the largest of the log (Nm; N).
fn rated(robot: &Robot, log: &Log<'_>) -> Vec<f64> {
    let largest = |j: usize| (0..log.len()).map(|row| log.tau_of(row)[j].abs()).fold(0.0, f64::max);
    let limits = robot.effort_limits().into_iter().enumerate();
    limits.map(|(j, limit)| if limit.is_finite() && limit > 0.0 { limit } else { 2.0 * largest(j) }).collect()
}

/// How large each term of a joint may be: each but the bias alone could be all of its torque.
pub(super) fn term_units(robot: &Robot, log: &Log<'_>, rows: &[Row]) -> Vec<[f64; TERMS]> {
    let root_mean_square = |value: &dyn Fn(&Row) -> f64| {
        (rows.iter().map(|row| value(row).powi(2)).sum::<f64>() / rows.len() as f64).sqrt()
    };
    let unit = |j: usize| {
        let torque = root_mean_square(&|row| log.tau_of(row.index)[j]).max(SMALLEST_TORQUE);
        let velocity = root_mean_square(&|row| log.v_of(robot, row.index)[j]).max(SMALLEST_VELOCITY);
        let acceleration =
            root_mean_square(&|row| own_terms(row, j, FIRST)[ARMATURE]).max(SMALLEST_ACCELERATION);
        [BIAS_SHARE * torque + USUAL_BIAS, torque, torque / velocity, torque / acceleration, USUAL_HYSTERESIS]
    };
    (0..robot.nv()).map(unit).collect()
}
