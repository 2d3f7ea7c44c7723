//! From contact-free motion to a calibration.

use super::complete_fit::{term_units, Fit};
use super::delay::velocity_delay;
use super::folds::enough;
use super::log::Log;
use super::normal::{of_external, scaled, terms};
use super::rows::{rows, Filter, Row};
use super::scale;
use super::smooth::smooth_velocity;
use super::unknowns::{Unknowns, PARAMETERS};
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
/// Rows that are further apart say nothing of inertia (s).
const LONGEST_STEP: f64 = 0.1;

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
    if external {
        rows = rows.into_iter().map(of_external).collect();
    }
    let fit = |options: &CalibrationOptions| {
        let scales =
            if external { vec![1.0; robot.nv()] } else { torque_scales(robot, &smooth, options, &rows) };
        scale::needed(scales, |scales| {
            let tau = multiplied(log.tau, scales);
            let rows = rows.iter().map(|row| scaled(row, scales)).collect();
            Fit::of(robot, &Log { tau: &tau, ..smooth }, options, &filter, velocity_delay, step, rows)
        })
    };
    let calibration = |(scales, fit): (Vec<f64>, Fit), options: &CalibrationOptions| {
        let tau = multiplied(log.tau, &scales);
        let found = fit.calibration(robot, &Log { tau: &tau, ..*log }, options, step)?;
        Ok(Calibration { torque_scale: scales, ..found })
    };
    let found = fit(options)?;
    let Some(nothing) = found.1.nothing_held(robot, options) else { return calibration(found, options) };
    // What the fit makes of a payload without mass is no payload that a robot could hold: bodies have to explain it.
    let without = CalibrationOptions { payload_link: None, ..options.clone() };
    let mut calibration = calibration(fit(&without)?, &without)?;
    calibration.notes.push(format!(
        "Nothing is held at {}: the robot is not heavier than its description says. If it is lighter, the description holds a \
         tool that is not mounted, or too heavy links.",
        nothing.link
    ));
    Ok(Calibration { payload: Some(nothing), ..calibration })
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
