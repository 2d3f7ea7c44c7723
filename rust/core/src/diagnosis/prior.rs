//! Errors that a normal arm's model and sensors have: as much is taken to be there before anything is called a fault.

use nalgebra::{SMatrix, Vector3};

use super::evidence::Evidence;
use super::terms::OWN;
use crate::calibration::rows::Term;
use crate::robot::inertial_parameters::{of_body, of_inertia, to_inertia};
use crate::robot::{Kinematics, Robot, PARAMETERS};

/// Covariance of the inertial parameters of a body.
pub(super) type Spread = SMatrix<f64, PARAMETERS, PARAMETERS>;

/// Standard deviations of the published inertial parameters of a body: share of the mass, ...
const MASS: f64 = 0.04;
/// ... of the body's size for each coordinate of its centre, ...
const CENTRE: f64 = 0.06;
/// ... and of mass times square of the size for its moments of inertia.
const MOMENTS: f64 = 0.1;

/// Bodies are at least so large (m), for centres of small wrists are as uncertain as others.
const SMALLEST_SIZE: f64 = 0.03;

/// Share of a joint's reach of torque, and torque that every sensor may be off by (Nm): bias and friction.
const NORMAL_SHARE: f64 = 0.004;
const NORMAL_TORQUE: f64 = 0.05;
/// ... but at most (Nm).
const LARGEST_NORMAL_TORQUE: f64 = 0.4;

/// Rotor inertia that a normal description lacks, as a share of the inertia that the joint moves.
const NORMAL_ROTOR: f64 = 0.03;

/// Sizes that faults have, as shares of the same references.
const FAULTY_SHARE: f64 = 0.05;
const FAULTY_ROTOR: f64 = 1.0;

/// Standard deviation of gravity along each axis where it may be wrong (m/s^2).
const GRAVITY: f64 = 10.0;

/// Prior covariances of all unknowns.
#[derive(Debug, Clone)]
pub(super) struct Prior {
    pub bodies: Vec<Spread>,
    /// Standard deviations of each joint's own terms, in the order of [`OWN`].
    pub own: Vec<[f64; OWN.len()]>,
    /// Whether gravity is unknown, and its standard deviation (m/s^2).
    pub gravity: Option<f64>,
}

/// What sizes are compared with.
#[derive(Debug, Clone)]
pub(super) struct Reference {
    /// Torque that a joint is made for (Nm; N).
    pub effort: Vec<f64>,
    /// Inertia that a joint moves (kg m^2; kg).
    pub inertia: Vec<f64>,
    /// Mass of all that moves (kg).
    pub mass: f64,
    /// From the base to the last body (m).
    pub reach: f64,
}

impl Reference {
    pub fn new(robot: &Robot, evidence: &Evidence, poses: &[Vec<f64>]) -> Reference {
        /// Effort limits above this are placeholders (Nm).
        const PLACEHOLDER: f64 = 5_000.0;
        /// A joint without a limit is made for so many times the torque of the log.
        const MARGIN: f64 = 4.0;
        let limits = robot.effort_limits();
        let effort = (0..evidence.nv).map(|k| {
            let seen = MARGIN * evidence.square(k, evidence.parts.model()).sqrt();
            if limits[k] > 0.0 && limits[k] < PLACEHOLDER {
                limits[k]
            } else {
                seen.max(1.0)
            }
        });
        let mut inertia = vec![0.0; evidence.nv];
        for q in poses {
            if let Ok(matrix) = robot.mass_matrix(q) {
                inertia
                    .iter_mut()
                    .enumerate()
                    .for_each(|(k, sum)| *sum += matrix[(k, k)] / poses.len() as f64);
            }
        }
        let mut kinematics = Kinematics::new(robot);
        kinematics.set_configuration(robot, &robot.neutral());
        let length = |body: usize| -> f64 {
            robot.chain(body).iter().map(|b| robot.bodies[*b].placement.translation.norm()).sum()
        };
        let reach = (1..robot.body_count()).map(length).fold(0.1, f64::max);
        Reference { effort: effort.collect(), inertia, mass: robot.mass(), reach }
    }
}

impl Prior {
    /// Of a normal arm.
    pub fn normal(robot: &Robot, reference: &Reference) -> Prior {
        let mean = reference.mass / (robot.body_count() - 1).max(1) as f64;
        let own = |(effort, inertia): (&f64, &f64)| {
            let torque = (NORMAL_SHARE * effort + NORMAL_TORQUE).min(LARGEST_NORMAL_TORQUE);
            [torque, torque, torque, NORMAL_ROTOR * inertia + 1e-4]
        };
        Prior {
            bodies: robot.bodies[1..].iter().map(|body| normal_spread(&of_body(body), mean)).collect(),
            own: reference.effort.iter().zip(&reference.inertia).map(own).collect(),
            gravity: None,
        }
    }

    /// With a term of a joint's own as large as a fault may be.
    pub fn widened(mut self, reference: &Reference, joint: usize, terms: &[Term]) -> Prior {
        for (sd, term) in self.own[joint].iter_mut().zip(OWN) {
            if terms.contains(&term) {
                let fault = match term {
                    Term::Armature => FAULTY_ROTOR * reference.inertia[joint],
                    _ => (FAULTY_SHARE * reference.effort[joint]).max(1.0),
                };
                *sd = sd.hypot(fault);
            }
        }
        self
    }

    /// With another body fixed to a body.
    pub fn loaded(mut self, reference: &Reference, body: usize) -> Prior {
        /// Of the robot's own mass: what arms carry.
        const LOAD: f64 = 0.15;
        /// Its distance from the body's origin, and its size, of the robot's reach.
        const DISTANCE: f64 = 0.12;
        let mass = LOAD * reference.mass;
        let lever = DISTANCE * reference.reach;
        let mut spread = Spread::zeros();
        for k in 0..PARAMETERS {
            let sd = match k {
                0 => mass,
                1..=3 => mass * lever,
                _ => mass * lever * lever,
            };
            spread[(k, k)] = sd * sd;
        }
        self.bodies[body - 1] += spread;
        self
    }

    /// With gravity unknown.
    pub fn any_gravity(mut self) -> Prior {
        self.gravity = Some(GRAVITY);
        self
    }
}

/// Errors of mass, centre and moments of a body as errors of its parameters.
fn normal_spread(parameters: &[f64; PARAMETERS], mean_mass: f64) -> Spread {
    let (mass, com, inertia) = to_inertia(parameters);
    let size = if mass > 0.0 { (inertia.trace().max(0.0) / (2.0 * mass)).sqrt() } else { 0.0 };
    let size = size.max(SMALLEST_SIZE);
    // A frame without mass may have been given none.
    let mass = mass.max(0.02 * mean_mass);
    let at = of_inertia(mass, &com, &inertia);
    let mut columns = vec![at.map(|x| x * MASS)];
    let step = 1e-6 * size;
    for axis in 0..3 {
        let mut moved: Vector3<f64> = com;
        moved[axis] += step;
        let there = of_inertia(mass, &moved, &inertia);
        let mut column = [0.0; PARAMETERS];
        for (out, (a, b)) in column.iter_mut().zip(there.iter().zip(&at)) {
            *out = (a - b) / step * (CENTRE * size);
        }
        columns.push(column);
    }
    for k in 4..PARAMETERS {
        let mut column = [0.0; PARAMETERS];
        column[k] = MOMENTS * mass * size * size;
        columns.push(column);
    }
    let mut spread = Spread::zeros();
    for column in columns {
        let column = nalgebra::SVector::<f64, PARAMETERS>::from(column);
        spread += column * column.transpose();
    }
    spread
}
