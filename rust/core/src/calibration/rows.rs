//! The external torque of a log, and what errors of the robot's model would add to it, low-passed alike.
//!
//! The observer's output without contact is linear in the errors of the model (algorithm D2): every column here goes through
//! the same filter, so that no acceleration is needed.

use nalgebra::{DMatrix, DVector};

use super::friction::Reversal;
use super::hysteresis::Stops;
use super::log::Log;
use super::rate::Rate;
use crate::robot::configuration::spread_torque;
use crate::robot::{Kinematics, MomentumPass, MomentumRegressor, Robot};

/// Terms of each joint's own torque beside the inertial ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Term {
    /// A constant torque.
    Bias,
    /// Coulomb friction of one newton metre.
    Coulomb(Reversal),
    /// `v`.
    Viscous,
    /// `dv/dt`.
    Armature,
    /// The measured torque.
    Torque,
    /// Its rate, as [`Rate`] sees it.
    TorqueRate,
    /// What hysteresis keeps back of it for a share of one, with this first width in standard deviations of the torque.
    Hysteresis(f64),
}

/// One instant of a log.
#[derive(Debug, Clone)]
pub(crate) struct Row {
    /// Index of the log's row.
    pub index: usize,
    /// Measured torque less the torque of the model, `(nv,)` (Nm).
    pub unexplained: DVector<f64>,
    /// Torque for one of each inertial parameter, `(nv, 10 bodies)`.
    pub inertial: DMatrix<f64>,
    /// Torque for one of each term of a joint itself, `(nv, terms)`.
    pub terms: DMatrix<f64>,
}

/// How a log becomes rows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Filter {
    /// Of the low-pass, as of an observer (1/s).
    pub gain: f64,
    /// Between rows (s).
    pub spacing: f64,
    /// A longer step starts the filters anew (s).
    pub longest_step: f64,
}

/// So many time constants after a start the filters have forgotten that they started at zero.
const SETTLED: f64 = 3.0;

/// The rows of a checked log.
pub(crate) fn rows(robot: &Robot, log: &Log<'_>, filter: &Filter, terms: &[Term]) -> Vec<Row> {
    let nv = robot.nv();
    let mut kinematics = Kinematics::new(robot);
    let mut pass = MomentumPass::new(robot);
    let mut regressor = MomentumRegressor::new(robot);
    let mut now = Instant::new(robot);
    let mut before = now.clone();
    let mut state = Filtered::new(robot, terms, &torque_deviations(robot, log));
    let mut rows = vec![];
    let (mut started, mut last) = (f64::NAN, f64::NEG_INFINITY);
    let (mut tau, mut rate) = (vec![0.0; nv], Rate::new(nv));
    for index in 0..log.len() {
        let v = log.v_of(robot, index);
        kinematics.set_configuration(robot, log.q_of(robot, index));
        kinematics.set_velocity(robot, v);
        std::mem::swap(&mut now, &mut before);
        pass.evaluate(robot, &kinematics, v, now.momentum.as_mut_slice(), now.rate.as_mut_slice());
        regressor.evaluate(robot, &kinematics);
        now.momentum_columns.copy_from(&regressor.momentum);
        now.rate_columns.copy_from(&regressor.rate);
        spread_torque(log.tau_of(index), &mut tau);
        now.tau.copy_from_slice(&tau);
        let last_step = if index == 0 { 0.0 } else { log.time[index] - log.time[index - 1] };
        rate.advance(last_step, &mut tau);
        now.torque_rate.copy_from_slice(&tau);
        now.v.copy_from_slice(v);
        let time = log.time[index];
        let step = if index == 0 { f64::INFINITY } else { time - log.time[index - 1] };
        if step > filter.longest_step {
            state.restart();
            rate.reset();
            started = time;
            continue;
        }
        state.advance(&before, &now, step, filter);
        if time - started >= SETTLED / filter.gain && time - last >= filter.spacing {
            last = time;
            rows.push(state.row(index));
        }
    }
    rows
}

/// The standard deviation of each measured torque, `(nv,)` (Nm; N).
pub(crate) fn torque_deviations(robot: &Robot, log: &Log<'_>) -> Vec<f64> {
    let mut tau = vec![0.0; robot.nv()];
    let count = log.len().max(1) as f64;
    let (mut sums, mut squares) = (vec![0.0; robot.nv()], vec![0.0; robot.nv()]);
    for row in 0..log.len() {
        spread_torque(log.tau_of(row), &mut tau);
        for (j, tau) in tau.iter().enumerate() {
            sums[j] += tau;
            squares[j] += tau * tau;
        }
    }
    let deviation = |(sum, square): (&f64, &f64)| (square / count - (sum / count).powi(2)).max(0.0).sqrt();
    sums.iter().zip(&squares).map(deviation).collect()
}

