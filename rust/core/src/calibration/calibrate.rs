//! From contact-free motion to a calibration.

use nalgebra::{DMatrix, DVector};

use super::contacts::without_contact;
use super::delay::velocity_delay;
use super::folds::{enough, fit, hold_out, HeldOut, CHANGES, USUAL_CHANGE};
use super::hysteresis::{USUAL_WIDTH, WIDTHS};
use super::log::Log;
use super::noise::white;
use super::normal::{of_external, own_terms, scaled, terms, Joints, Shape};
use super::rows::{rows, torque_deviations, Filter, Row};
use super::scale;
use super::shapes::{Choice, CLEAR_OF_NOISE};
use super::smooth::smooth_velocity;
use super::solve::Solution;
use super::uncertainty::{self, weight};
use super::unknowns::{Unknowns, ARMATURE, BIAS, COULOMB, PARAMETERS, TERMS};
use super::{Calibration, CalibrationOptions};
use crate::error::{Error, Result};
use crate::robot::Robot;

/// Of the filter that rows go through (1/s): slow enough to leave out noise, fast enough for the inertia of fast motion.
const GAIN: f64 = 8.0;
/// A slower log takes a slower filter: the largest step as a share of the filter's time constant.
const LARGEST_STEP: f64 = 0.3;
/// Rows a time constant: closer ones say nearly the same.
const ROWS_PER_TIME: f64 = 4.0;
/// Memory of all rows (bytes); a long log is read more sparsely.
const MEMORY: usize = 1 << 28;
/// Rounds in which weights, left-out contacts and reversals of friction settle.
const ROUNDS: usize = 4;
/// The first of these settle shapes alone: bodies stay near the description, and joints keep hysteresis.
const UNSETTLED: usize = 2;
/// After a contact the filters need so many time constants to forget it.
const FORGOTTEN: f64 = 3.0;
/// Rows that are further apart say nothing of inertia (s).
const LONGEST_STEP: f64 = 0.1;
/// Gears keep back some per cent of a change of the torque: one standard deviation before the log is seen.
const USUAL_HYSTERESIS: f64 = 0.05;

/// Learns a robot's bias, friction, inertias, payload, delays and noise from motion without contact (algorithm D2).
///
/// # Errors
/// [`Error::Input`] names what is wrong with the log or an option.
pub fn calibrate(robot: &Robot, log: &Log<'_>, options: &CalibrationOptions) -> Result<Calibration> {
    options.check(robot)?;
    log.check(robot)?;
    if robot.floating_base() {
        let text = "the base must be fixed: load the robot with the base held, and calibrate its limbs";
        return Err(Error::input("robot", text));
    }
    let step = median_step(log)?;
    let filter = filter_of(robot, log, step);
    // What the vendor computes has its own delays.
    let external = options.torque_is_external;
    let velocity_delay = if external { 0.0 } else { velocity_delay(robot, log, step)[0] };
    let v = smooth_velocity(robot, log, velocity_delay, step);
    let smooth = Log { v: &v, ..*log };
    let mut rows = enough_rows(robot, &smooth, &filter)?;
    let scales = if external {
        rows = rows.into_iter().map(of_external).collect();
        vec![1.0; robot.nv()]
    } else {
        torque_scales(robot, &smooth, options, &rows)
    };
    let fit = |scales: &[f64]| {
        let tau = multiplied(log.tau, scales);
        let rows = rows.iter().map(|row| scaled(row, scales)).collect();
        Fit::of(robot, &Log { tau: &tau, ..smooth }, options, &filter, velocity_delay, step, rows)
    };
    let (scales, fit) = scale::needed(scales, fit)?;
    let tau = multiplied(log.tau, &scales);
    let log = Log { tau: &tau, ..*log };
    Ok(Calibration { torque_scale: scales, ..fit.calibration(robot, &log, options, step)? })
}

