//! The calibration that a fit stands for.

use std::sync::Arc;

use nalgebra::DVector;

use super::calibration::{armature, body_inertia};
use super::complete_fit::Fit;
use super::contacts::stretches;
use super::folds::mean_square;
use super::friction::{Friction, REVERSALS};
use super::hysteresis::WIDTHS;
use super::judged::Judged;
use super::log::Log;
use super::model_errors::model_errors;
use super::noise::{estimate, RELATIVE};
use super::notes::{notes, JointFacts};
use super::rest_errors::rest_errors;
use super::torque_model::TorqueModel;
use super::uncertainty::TORQUE_SCALE;
use super::unknowns::{ARMATURE, BIAS, COULOMB, HYSTERESIS, VISCOUS};
use super::{Calibration, CalibrationOptions, Payload, Tail};
use crate::error::Result;
use crate::robot::Robot;
use crate::torque::NoiseModel;

/// Coulomb friction is not the same at all speeds: one standard deviation, as a share of it.
const FRICTION_SHAPE: f64 = 0.01;
/// Of a torque as small as friction, hysteresis of another form keeps back from none to six shares, evenly likely, where the
/// fit says three: one standard deviation, in shares.
const FORM: f64 = 1.73;
/// A centre of mass that is less certain is unknown (m).
const UNKNOWN: f64 = 1.0;

impl Fit {
    /// The calibration of the fit of all rows, with its uncertainty and noise.
    pub fn calibration(
        &self,
        robot: &Robot,
        log: &Log<'_>,
        options: &CalibrationOptions,
        step: f64,
    ) -> Result<Calibration> {
        let nv = robot.nv();
        let deviation = |term: usize| {
            let variance = |j| {
                let k = self.unknowns.term(j, term);
                self.uncertainty.stated[(k, k)]
            };
            (0..nv).map(|j| f64::sqrt(variance(j))).collect::<Vec<f64>>()
        };
        let found = self.found(robot, &self.solution.z, options);
        // Friction of another shape than the one fitted changes both coefficients.
        let shape = |j: usize| {
            let error = FRICTION_SHAPE.hypot(FORM * found.hysteresis[j]) * found.friction.coulomb[j];
            let units = &self.unknowns.term_units[j];
            [error, error * units[VISCOUS] / units[COULOMB]]
        };
        let with_shape = |term: usize, which: usize| {
            let deviations = deviation(term).into_iter().enumerate();
            deviations.map(|(j, deviation)| shape(j)[which].hypot(deviation)).collect::<Vec<f64>>()
        };
        let step_of = |rows: [usize; 2]| rows.map(|row| log.time[self.rows[row].index]);
        let contacts: Vec<[f64; 2]> = stretches(&self.used).into_iter().map(step_of).collect();
        let (noise, tails) = self.noise(robot, log, options, step, &found.friction.coulomb)?;
        let left: Vec<f64> =
            (0..nv).map(|j| mean_square(&self.held_out.residuals, &self.used, j).sqrt()).collect();
        // External torques have no weights in them.
        let model_errors = if options.torque_is_external {
            vec![]
        } else {
            model_errors(robot, &self.unknowns, &self.solution.z, &self.uncertainty.elsewhere, &left)
        };
        Ok(Calibration {
            torque_bias_std: deviation(BIAS),
            coulomb_std: with_shape(COULOMB, 0),
            viscous_std: with_shape(VISCOUS, 1),
            hysteresis_std: deviation(HYSTERESIS),
            armature_std: deviation(ARMATURE),
            payload: found.payload.clone().map(|payload| self.with_uncertainty(payload)),
            inertial_change: self.held_out.change,
            noise,
            tails,
            model_errors,
            residual: left,
            false_alarms_per_hour: options.false_alarms_per_hour,
            notes: self.notes(robot, log, &contacts),
            contacts,
            torque_is_external: options.torque_is_external,
            ..found
        })
    }

    /// What some values of the unknowns correct.
    fn found(&self, robot: &Robot, z: &DVector<f64>, options: &CalibrationOptions) -> Calibration {
        let unknowns = &self.unknowns;
        let joints = || 0..robot.nv();
        let term = |term: usize| joints().map(|j| z[unknowns.term(j, term)]).collect::<Vec<f64>>();
        let shapes = &self.joints.shapes;
        let width = |j: usize| shapes[j].hysteresis.map_or(0.0, |k| WIDTHS[k] * self.deviations[j]);
        Calibration {
            torque_bias: term(BIAS),
            friction: Friction {
                coulomb: term(COULOMB),
                viscous: term(VISCOUS),
                reversal: shapes.iter().map(|shape| REVERSALS[shape.friction]).collect(),
            },
            hysteresis: term(HYSTERESIS),
            hysteresis_width: joints().map(width).collect(),
            armature: armature(robot)
                .iter()
                .zip(term(ARMATURE))
                .map(|(before, more)| before + more)
                .collect(),
            bodies: unknowns
                .without_payload(z)
                .iter()
                .enumerate()
                .map(|(k, x)| body_inertia(robot, k, x))
                .collect(),
            payload: self.held(robot, z, options),
            velocity_delay: self.velocity_delay,
            torque_delay: z[unknowns.torque_delay()],
            ..Calibration::of_description(robot)
        }
    }

