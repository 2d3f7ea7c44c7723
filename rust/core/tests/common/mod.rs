//! Robots for tests, written as descriptions.
#![allow(dead_code)] // each test binary uses its part

use std::sync::Arc;

use contactsense::robot::{JointDescription, JointKind, LinkDescription, Robot, RobotDescription};
use contactsense::spatial::Pose;
use contactsense::surface::{Geometry, Part};
use nalgebra::{Matrix3, Rotation3, Vector3};

const COM: Vector3<f64> = Vector3::new(0.01, -0.02, 0.12);
const INERTIA: Matrix3<f64> = Matrix3::new(0.03, 0.001, 0.0, 0.001, 0.03, 0.002, 0.0, 0.002, 0.01);

/// A link: a capsule along z from the joint.
fn capsule(name: &str, joint: usize, parent: Option<usize>, length: f64) -> LinkDescription {
    let pose = Pose { rotation: Matrix3::identity(), translation: Vector3::new(0.0, 0.0, 0.5 * length) };
    let geometry = Geometry::Capsule { radius: 0.06, half_length: 0.5 * length };
    LinkDescription {
        name: name.into(),
        joint,
        placement: Pose::identity(),
        parent,
        mass: 2.0,
        com: COM,
        inertia: INERTIA,
        geometry: vec![Part { geometry, pose }],
    }
}

fn joint(
    name: &str,
    parent: usize,
    kind: JointKind,
    axis: Vector3<f64>,
    at: Vector3<f64>,
) -> JointDescription {
    JointDescription {
        name: name.into(),
        parent,
        kind,
        axis,
        placement: Pose {
            rotation: Rotation3::from_euler_angles(0.1, -0.2, 0.3).into_inner(),
            translation: at,
        },
        mass: 2.0,
        com: COM,
        inertia: INERTIA,
        armature: 0.0,
    }
}

/// Appends a chain of revolute joints with alternating axes behind `parent`; returns its last joint.
fn chain(description: &mut RobotDescription, name: &str, parent: usize, at: Vector3<f64>, count: usize) {
    let axes = [Vector3::z(), Vector3::y(), Vector3::x(), Vector3::new(0.3, -0.5, 0.8)];
    let mut link = description.links.iter().position(|link| link.joint == parent);
    let (mut parent, mut at) = (parent, at);
    for k in 0..count {
        let kind = if k == 2 { JointKind::Continuous } else { JointKind::Revolute };
        let name = format!("{name}_{k}");
        description.joints.push(joint(&name, parent, kind, axes[k % 4], at));
        parent = description.joints.len();
        description.links.push(capsule(&name, parent, link, 0.25));
        link = Some(description.links.len() - 1);
        at = Vector3::new(0.0, 0.05, 0.35);
    }
}

fn empty(name: &str) -> RobotDescription {
    RobotDescription {
        name: name.into(),
        joints: vec![],
        links: vec![],
        gravity: Vector3::new(0.0, 0.0, -9.81),
        warnings: vec![],
    }
}

/// A fixed arm of seven joints.
pub fn arm() -> Arc<Robot> {
    let mut description = empty("arm");
    chain(&mut description, "arm", 0, Vector3::new(0.0, 0.0, 0.2), 7);
    Arc::new(Robot::new(description).expect("a valid description"))
}

/// A floating trunk with four limbs of six joints.
pub fn humanoid() -> Arc<Robot> {
    let mut description = empty("humanoid");
    description.joints.push(joint("root", 0, JointKind::FreeFlyer, Vector3::z(), Vector3::zeros()));
    description.links.push(capsule("trunk", 1, None, 0.4));
    for (k, name) in ["left_arm", "right_arm", "left_leg", "right_leg"].into_iter().enumerate() {
        let (side, height) = (if k % 2 == 0 { 0.25 } else { -0.25 }, if k < 2 { 0.5 } else { -0.1 });
        chain(&mut description, name, 1, Vector3::new(0.0, side, height), 6);
    }
    Arc::new(Robot::new(description).expect("a valid description"))
}

/// A generic configuration: numbers of a fixed sequence, unit quaternion and (cos, sin) pairs.
pub fn configuration(robot: &Robot, seed: f64) -> Vec<f64> {
    let mut q = robot.neutral();
    let mut index = 0;
    for (k, kind) in robot.joint_kinds().enumerate() {
        let angle = (seed + 1.7 * k as f64).sin();
        match kind {
            JointKind::FreeFlyer => {
                let quaternion = nalgebra::Vector4::new(0.1, -0.3 + 0.1 * seed.sin(), 0.2, 0.9).normalize();
                q[..3].copy_from_slice(&[0.3, -0.2, 1.0]);
                q[3..7].copy_from_slice(quaternion.as_slice());
            }
            JointKind::Continuous => {
                q[index] = angle.cos();
                q[index + 1] = angle.sin();
            }
            _ => q[index] = angle,
        }
        index += kind.nq();
    }
    q
}

/// `count` generic numbers of size one.
pub fn numbers(count: usize, seed: f64) -> Vec<f64> {
    (0..count).map(|k| (seed + 2.3 * k as f64).cos()).collect()
}

/// External torque of a force at a point of a link [world frame].
pub fn torque_of(robot: &Robot, q: &[f64], link: usize, point: [f64; 3], force: Vector3<f64>) -> Vec<f64> {
    let jacobian = robot.jacobian(q, link, Some(point)).expect("a valid link");
    (jacobian.rows(0, 3).transpose() * force).as_slice().to_vec()
}