/// The rows of a log and what explains them.
pub(super) struct Fit {
    pub unknowns: Unknowns,
    pub joints: Joints,
    pub rows: Vec<Row>,
    pub used: Vec<bool>,
    pub held_out: HeldOut,
    pub solution: Solution,
    pub covariance: DMatrix<f64>,
    pub velocity_delay: f64,
    /// Standard deviation of each torque (Nm; N).
    pub deviations: Vec<f64>,
}

impl Fit {
    fn of(
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
        let covariance = uncertainty::covariance(&unknowns, &joints, &rows, &used, &held_out, &solution)
            .ok_or_else(failed)?;
        Ok(Fit { unknowns, joints, rows, used, held_out, solution, covariance, velocity_delay, deviations })
    }
}

fn enough_rows(robot: &Robot, log: &Log<'_>, filter: &Filter) -> Result<Vec<Row>> {
    let rows = rows(robot, log, filter, &terms());
    if enough(rows.len()) {
        return Ok(rows);
    }
    let text = format!(
        "is too short: {:.1} s give {} rows of the fit; record at least 10 s of motion",
        log.time[log.len() - 1] - log.time[0],
        rows.len()
    );
    Err(Error::input("log", text))
}

/// Scale and sign of each torque.
fn torque_scales(robot: &Robot, log: &Log<'_>, options: &CalibrationOptions, rows: &[Row]) -> Vec<f64> {
    let unknowns = |scales: &[f64], rows: &[Row]| {
        let tau = multiplied(log.tau, scales);
        Unknowns::new(robot, options.payload_link, term_units(robot, &Log { tau: &tau, ..*log }, rows))
    };
    scale::torque_scales(rows, robot.nv(), unknowns)
}

fn multiplied(tau: &[f64], scales: &[f64]) -> Vec<f64> {
    tau.iter().zip(scales.iter().cycle()).map(|(tau, scale)| tau * scale).collect()
}

/// The time between most rows (s).
fn median_step(log: &Log<'_>) -> Result<f64> {
    let mut steps: Vec<f64> = log.time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    match steps.get(steps.len() / 2) {
        Some(step) if *step <= LONGEST_STEP => Ok(*step),
        Some(step) => {
            Err(Error::input("log", format!("has rows {step:.3} s apart; record at least 20 rows a second")))
        }
        None => Err(Error::input("log", "must have rows: record at least 10 s of motion")),
    }
}

fn filter_of(robot: &Robot, log: &Log<'_>, step: f64) -> Filter {
    let gain = GAIN.min(LARGEST_STEP / step);
    let columns = PARAMETERS * (robot.body_count() - 1) + terms().len();
    let most = (MEMORY / (8 * columns * robot.nv())).max(1);
    // Without gaps.
    let duration = log.len() as f64 * step;
    let spacing = f64::max(1.0 / (ROWS_PER_TIME * gain), duration / most as f64);
    // Not a row later because of rounding.
    Filter { gain, spacing: spacing.max(step) - 0.01 * step, longest_step: super::LONGEST_STEPS * step }
}

/// Any shape: the rotor's term has none.
const FIRST: Shape = Shape { friction: 0, hysteresis: None };

/// How large each term of a joint may be: each but the bias alone could be all of its torque.
fn term_units(robot: &Robot, log: &Log<'_>, rows: &[Row]) -> Vec<[f64; TERMS]> {
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

/// Sensors are off by some tenths of Nm (N), or per cent of their load: one standard deviation.
const USUAL_BIAS: f64 = 0.3;
const BIAS_SHARE: f64 = 0.02;
/// A joint whose torques are smaller counts as if they were this large (Nm).
const SMALLEST_TORQUE: f64 = 1e-3;
/// A joint that moves more slowly counts as if it moved so fast (rad/s; m/s).
const SMALLEST_VELOCITY: f64 = 1e-2;
/// One that speeds up more slowly, as if it did so this fast (rad/s^2; m/s^2).
const SMALLEST_ACCELERATION: f64 = 1e-1;