    /// The payload of some values of the unknowns, without its uncertainty.
    fn held(&self, robot: &Robot, z: &DVector<f64>, options: &CalibrationOptions) -> Option<Payload> {
        let (held, link) = self.unknowns.held_payload(z).zip(options.payload_link)?;
        Some(Payload {
            link: robot[link].name.clone(),
            mass: held.mass,
            mass_std: 0.0,
            com: held.com.into(),
            com_std: [0.0; 3],
            moment: held.moment,
        })
    }

    /// The payload, with its uncertainty, where one is looked for and there is none.
    pub fn nothing_held(&self, robot: &Robot, options: &CalibrationOptions) -> Option<Payload> {
        let held = self.held(robot, &self.solution.z, options).filter(|held| held.mass == 0.0)?;
        Some(self.with_uncertainty(held))
    }

    fn notes(&self, robot: &Robot, log: &Log<'_>, contacts: &[[f64; 2]]) -> Vec<String> {
        let facts = |joint: usize| {
            let uncertain = |term: usize| {
                let k = self.unknowns.term(joint, term);
                self.uncertainty.stated[(k, k)].sqrt() / self.solution.units[k]
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

    fn with_uncertainty(&self, payload: Payload) -> Payload {
        let Some(first) = self.unknowns.payload() else { return payload };
        let covariance = |a: usize, b: usize| self.uncertainty.stated[(first + a, first + b)];
        // The centre is a quotient of two unknowns.
        let com_variance = |axis: usize| {
            let com = payload.com[axis];
            let moment = 1 + axis;
            (covariance(moment, moment) - 2.0 * com * covariance(moment, 0) + com * com * covariance(0, 0))
                / payload.mass.max(f64::MIN_POSITIVE).powi(2)
        };
        Payload {
            mass_std: covariance(0, 0).sqrt(),
            com_std: std::array::from_fn(|axis| com_variance(axis).max(0.0).sqrt().min(UNKNOWN)),
            ..payload
        }
    }

    /// The error in proportion to a contact's own torque: what hysteresis of another form would keep back of a small one, and the
    /// scale of the sensor; the usual where the log shows no hysteresis.
    fn relative(&self, nv: usize) -> Vec<f64> {
        let share = |j: usize| self.solution.z[self.unknowns.term(j, HYSTERESIS)];
        let relative = |j: usize| if share(j) > 0.0 { TORQUE_SCALE.hypot(FORM * share(j)) } else { RELATIVE };
        (0..nv).map(relative).collect()
    }

    /// The noise and its tails, from blocks that were not fitted.
    fn noise(
        &self,
        robot: &Robot,
        log: &Log<'_>,
        options: &CalibrationOptions,
        step: f64,
        coulomb: &[f64],
    ) -> Result<(NoiseModel, Vec<Tail>)> {
        let mut skipped = vec![false; log.len()];
        for [first, last] in stretches(&self.used) {
            skipped[self.rows[first].index..=self.rows[last].index].fill(true);
        }
        let solutions = &self.held_out.solutions;
        let part = |(block, z): (usize, &DVector<f64>)| {
            let found = self.found(robot, z, options);
            Ok(Judged {
                robot: if options.torque_is_external { None } else { Some(found.corrected(robot)?.into()) },
                torque: TorqueModel::new(&found),
                rows: self.log_rows(block, solutions.len(), log.len()),
            })
        };
        let parts = solutions.iter().enumerate().map(part).collect::<Result<Vec<Judged>>>()?;
        let shared = Arc::new(robot.clone());
        let noise = estimate(&shared, log, &parts, &skipped, step)?;
        // No observer of ours differentiates velocities into an external torque.
        let velocity = if options.torque_is_external { vec![0.0] } else { noise.velocity };
        let noise = NoiseModel { velocity, relative: self.relative(robot.nv()), ..noise };
        rest_errors(&shared, log, &parts, &skipped, step, coulomb, noise)
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
}
