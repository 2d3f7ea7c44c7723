//! Joints and links for tests whose robots differ in the tree alone.

use nalgebra::{Matrix3, Vector3};

use super::{BodyIndex, JointDescription, JointKind, LinkDescription, LinkIndex, Robot, RobotDescription};
use crate::spatial::Pose;

/// A joint about y at its parent's origin; 1 kg.
pub(crate) fn joint(name: &str, parent: usize) -> JointDescription {
    JointDescription {
        name: name.into(),
        parent: BodyIndex::new(parent),
        kind: JointKind::Revolute,
        axis: Vector3::y(),
        placement: Pose::identity(),
        mass: 1.0,
        com: Vector3::zeros(),
        inertia: Matrix3::identity(),
        armature: 0.0,
        lower: None,
        upper: None,
        effort: None,
        velocity: None,
    }
}

/// A link at its joint's origin, without surface; 0.5 kg.
pub(crate) fn link(name: &str, body: usize, parent: Option<usize>) -> LinkDescription {
    LinkDescription {
        name: name.into(),
        body: BodyIndex::new(body),
        placement: Pose::identity(),
        parent: parent.map(LinkIndex::new),
        mass: 0.5,
        com: Vector3::zeros(),
        inertia: Matrix3::identity(),
        geometry: vec![],
    }
}

/// The robot of joints and links, without gravity.
pub(crate) fn robot(joints: Vec<JointDescription>, links: Vec<LinkDescription>) -> Robot {
    let (gravity, warnings) = (Vector3::zeros(), vec![]);
    Robot::new(RobotDescription { name: "tree".into(), joints, links, gravity, warnings })
        .expect("a valid description")
}
