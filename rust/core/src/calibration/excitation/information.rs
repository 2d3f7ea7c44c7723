//! What a move teaches of the parameters that calibration estimates.

use nalgebra::{DMatrix, DVector};

use super::limits::Limits;
use super::motion::{configuration, Move};
use crate::math::random::Stream;
use crate::robot::{Kinematics, MomentumRegressor, Robot};

/// Parameters of a body.
const INERTIAL: usize = 10;
/// Parameters of a joint: bias, Coulomb and viscous friction, rotor inertia.
const OF_JOINT: usize = 4;
/// Time between the rows of a move (s).
const SPACING: f64 = 0.1;
/// For the derivative of the momentum by time (s).
const STEP: f64 = 1e-4;
/// Velocity at which Coulomb friction has 76 % of its torque (rad/s, m/s).
const FRICTION_VELOCITY: f64 = 0.05;
/// Prior standard deviation of the inertial parameters, as a share of the description's.
const INERTIAL_PRIOR: f64 = 0.3;
/// Of bias, friction and the torque of the rotor at the largest acceleration, as a share of the joint's torque.
const JOINT_PRIOR: f64 = 0.2;
/// Standard deviation of the errors of a row, as a share of the joint's torque, and at least (Nm, N).
const NOISE: f64 = 0.02;
const LEAST_NOISE: f64 = 0.05;
/// Least extent of a body (m), and least share of the robot's mass, that its parameters are measured by.
const LEAST_EXTENT: f64 = 0.02;
const LEAST_MASS: f64 = 0.005;
/// Random poses that show the torque of the weights.
const PROBES: u64 = 40;

/// The information of the moves taken so far, in units of the prior, and space to add to it.
#[derive(Debug, Clone)]
pub(super) struct Information {
    parameters: DVector<f64>,
    armature: Vec<f64>,
    /// Prior standard deviations, which are the units of all columns.
    scale: DVector<f64>,
    noise: Vec<f64>,
    effort: Vec<f64>,
    matrix: DMatrix<f64>,
    log_det: f64,
    regressor: MomentumRegressor,
    kinematics: Kinematics,
    q: Vec<f64>,
    v: Vec<f64>,
}

/// What a move adds.
#[derive(Debug, Clone)]
pub(super) struct Gain {
    matrix: DMatrix<f64>,
    log_det: f64,
    /// Of the logarithm of the determinant, per second.
    pub rate: f64,
}

impl Information {
    pub fn new(robot: &Robot, limits: &Limits, stream: Stream) -> Self {
        let parameters = DVector::from_vec(robot.inertial_parameters().concat());
        let count = parameters.len() + OF_JOINT * robot.nv();
        let mut information = Information {
            parameters,
            armature: robot.bodies[1..].iter().map(|body| body.armature).collect(),
            scale: DVector::repeat(count, 1.0),
            noise: vec![],
            effort: vec![],
            matrix: DMatrix::identity(count, count),
            log_det: 0.0,
            regressor: MomentumRegressor::new(robot),
            kinematics: Kinematics::new(robot),
            q: vec![],
            v: vec![0.0; robot.nv()],
        };
        let weights = information.largest_weights(robot, limits, stream);
        let torques: Vec<f64> = weights.iter().map(|weight| weight.max(LEAST_NOISE / NOISE)).collect();
        information.noise = torques.iter().map(|torque| NOISE * torque).collect();
        // A limit below the arm's own weight is none that its author meant.
        let meant = limits.effort.iter().zip(&weights);
        information.effort =
            meant.map(|(effort, weight)| if weight < effort { *effort } else { f64::INFINITY }).collect();
        information.set_scale(robot, limits, &torques);
        information
    }

    /// Number of parameters.
    pub fn parameters(&self) -> usize {
        self.scale.len()
    }

    /// What a move adds; none where it needs more effort than the joints have.
    pub fn gain(&mut self, robot: &Robot, part: &Move) -> Option<Gain> {
        let (nv, rows) = (robot.nv(), ((part.duration / SPACING) as usize).max(1));
        let mut columns = DMatrix::zeros(self.scale.len(), nv * rows);
        for row in 0..rows {
            let time = part.duration * (row as f64 + 0.5) / rows as f64;
            if !self.write_row(robot, part, time, &mut columns, nv * row) {
                return None;
            }
        }
        let mut matrix = self.matrix.clone();
        matrix.gemm(1.0, &columns, &columns.transpose(), 1.0);
        let log_det = log_det(&matrix)?;
        Some(Gain { rate: (log_det - self.log_det) / part.duration, matrix, log_det })
    }

    /// Counts a move as taken.
    pub fn add(&mut self, gain: Gain) {
        (self.matrix, self.log_det) = (gain.matrix, gain.log_det);
    }

