//! From contact-free motion to a calibration.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::calibration::{armature, body_inertia};
use super::contacts::{stretches, without_contact};
use super::delay::velocity_delay;
use super::folds::{enough, fit, hold_out, mean_square, HeldOut};
use super::friction::choose_reversals;
use super::log::Log;
use super::noise::{estimate, Judged};
use super::normal::{own_terms, Joints};
use super::notes::{notes, JointFacts};
use super::rest_errors::rest_errors;
use super::rows::{rows, Filter, Row, Term};
use super::smooth::smooth_velocity;
use super::solve::Solution;
use super::torque_model::{Friction, TorqueModel, REVERSALS};
use super::unknowns::{Unknowns, ARMATURE, BIAS, COULOMB, TERMS, VISCOUS};
use super::{Calibration, CalibrationOptions, Payload, Tail};
use crate::error::{Error, Result};
use crate::robot::Robot;
use crate::torque::NoiseModel;

/// Of the filter that rows go through (1/s): slow enough to leave out noise, fast enough for the inertia of fast motion.
const GAIN: f64 = 8.0;
/// A slower log takes a slower filter: the largest step as a share of the filter's time constant.
const LARGEST_STEP: f64 = 0.3;
/// Rows a time constant: closer ones say nearly the same.
const ROWS_PER_TIME: f64 = 4.0;
/// Memory of all rows (bytes); a long log is read more sparsely.
const MEMORY: usize = 1 << 28;
/// Rounds in which weights, left-out contacts and reversals of friction settle.
const ROUNDS: usize = 3;
/// After a contact the filters need so many time constants to forget it.
const FORGOTTEN: f64 = 3.0;
/// Rows that are further apart say nothing of inertia (s).
const LONGEST_STEP: f64 = 0.1;
/// Coulomb friction is not the same at all speeds: one standard deviation, as a share of it.
const FRICTION_SHAPE: f64 = 0.01;
/// A centre of mass that is less certain is unknown (m).
const UNKNOWN: f64 = 1.0;
/// The longest lag of a correlation, as a part of the rows.
const LONGEST_LAG: usize = 4;
/// Correlations smaller than this end the sum.
const UNCORRELATED: f64 = 0.05;

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
    let [velocity_delay, _] = velocity_delay(robot, log, step);
    let v = smooth_velocity(robot, log, velocity_delay, step);
    let fit = Fit::of(robot, &Log { v: &v, ..*log }, options, &filter, velocity_delay)?;
    fit.calibration(robot, log, options, step)
}

/// The rows of a log and what explains them.
struct Fit {
    unknowns: Unknowns,
    joints: Joints,
    rows: Vec<Row>,
    used: Vec<bool>,
    held_out: HeldOut,
    solution: Solution,
    covariance: DMatrix<f64>,
    velocity_delay: f64,
}

impl Fit {
    fn of(
        robot: &Robot,
        log: &Log<'_>,
        options: &CalibrationOptions,
        filter: &Filter,
        velocity_delay: f64,
    ) -> Result<Self> {
        let rows = rows(robot, log, filter, &terms());
        if !enough(rows.len()) {
            let text = format!(
                "is too short: {:.1} s give {} rows of the fit; record at least 10 s of motion",
                log.time[log.len() - 1] - log.time[0],
                rows.len()
            );
            return Err(Error::input("log", text));
        }
        let unknowns = Unknowns::new(robot, options.payload_link, term_units(robot, log, &rows));
        let nv = robot.nv();
        let unexplained: Vec<DVector<f64>> = rows.iter().map(|row| row.unexplained.clone()).collect();
        let mut used = vec![true; rows.len()];
        let weights = (0..nv).map(|j| weight(&unexplained, &used, j)).collect();
        let mut joints = Joints { weights, friction: vec![0; nv] };
        let margin = (FORGOTTEN / filter.gain / filter.spacing).ceil() as usize;
        let failed =
            || Error::input("log", "cannot be fitted: joints must move, and torques must be of a usual size");
        let mut held_out = hold_out(&unknowns, &joints, &rows, &used).ok_or_else(failed)?;
        for _ in 0..ROUNDS {
            used = without_contact(&held_out.residuals, margin);
            joints.friction = choose_reversals(&unknowns, &joints, &rows, &used, &held_out);
            joints.weights = (0..nv).map(|j| weight(&held_out.residuals, &used, j)).collect();
            held_out = hold_out(&unknowns, &joints, &rows, &used).ok_or_else(failed)?;
        }
        let (solution, covariance) =
            fit(&unknowns, &joints, &rows, &used, held_out.change).ok_or_else(failed)?;
        Ok(Fit { unknowns, joints, rows, used, held_out, solution, covariance, velocity_delay })
    }

