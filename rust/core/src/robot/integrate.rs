//! Configurations some way from others, and random ones.

use std::f64::consts::PI;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::description::JointKind;
use super::robot::{Body, Robot};
use crate::error::Result;
use crate::math::random::Stream;

/// Below this angle (rad) the series of sine and cosine are exact to rounding.
const SMALL_ANGLE: f64 = 1e-4;
/// How far sliding joints without limits and a floating base go at random (m).
const REACH: f64 = 1.0;

impl Robot {
    /// The configuration that motion at a constant velocity `v` leads to in a second; for another time scale `v`.
    ///
    /// A floating base moves along its twist, which stays constant in its own frame.
    ///
    /// ```
    /// let robot = contactsense::robot::Robot::example_arm();
    /// let q = robot.integrate(&robot.neutral(), &[0.1; 7])?;
    /// assert_eq!(q, [0.1; 7]);
    /// # Ok::<(), contactsense::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) names the argument.
    pub fn integrate(&self, q: &[f64], v: &[f64]) -> Result<Vec<f64>> {
        self.check_configuration(q)?;
        self.check_tangent("v", v)?;
        let mut next = q.to_vec();
        self.advance_configuration(&mut next, v, 1.0);
        Ok(next)
    }

    /// Moves a checked configuration for a time (s) at a constant velocity, in place.
    pub(crate) fn advance_configuration(&self, q: &mut [f64], v: &[f64], time: f64) {
        for body in &self.bodies[1..] {
            let (q, v) = (&mut q[body.idx_q..], &v[body.idx_v..]);
            match body.kind {
                JointKind::Revolute | JointKind::Prismatic => q[0] += time * v[0],
                JointKind::Continuous => {
                    let ((sin, cos), norm) = ((time * v[0]).sin_cos(), q[0].hypot(q[1]));
                    (q[0], q[1]) = ((q[0] * cos - q[1] * sin) / norm, (q[1] * cos + q[0] * sin) / norm);
                }
                JointKind::FreeFlyer => {
                    let way: [f64; 6] = std::array::from_fn(|k| time * v[k]);
                    move_base(&mut q[..7], &way);
                }
            }
        }
    }

    /// A random configuration, for a seed always the same.
    ///
    /// Joints are uniform within their limits, within half a turn either way where they have none (sliding joints
    /// within 1 m); a floating base is within 1 m of the origin along each axis, its orientation uniform.
    pub fn random_configuration(&self, seed: u64) -> Vec<f64> {
        let stream = Stream::new(seed);
        let mut q = self.neutral();
        for (index, body) in self.bodies.iter().enumerate().skip(1) {
            let stream = stream.fork(index as u64);
            let q = &mut q[body.idx_q..];
            let [lower, upper] = working_range(body);
            let position = lower + (upper - lower) * stream.uniform(0);
            match body.kind {
                JointKind::Revolute | JointKind::Prismatic => q[0] = position,
                JointKind::Continuous => (q[1], q[0]) = position.sin_cos(),
                JointKind::FreeFlyer => {
                    for (counter, position) in q[..3].iter_mut().enumerate() {
                        *position = REACH * (2.0 * stream.uniform(counter as u64 + 1) - 1.0);
                    }
                    let ([x, y], [z, w]) = (stream.normals(4), stream.normals(6));
                    let turn = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
                    q[3..7].copy_from_slice(turn.coords.as_slice());
                }
            }
        }
        q
    }

    /// Smallest and largest value of each configuration variable (rad or m), infinite where there is no limit.
    pub fn position_limits(&self) -> Vec<[f64; 2]> {
        let one = |body: &Body| match body.kind {
            JointKind::Revolute | JointKind::Prismatic => vec![body.position_limits],
            kind => vec![[f64::NEG_INFINITY, f64::INFINITY]; kind.nq()],
        };
        self.bodies[1..].iter().flat_map(one).collect()
    }

    /// Largest effort of each velocity variable (Nm or N), infinite where there is no limit, 0 of a floating base.
    pub fn effort_limits(&self) -> Vec<f64> {
        let one = |body: &Body| match body.kind {
            JointKind::FreeFlyer => vec![0.0; 6],
            _ => vec![body.effort_limit],
        };
        self.bodies[1..].iter().flat_map(one).collect()
    }

    /// Largest velocity of each velocity variable (rad/s or m/s), infinite where there is no limit and for a floating base.
    pub fn velocity_limits(&self) -> Vec<f64> {
        let one = |body: &Body| vec![body.velocity_limit; body.kind.nv()];
        self.bodies[1..].iter().flat_map(one).collect()
    }
}

/// The positions of a joint that are in use (rad or m): its limits, where it has none half a turn or 1 m either way.
pub(crate) fn working_range(body: &Body) -> [f64; 2] {
    let free = if body.kind == JointKind::Prismatic { REACH } else { PI };
    match body.position_limits {
        [lower, upper] if lower.is_finite() && upper.is_finite() => [lower, upper.max(lower)],
        [lower, _] if lower.is_finite() => [lower, lower + 2.0 * free],
        [_, upper] if upper.is_finite() => [upper - 2.0 * free, upper],
        _ => [-free, free],
    }
}

/// Moves `q` = (position, quaternion xyzw) along the twist `v` = (linear, angular) for a second: the exponential map
/// of rigid motions.
fn move_base(q: &mut [f64], v: &[f64]) {
    let rotation = UnitQuaternion::new_normalize(Quaternion::new(q[6], q[3], q[4], q[5]));
    let (linear, angular) = (Vector3::new(v[0], v[1], v[2]), Vector3::new(v[3], v[4], v[5]));
    let angle = angular.norm();
    // (1 - cos a) / a^2 and (a - sin a) / a^3.
    let (first, second) = if angle < SMALL_ANGLE {
        (0.5 - angle * angle / 24.0, 1.0 / 6.0 - angle * angle / 120.0)
    } else {
        ((1.0 - angle.cos()) / (angle * angle), (angle - angle.sin()) / angle.powi(3))
    };
    let across = angular.cross(&linear);
    let way = rotation * (linear + across * first + angular.cross(&across) * second);
    let turned = rotation * UnitQuaternion::from_scaled_axis(angular);
    for (value, step) in q.iter_mut().zip(&way) {
        *value += step;
    }
    q[3..7].copy_from_slice(turned.coords.as_slice());
}