    /// Sum of squares of the torques of weights at some poses, of joints that move and in units of their noise.
    pub fn load(&mut self, robot: &Robot, positions: &[f64], moves: &[bool]) -> f64 {
        let weights = self.weights(robot, positions);
        let joints = weights.iter().zip(&self.noise).zip(moves).filter(|(_, moves)| **moves);
        joints.map(|((weight, noise), _)| (weight / noise).powi(2)).sum()
    }

    /// One column a joint from `first` on: the derivatives of its torque, in units of prior and noise. False where the torque is
    /// more than its effort.
    fn write_row(
        &mut self,
        robot: &Robot,
        part: &Move,
        time: f64,
        columns: &mut DMatrix<f64>,
        first: usize,
    ) -> bool {
        let nv = robot.nv();
        let inertial = self.parameters.len();
        let after = self.momentum(robot, part, time + STEP);
        let before = self.momentum(robot, part, time - STEP);
        self.momentum(robot, part, time);
        let mut within = true;
        for joint in 0..nv {
            let [_, v, a] = part.joint(joint, time);
            let mut torque = self.armature[joint] * a;
            let mut column = columns.column_mut(first + joint);
            for parameter in 0..inertial {
                let slope = (after[(joint, parameter)] - before[(joint, parameter)]) / (2.0 * STEP);
                let value = slope - self.regressor.rate[(joint, parameter)];
                torque += value * self.parameters[parameter];
                column[parameter] = value * self.scale[parameter] / self.noise[joint];
            }
            for (place, value) in [1.0, (v / FRICTION_VELOCITY).tanh(), v, a].into_iter().enumerate() {
                let parameter = inertial + OF_JOINT * joint + place;
                column[parameter] = value * self.scale[parameter] / self.noise[joint];
            }
            within &= torque.abs() <= self.effort[joint];
        }
        within
    }

    fn momentum(&mut self, robot: &Robot, part: &Move, time: f64) -> DMatrix<f64> {
        let jets: Vec<[f64; 3]> = (0..robot.nv()).map(|joint| part.joint(joint, time)).collect();
        configuration(robot, jets.iter().map(|jet| jet[0]), &mut self.q);
        for (v, jet) in self.v.iter_mut().zip(&jets) {
            *v = jet[1];
        }
        self.kinematics.set_configuration(robot, &self.q);
        self.kinematics.set_velocity(robot, &self.v);
        self.regressor.evaluate(robot, &self.kinematics);
        self.regressor.momentum.clone()
    }

    /// Torques of the weights (Nm, N).
    fn weights(&mut self, robot: &Robot, positions: &[f64]) -> DVector<f64> {
        configuration(robot, positions.iter().copied(), &mut self.q);
        self.v.fill(0.0);
        self.kinematics.set_configuration(robot, &self.q);
        self.kinematics.set_velocity(robot, &self.v);
        self.regressor.evaluate(robot, &self.kinematics);
        -(&self.regressor.rate * &self.parameters)
    }

    fn largest_weights(&mut self, robot: &Robot, limits: &Limits, stream: Stream) -> Vec<f64> {
        let mut largest = vec![0.0_f64; robot.nv()];
        for probe in 0..PROBES {
            let positions = limits.random(&stream.fork(probe));
            for (largest, weight) in largest.iter_mut().zip(&self.weights(robot, &positions)) {
                *largest = largest.max(weight.abs());
            }
        }
        largest
    }

    fn set_scale(&mut self, robot: &Robot, limits: &Limits, torques: &[f64]) {
        let least = LEAST_MASS * robot.mass();
        for (index, body) in robot.bodies[1..].iter().enumerate() {
            let mass = body.mass.max(least);
            let gyration =
                if body.mass > 0.0 { (0.5 * body.inertia.trace() / body.mass).sqrt() } else { 0.0 };
            let extent = body.com.norm().max(gyration).max(LEAST_EXTENT);
            for parameter in 0..INERTIAL {
                let power = [0, 1, 1, 1, 2, 2, 2, 2, 2, 2][parameter];
                self.scale[INERTIAL * index + parameter] = INERTIAL_PRIOR * mass * extent.powi(power);
            }
        }
        for (joint, torque) in torques.iter().enumerate() {
            let prior = JOINT_PRIOR * torque;
            let first = self.parameters.len() + OF_JOINT * joint;
            self.scale[first] = prior;
            self.scale[first + 1] = prior;
            self.scale[first + 2] = prior / limits.velocity[joint];
            self.scale[first + 3] = prior / limits.acceleration[joint];
        }
    }
}

fn log_det(matrix: &DMatrix<f64>) -> Option<f64> {
    let factor = matrix.clone().cholesky()?;
    Some(2.0 * factor.l_dirty().diagonal().iter().map(|x| x.ln()).sum::<f64>())
}