    fn calibration(
        &self,
        robot: &Robot,
        log: &Log<'_>,
        options: &CalibrationOptions,
        step: f64,
    ) -> Result<Calibration> {
        let z = &self.solution.z;
        let nv = robot.nv();
        let unknowns = &self.unknowns;
        let term = |term: usize| (0..nv).map(|j| z[unknowns.term(j, term)]).collect::<Vec<f64>>();
        let deviation = |term: usize| {
            let variance = |j| self.covariance[(unknowns.term(j, term), unknowns.term(j, term))];
            (0..nv).map(|j| f64::sqrt(variance(j))).collect::<Vec<f64>>()
        };
        // Friction of another shape than the one fitted changes both coefficients.
        let shape: Vec<[f64; 2]> = (0..nv)
            .map(|j| {
                let error = FRICTION_SHAPE * z[unknowns.term(j, COULOMB)];
                [error, error * unknowns.term_units[j][VISCOUS] / unknowns.term_units[j][COULOMB]]
            })
            .collect();
        let step_of = |rows: [usize; 2]| rows.map(|row| log.time[self.rows[row].index]);
        let contacts: Vec<[f64; 2]> = stretches(&self.used).into_iter().map(step_of).collect();
        let without_payload = unknowns.without_payload(z);
        let (noise, tails) = self.noise(robot, log, step)?;
        Ok(Calibration {
            torque_bias: term(BIAS),
            torque_bias_std: deviation(BIAS),
            friction: self.friction(&unknowns.correction(z)),
            coulomb_std: shape.iter().zip(deviation(COULOMB)).map(|([c, _], d)| c.hypot(d)).collect(),
            viscous_std: shape.iter().zip(deviation(VISCOUS)).map(|([_, v], d)| v.hypot(d)).collect(),
            armature: armature(robot)
                .iter()
                .zip(term(ARMATURE))
                .map(|(before, more)| before + more)
                .collect(),
            armature_std: deviation(ARMATURE),
            bodies: without_payload.iter().enumerate().map(|(k, x)| body_inertia(robot, k, x)).collect(),
            payload: options.payload_link.and_then(|link| self.payload(&robot[link].name)),
            inertial_change: self.held_out.change,
            velocity_delay: self.velocity_delay,
            torque_delay: z[unknowns.torque_delay()],
            noise,
            tails,
            residual: (0..nv).map(|j| mean_square(&self.held_out.residuals, &self.used, j).sqrt()).collect(),
            false_alarms_per_hour: options.false_alarms_per_hour,
            notes: self.notes(robot, log, &contacts),
            contacts,
            ..Calibration::of_description(robot)
        })
    }

    fn notes(&self, robot: &Robot, log: &Log<'_>, contacts: &[[f64; 2]]) -> Vec<String> {
        let facts = |joint: usize| {
            let uncertain = |term: usize| {
                let k = self.unknowns.term(joint, term);
                self.covariance[(k, k)].sqrt() / self.solution.units[k]
            };
            let torques = self.rows.iter().map(|row| log.tau_of(row.index)[joint]);
            let count = self.rows.len() as f64;
            let mean = torques.clone().sum::<f64>() / count;
            let variance = torques.map(|tau| (tau - mean).powi(2)).sum::<f64>() / count;
            let left = mean_square(&self.held_out.residuals, &self.used, joint);
            JointFacts {
                name: &robot.joint_names()[joint],
                uncertain: std::array::from_fn(uncertain),
                left: left / variance.max(f64::MIN_POSITIVE),
                speed: (0..log.len()).map(|row| log.v_of(robot, row)[joint].abs()).fold(0.0, f64::max),
            }
        };
        let facts: Vec<JointFacts<'_>> = (0..robot.nv()).map(facts).collect();
        notes(&facts, contacts, self.held_out.change)
    }

    /// The payload, with its uncertainty.
    fn payload(&self, link: &str) -> Option<Payload> {
        let held = self.unknowns.held_payload(&self.solution.z)?;
        let first = self.unknowns.payload()?;
        let covariance = |a: usize, b: usize| self.covariance[(first + a, first + b)];
        // The centre is a quotient of two unknowns.
        let com_variance = |axis: usize| {
            let com = held.com[axis];
            let moment = 1 + axis;
            (covariance(moment, moment) - 2.0 * com * covariance(moment, 0) + com * com * covariance(0, 0))
                / held.mass.max(f64::MIN_POSITIVE).powi(2)
        };
        Some(Payload {
            link: link.into(),
            mass: held.mass,
            mass_std: covariance(0, 0).sqrt(),
            com: held.com.into(),
            com_std: std::array::from_fn(|axis| com_variance(axis).max(0.0).sqrt().min(UNKNOWN)),
            moment: held.moment,
        })
    }

    /// The noise, from blocks that were not fitted.
    fn noise(&self, robot: &Robot, log: &Log<'_>, step: f64) -> Result<(NoiseModel, Vec<Tail>)> {
        let mut skipped = vec![false; log.len()];
        for [first, last] in stretches(&self.used) {
            skipped[self.rows[first].index..=self.rows[last].index].fill(true);
        }
        let corrections = &self.held_out.corrections;
        let part = |(block, correction): (usize, &DVector<f64>)| Judged {
            robot: Arc::new(self.corrected(robot, correction)),
            torque: self.torque_model(correction),
            rows: self.log_rows(block, corrections.len(), log.len()),
        };
        let parts: Vec<Judged> = corrections.iter().enumerate().map(part).collect();
        let noise = estimate(robot, log, &parts, &skipped, step)?;
        let friction = self.friction(&self.unknowns.correction(&self.solution.z));
        rest_errors(robot, log, &parts, &skipped, step, &friction.coulomb, noise)
    }

