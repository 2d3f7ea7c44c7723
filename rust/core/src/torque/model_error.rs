//! How the model of a robot may differ from what a calibration found.

use nalgebra::Vector3;

use crate::robot::jacobian::for_each_column;
use crate::robot::{Kinematics, Robot};

/// A way in which weights, biases and viscous friction may all be wrong together, as one standard deviation. Several are
/// independent of each other.
///
/// ```
/// use contactsense::calibration::ModelError;
///
/// // The last of two bodies may be 50 g heavier, and the second joint's torque 0.1 Nm off.
/// let error = ModelError {
///     bodies: vec![[0.0; 4], [0.05, 0.0, 0.0, 0.01]],
///     bias: vec![0.0, 0.1],
///     viscous: vec![0.0; 2],
/// };
/// assert_eq!(error.bodies.len(), error.bias.len());
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct ModelError {
    /// By joint, of all that moves with it: mass (kg) and first moment about the joint's origin in the body's axes (kg m).
    pub bodies: Vec<[f64; 4]>,
    /// By velocity variable (Nm; N for sliding joints).
    pub bias: Vec<f64>,
    /// By velocity variable (Nm s/rad; N s/m).
    pub viscous: Vec<f64>,
}

impl ModelError {
    /// By joint, where each has one velocity variable: mass, the three first moments, bias, viscous friction.
    pub fn by_joint(&self) -> impl Iterator<Item = [f64; 6]> + '_ {
        let of_joints = self.bodies.iter().zip(&self.bias).zip(&self.viscous);
        of_joints.map(|((&[mass, x, y, z], &bias), &viscous)| [mass, x, y, z, bias, viscous])
    }

    /// What it does to the external torque at a pose and velocities, `(nv,)` (Nm, N).
    pub(crate) fn torque(&self, robot: &Robot, kinematics: &Kinematics, v: &[f64], torque: &mut [f64]) {
        let of_joints = self.bias.iter().zip(&self.viscous).zip(v);
        torque
            .iter_mut()
            .zip(of_joints)
            .for_each(|(torque, ((bias, viscous), v))| *torque = bias + viscous * v);
        for (index, &[mass, x, y, z]) in self.bodies.iter().enumerate() {
            let body = index + 1;
            let state = &kinematics.bodies[body];
            let moment = state.position * mass + state.rotation * Vector3::new(x, y, z);
            // What holds it up.
            let force = robot.gravity * -mass;
            let couple = robot.gravity.cross(&moment);
            for_each_column(robot, kinematics, body, &Vector3::zeros(), |k, column| {
                let (linear, angular) = (column.fixed_rows::<3>(0), column.fixed_rows::<3>(3));
                torque[k] += linear.dot(&force) + angular.dot(&couple);
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heavier_body_is_what_a_payload_does() {
        let robot = Robot::example_arm();
        let (q, v) = ([0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.0], [0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0]);
        let mut kinematics = Kinematics::new(&robot);
        kinematics.set_configuration(&robot, &q);
        let (link, com, mass) = (robot.link("link_7").expect("a link"), Vector3::new(0.02, 0.0, 0.1), 2.0);
        let loaded = robot.with_payload(link, mass, com, nalgebra::Matrix3::zeros()).expect("a payload");
        let moment = robot[link].placement.transform_point(&com) * mass;
        let mut error = ModelError { bodies: vec![[0.0; 4]; 7], bias: vec![0.0; 7], viscous: vec![0.0; 7] };
        error.bodies[robot[link].body - 1] = [mass, moment.x, moment.y, moment.z];
        (error.bias[1], error.viscous[2]) = (0.5, 0.1);
        let mut found = [0.0; 7];
        error.torque(&robot, &kinematics, &v, &mut found);
        let rest = [0.0; 7];
        let torque = |robot: &Robot| robot.inverse_dynamics(&q, &rest, &rest).expect("a pose");
        let mut expected: Vec<f64> =
            torque(&loaded).iter().zip(torque(&robot)).map(|(with, without)| with - without).collect();
        expected[1] += 0.5;
        expected[2] += 0.1 * 2.0;
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }
}
