//! What is not known of a payload that has just been set: whether the robot bears its weight yet, and how much it is.

use nalgebra::{Matrix3, Vector3};

use crate::robot::jacobian::for_each_column;
use crate::robot::{Kinematics, Robot};

/// A grasp is announced so long before the weight is lifted, or put down so long before the hand lets go (s).
const SETTLING: f64 = 0.5;
/// Masses of objects are known to this share.
const MASS_ERROR: f64 = 0.05;
/// Scales differ from joint to joint, and gears keep 3 to 8 % of a change of their load: each joint's share of the weight that
/// the others do not tell.
const JOINT_ERROR: f64 = 0.1;
/// Afterwards it becomes a part of the slow errors, which are followed over this time (s).
const LEARNT: f64 = 3.0;

/// What it moves with, along each axis (m/s^2): arms do so in quick moves.
const ACCELERATION: f64 = 3.0;
/// That one and the weight.
const DIRECTIONS: usize = 4;

/// A change of what the robot carries: mass (kg), and its first moment about the body's origin (kg m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Load {
    pub body: usize,
    pub mass: f64,
    pub moment: Vector3<f64>,
}

/// The uncertain part of the robot's weight.
#[derive(Debug, Clone)]
pub(crate) struct PayloadErrors {
    /// What was taken away and what was added.
    loads: [Option<Load>; 2],
    /// Since the change (s).
    age: f64,
    /// Torques of one standard deviation of the weight, and of the inertial force along each axis, `(nv,)` each.
    deviations: Vec<f64>,
    /// Of each joint alone, `(nv,)`.
    of_joints: Vec<f64>,
}

impl PayloadErrors {
    /// Of a robot with `nv` velocity variables that carries what it is said to.
    pub fn new(nv: usize) -> Self {
        PayloadErrors {
            loads: [None; 2],
            age: f64::INFINITY,
            deviations: vec![0.0; DIRECTIONS * nv],
            of_joints: vec![0.0; nv],
        }
    }

    /// The load changes now: this is taken away and that added.
    pub fn change(&mut self, loads: [Option<Load>; 2]) {
        (self.loads, self.age) = (loads, 0.0);
    }

    /// A step of `dt` (s).
    #[inline]
    pub fn advance(&mut self, robot: &Robot, kinematics: &Kinematics, dt: f64) {
        if !self.any() {
            return;
        }
        self.age += dt;
        let share = if self.settling() { 1.0 } else { MASS_ERROR * (-(self.age - SETTLING) / LEARNT).exp() };
        self.deviations.fill(0.0);
        if share < SMALLEST {
            self.reset();
            return;
        }
        let nv = self.deviations.len() / DIRECTIONS;
        let acceleration = Matrix3::from_diagonal_element(ACCELERATION);
        for (load, sign) in self.loads.iter().zip([-share, share]) {
            let Some(Load { body, mass, moment }) = load else { continue };
            let state = &kinematics.bodies[*body];
            let first_moment = state.position * *mass + state.rotation * moment;
            let directions: [Vector3<f64>; DIRECTIONS] = std::array::from_fn(|direction| match direction {
                0 => robot.gravity,
                axis => acceleration.column(axis - 1).into(),
            });
            let deviations = &mut self.deviations;
            for_each_column(robot, kinematics, *body, &Vector3::zeros(), |k, column| {
                let (linear, angular) = (column.fixed_rows::<3>(0), column.fixed_rows::<3>(3));
                for (index, direction) in directions.iter().enumerate() {
                    let power = linear.dot(direction) * mass + angular.dot(&first_moment.cross(direction));
                    deviations[index * nv + k] += sign * power;
                }
            });
        }
        let whole = if self.settling() { 1.0 } else { MASS_ERROR };
        for (of_joint, weight) in self.of_joints.iter_mut().zip(&self.deviations) {
            *of_joint = JOINT_ERROR * weight / whole;
        }
    }

    /// Whether the change may still be to come, or have been a moment ago.
    pub fn settling(&self) -> bool {
        self.age < SETTLING
    }

    /// Whether anything is uncertain.
    pub fn any(&self) -> bool {
        self.age.is_finite()
    }

    /// Adds what is uncertain to row `i` of a covariance, up to its last column.
    #[inline]
    pub fn add_to_row(&self, i: usize, row: &mut [f64]) {
        let nv = self.deviations.len() / DIRECTIONS;
        row[i] += self.of_joints[i] * self.of_joints[i];
        for deviation in self.deviations.chunks_exact(nv) {
            row.iter_mut().zip(deviation).for_each(|(value, other)| *value += deviation[i] * other);
        }
    }

    /// Forgets the change.
    pub fn reset(&mut self) {
        self.age = f64::INFINITY;
        self.deviations.fill(0.0);
        self.of_joints.fill(0.0);
    }
}

/// A smaller share of a weight does not matter.
const SMALLEST: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_whole_weight_is_uncertain_first_and_a_part_of_it_later() {
        let robot = Robot::example_arm();
        let q = [0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.0];
        let mut kinematics = Kinematics::new(&robot);
        kinematics.set_configuration(&robot, &q);
        let (link, com, mass) = (robot.link("link_7").expect("a link"), Vector3::new(0.02, 0.0, 0.1), 2.0);
        let loaded = robot.with_payload(link, mass, com, nalgebra::Matrix3::zeros()).expect("a payload");
        let rest = [0.0; 7];
        let torque = |robot: &Robot| robot.inverse_dynamics(&q, &rest, &rest).expect("a pose");
        let expected: Vec<f64> = torque(&loaded).iter().zip(torque(&robot)).map(|(a, b)| b - a).collect();

        let mut errors = PayloadErrors::new(7);
        let inertial =
            |errors: &PayloadErrors| errors.deviations[7..].iter().map(|x| x * x).sum::<f64>().sqrt();
        errors.advance(&robot, &kinematics, 1e-3);
        assert!(!errors.any() && errors.deviations == [0.0; 28]);
        let placement = robot[link].placement;
        let moment = placement.transform_point(&com) * mass;
        errors.change([None, Some(Load { body: robot[link].body, mass, moment })]);
        errors.advance(&robot, &kinematics, 1e-3);
        assert!(errors.settling());
        for (found, expected) in errors.deviations.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        let mut row = [1.0; 3];
        errors.add_to_row(2, &mut row);
        assert!(row[2] > 1.0 + expected[2] * expected[2] && inertial(&errors) > 1.0);
        errors.advance(&robot, &kinematics, SETTLING);
        assert!(!errors.settling());
        assert!((errors.deviations[1] / expected[1] - MASS_ERROR).abs() < 1e-3);
        errors.advance(&robot, &kinematics, 20.0 * LEARNT);
        assert!(!errors.any() && errors.deviations == [0.0; 28]);
    }
}