    /// The rows of the log that belong to a block of the fit.
    fn log_rows(&self, block: usize, blocks: usize, rows: usize) -> std::ops::Range<usize> {
        let first = |block: usize| {
            let row = (block * self.rows.len()).div_ceil(blocks);
            self.rows.get(row).map_or(rows, |row| row.index)
        };
        let from = if block == 0 { 0 } else { first(block) };
        from..first(block + 1)
    }

    fn corrected(&self, robot: &Robot, correction: &DVector<f64>) -> Robot {
        let described = robot.inertial_parameters();
        let bodies: Vec<_> = described
            .iter()
            .enumerate()
            .map(|(index, body)| std::array::from_fn(|k| body[k] + correction[10 * index + k]))
            .collect();
        let rotor = |(j, before): (usize, f64)| before + correction[self.unknowns.term_column(j, ARMATURE)];
        let armature: Vec<f64> = armature(robot).into_iter().enumerate().map(rotor).collect();
        robot.with_inertial_parameters(&bodies, &armature)
    }

    fn torque_model(&self, correction: &DVector<f64>) -> TorqueModel {
        let nv = self.joints.weights.len();
        let bias: Vec<f64> = (0..nv).map(|j| correction[self.unknowns.term_column(j, BIAS)]).collect();
        let delays = [self.velocity_delay, correction[self.unknowns.delay_column()]];
        TorqueModel::new(&vec![1.0; nv], &bias, &self.friction(correction), delays)
    }

    fn friction(&self, correction: &DVector<f64>) -> Friction {
        let joints = 0..self.joints.weights.len();
        let term = |term: usize| {
            joints.clone().map(|j| correction[self.unknowns.term_column(j, term)]).collect::<Vec<f64>>()
        };
        Friction {
            coulomb: term(COULOMB),
            viscous: term(VISCOUS),
            reversal: self.joints.friction.iter().map(|k| REVERSALS[*k]).collect(),
        }
    }
}

/// The terms of each row, in the order that [`super::normal`] reads.
fn terms() -> Vec<Term> {
    let mut terms = vec![Term::Bias];
    terms.extend(REVERSALS.map(Term::Coulomb));
    terms.extend([Term::Viscous, Term::Armature, Term::TorqueRate]);
    terms
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
    let columns = 10 * (robot.body_count() - 1) + terms().len();
    let most = (MEMORY / (8 * columns * robot.nv())).max(1);
    // Without gaps.
    let duration = log.len() as f64 * step;
    let spacing = f64::max(1.0 / (ROWS_PER_TIME * gain), duration / most as f64);
    // Not a row later because of rounding.
    Filter { gain, spacing: spacing.max(step) - 0.01 * step, longest_step: super::LONGEST_STEPS * step }
}

/// How large each term of a joint may be: each but the bias alone could be all of its torque.
fn term_units(robot: &Robot, log: &Log<'_>, rows: &[Row]) -> Vec<[f64; TERMS]> {
    let root_mean_square = |value: &dyn Fn(&Row) -> f64| {
        (rows.iter().map(|row| value(row).powi(2)).sum::<f64>() / rows.len() as f64).sqrt()
    };
    let unit = |j: usize| {
        let torque = root_mean_square(&|row| log.tau_of(row.index)[j]).max(SMALLEST_TORQUE);
        let velocity = root_mean_square(&|row| log.v_of(robot, row.index)[j]).max(SMALLEST_VELOCITY);
        let acceleration = root_mean_square(&|row| own_terms(row, j, 0)[ARMATURE]).max(SMALLEST_ACCELERATION);
        [BIAS_SHARE * torque + USUAL_BIAS, torque, torque / velocity, torque / acceleration]
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

/// How much a row of one joint counts: one over its mean square, and over the number of rows that err together.
fn weight(residuals: &[DVector<f64>], used: &[bool], joint: usize) -> f64 {
    let square = mean_square(residuals, used, joint).max(f64::MIN_POSITIVE);
    1.0 / (square * correlated_rows(residuals, joint, square))
}

/// So many rows say as much as one whose error is independent of the others'.
fn correlated_rows(residuals: &[DVector<f64>], joint: usize, square: f64) -> f64 {
    let count = residuals.len();
    let mut sum = 1.0;
    for lag in 1..count / LONGEST_LAG {
        let products = (lag..count).map(|k| residuals[k][joint] * residuals[k - lag][joint]);
        let correlation = products.sum::<f64>() / ((count - lag) as f64 * square);
        if correlation < UNCORRELATED {
            break;
        }
        sum += 2.0 * correlation;
    }
    sum
}
