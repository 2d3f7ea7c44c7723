//! Forward kinematics: poses and velocities of all bodies, computed once per tick and shared.
//!
//! Axes are the world's. Positions and spatial vectors refer to `origin`, a point at the base, so that sums over
//! the tree need no transforms and a base far from the world's origin costs no digits.

use std::ops::Index;

use nalgebra::{Matrix3, Vector3};

use super::description::JointKind;
use super::ids::{BodyIndex, LinkIndex};
use super::robot::{Robot, WORLD};
use crate::spatial::Pose;

/// A body's pose and velocity.
///
/// ```
/// use contactsense::robot::{Kinematics, Robot};
///
/// let robot = Robot::example_arm();
/// let mut kinematics = Kinematics::new(&robot);
/// kinematics.set_configuration(&robot, &[0.0; 7]);
/// kinematics.set_velocity(&robot, &[0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
/// // The second joint turns about y, 0.3 m above the first.
/// let state = &kinematics.bodies[2];
/// assert!((state.axis().y - 1.0).abs() < 1e-12 && (state.position.z - 0.3).abs() < 1e-12);
/// assert!(state.velocity_at(&state.position).norm() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BodyState {
    /// Rotation from body to world axes.
    pub rotation: Matrix3<f64>,
    /// Body origin, from the reference origin (m).
    pub position: Vector3<f64>,
    /// Linear velocity of the body-fixed point at the reference origin (m/s).
    pub linear: Vector3<f64>,
    /// Angular velocity (rad/s).
    pub angular: Vector3<f64>,
}

impl BodyState {
    /// The joint's axis in world axes.
    #[inline]
    pub fn axis(&self) -> Vector3<f64> {
        self.rotation.column(2).into_owned()
    }

    /// Velocity of the body-fixed point at `position` (from the reference origin).
    #[inline]
    pub fn velocity_at(&self, position: &Vector3<f64>) -> Vector3<f64> {
        self.linear + self.angular.cross(position)
    }
}

/// Poses and velocities of all bodies; entry 0 is the world.
///
/// ```
/// use contactsense::robot::{Kinematics, Robot};
///
/// let robot = Robot::example_arm();
/// let mut kinematics = Kinematics::new(&robot);
/// kinematics.set_configuration(&robot, &[0.0; 7]);
/// let link = robot.link("link_7")?;
/// // Upright, seven joints 0.3 m apart.
/// assert!((kinematics.link_pose(&robot, link).translation.z - 2.1).abs() < 1e-12);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Kinematics {
    /// The reference origin in the world frame (m).
    pub origin: Vector3<f64>,
    /// One state a body.
    pub bodies: Vec<BodyState>,
}

impl Kinematics {
    /// Space for a robot's bodies.
    pub fn new(robot: &Robot) -> Self {
        let rest = BodyState {
            rotation: Matrix3::identity(),
            position: Vector3::zeros(),
            linear: Vector3::zeros(),
            angular: Vector3::zeros(),
        };
        Self { origin: Vector3::zeros(), bodies: vec![rest; robot.body_count()] }
    }

    /// No bodies: a placeholder that costs no memory.
    pub(crate) fn empty() -> Self {
        Self { origin: Vector3::zeros(), bodies: Vec::new() }
    }

    /// Poses at a checked configuration `q`.
    #[inline]
    pub fn set_configuration(&mut self, robot: &Robot, q: &[f64]) {
        self.origin = match robot.bodies.get(1) {
            Some(base) if base.kind == JointKind::FreeFlyer => {
                base.placement.transform_point(&Vector3::new(q[0], q[1], q[2]))
            }
            Some(base) => base.placement.translation,
            None => Vector3::zeros(),
        };
        self.bodies[WORLD].position = -self.origin;
        for (index, body) in robot.bodies.iter().enumerate().skip(1) {
            let parent = self.bodies[body.parent];
            let state = &mut self.bodies[index];
            let rotation = parent.rotation * body.placement.rotation;
            let position = parent.position + parent.rotation * body.placement.translation;
            match body.kind {
                JointKind::Revolute => {
                    let (sin, cos) = q[body.idx_q].sin_cos();
                    state.rotation = turn_about_z(&rotation, cos, sin);
                    state.position = position;
                }
                JointKind::Continuous => {
                    let (cos, sin) = (q[body.idx_q], q[body.idx_q + 1]);
                    let norm = cos.hypot(sin);
                    state.rotation = turn_about_z(&rotation, cos / norm, sin / norm);
                    state.position = position;
                }
                JointKind::Prismatic => {
                    state.rotation = rotation;
                    state.position = position + rotation.column(2) * q[body.idx_q];
                }
                JointKind::FreeFlyer => {
                    let quaternion = &q[body.idx_q + 3..body.idx_q + 7];
                    state.rotation = rotation * rotation_of_quaternion(quaternion);
                    state.position = Vector3::zeros();
                }
            }
        }
    }

    /// Velocities at the configuration set before.
    #[inline]
    pub fn set_velocity(&mut self, robot: &Robot, v: &[f64]) {
        for (index, body) in robot.bodies.iter().enumerate().skip(1) {
            let BodyState { mut linear, mut angular, .. } = self.bodies[body.parent];
            let state = &mut self.bodies[index];
            match body.kind {
                JointKind::Revolute | JointKind::Continuous => {
                    let spin = state.axis() * v[body.idx_v];
                    linear += state.position.cross(&spin);
                    angular += spin;
                }
                JointKind::Prismatic => linear += state.axis() * v[body.idx_v],
                JointKind::FreeFlyer => {
                    let v = &v[body.idx_v..body.idx_v + 6];
                    linear += state.rotation * Vector3::new(v[0], v[1], v[2]);
                    angular += state.rotation * Vector3::new(v[3], v[4], v[5]);
                }
            }
            state.linear = linear;
            state.angular = angular;
        }
    }

    /// A link's pose in the world.
    pub fn link_pose(&self, robot: &Robot, link: LinkIndex) -> Pose {
        let link = &robot[link];
        let body = &self.bodies[link.body];
        let pose = Pose { rotation: body.rotation, translation: body.position + self.origin };
        pose.compose(&link.placement)
    }
}

/// The state of a body.
///
/// # Panics
/// If it is the index of another robot's body.
impl Index<BodyIndex> for Kinematics {
    type Output = BodyState;

    #[inline]
    fn index(&self, body: BodyIndex) -> &BodyState {
        &self.bodies[body.get()]
    }
}

/// `rotation * Rz(angle)`.
#[inline]
fn turn_about_z(rotation: &Matrix3<f64>, cos: f64, sin: f64) -> Matrix3<f64> {
    let (x, y) = (rotation.column(0), rotation.column(1));
    Matrix3::from_columns(&[x * cos + y * sin, y * cos - x * sin, rotation.column(2).into_owned()])
}

/// The rotation of a quaternion (x, y, z, w) of norm near 1.
#[inline]
fn rotation_of_quaternion(quaternion: &[f64]) -> Matrix3<f64> {
    let (x, y, z, w) = (quaternion[0], quaternion[1], quaternion[2], quaternion[3]);
    let scale = 2.0 / (x * x + y * y + z * z + w * w);
    Matrix3::new(
        1.0 - scale * (y * y + z * z),
        scale * (x * y - z * w),
        scale * (x * z + y * w),
        scale * (x * y + z * w),
        1.0 - scale * (x * x + z * z),
        scale * (y * z - x * w),
        scale * (x * z - y * w),
        scale * (y * z + x * w),
        1.0 - scale * (x * x + y * y),
    )
}