/// What is filtered, at one instant.
#[derive(Clone)]
struct Instant {
    momentum: DVector<f64>,
    rate: DVector<f64>,
    momentum_columns: DMatrix<f64>,
    rate_columns: DMatrix<f64>,
    v: DVector<f64>,
    tau: DVector<f64>,
    torque_rate: DVector<f64>,
}

impl Instant {
    fn new(robot: &Robot) -> Self {
        let vector = DVector::zeros(robot.nv());
        let columns = MomentumRegressor::new(robot);
        Instant {
            momentum: vector.clone(),
            rate: vector.clone(),
            momentum_columns: columns.momentum,
            rate_columns: columns.rate,
            v: vector.clone(),
            tau: vector.clone(),
            torque_rate: vector,
        }
    }
}

/// The filters' outputs.
struct Filtered {
    model: DVector<f64>,
    torque: DVector<f64>,
    inertial: DMatrix<f64>,
    names: Vec<Term>,
    /// Of Coulomb friction, at the last instant.
    shares: DMatrix<f64>,
    /// Of hysteresis.
    stops: DMatrix<Stops>,
    terms: DMatrix<f64>,
}

impl Filtered {
    fn new(robot: &Robot, terms: &[Term], deviations: &[f64]) -> Self {
        let width = |term: &Term| if let Term::Hysteresis(width) = term { *width } else { 1.0 };
        let stops = terms.iter().flat_map(|term| deviations.iter().map(move |d| Stops::new(d * width(term))));
        Filtered {
            model: DVector::zeros(robot.nv()),
            torque: DVector::zeros(robot.nv()),
            inertial: MomentumRegressor::new(robot).momentum,
            names: terms.to_vec(),
            shares: DMatrix::zeros(robot.nv(), terms.len()),
            stops: DMatrix::from_iterator(robot.nv(), terms.len(), stops),
            terms: DMatrix::zeros(robot.nv(), terms.len()),
        }
    }

    fn restart(&mut self) {
        self.model.fill(0.0);
        self.torque.fill(0.0);
        self.inertial.fill(0.0);
        self.terms.fill(0.0);
        self.shares.fill(0.0);
        self.stops.iter_mut().for_each(Stops::reset);
    }

    /// `y' = gain (dp/dt - rate - y)`, exactly over a step on which `dp/dt - rate` is constant, as the observer does.
    fn advance(&mut self, before: &Instant, now: &Instant, step: f64, filter: &Filter) {
        let kept = (-filter.gain * step).exp();
        let new = 1.0 - kept;
        let (rise, mean) = (new / step, 0.5 * new);
        self.torque *= kept;
        self.torque += (&now.tau + &before.tau) * mean;
        self.model *= kept;
        self.model += (&now.momentum - &before.momentum) * rise - (&now.rate + &before.rate) * mean;
        let columns = self.inertial.iter_mut();
        let momenta = now.momentum_columns.iter().zip(&before.momentum_columns);
        let rates = now.rate_columns.iter().zip(&before.rate_columns);
        for ((y, (p, p_before)), (r, r_before)) in columns.zip(momenta).zip(rates) {
            *y = kept * *y + (p - p_before) * rise - (r + r_before) * mean;
        }
        for (column, term) in self.names.iter().enumerate() {
            for k in 0..now.v.len() {
                let (v, tau) = ([before.v[k], now.v[k]], [before.tau[k], now.tau[k]]);
                let input = match term {
                    Term::Bias => new,
                    Term::Coulomb(reversal) => {
                        let share = &mut self.shares[(k, column)];
                        let last = *share;
                        *share = reversal.share(last, v[1], step);
                        mean * (last + *share)
                    }
                    Term::Viscous => mean * (v[0] + v[1]),
                    Term::Armature => rise * (v[1] - v[0]),
                    Term::Torque => mean * (tau[0] + tau[1]),
                    Term::TorqueRate => mean * (before.torque_rate[k] + now.torque_rate[k]),
                    Term::Hysteresis(_) => {
                        let stops = &mut self.stops[(k, column)];
                        let last = stops.sum();
                        -mean * (last + stops.advance(now.tau[k]))
                    }
                };
                let y = &mut self.terms[(k, column)];
                *y = kept * *y + input;
            }
        }
    }

    fn row(&self, index: usize) -> Row {
        Row {
            index,
            unexplained: &self.torque - &self.model,
            inertial: self.inertial.clone(),
            terms: self.terms.clone(),
        }
    }
}
