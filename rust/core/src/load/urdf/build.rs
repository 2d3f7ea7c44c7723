//! Bodies from links: what is fixed to one joint is one body.

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use urdf_rs::{Inertial, JointType};

use super::tree::{Tree, ROOT_JOINT};
use crate::error::{Error, Result};
use crate::robot::description::{JointDescription, JointKind, LinkDescription, RobotDescription};
use crate::robot::{BodyIndex, LinkIndex};
use crate::spatial::Pose;

/// Joints, bodies and link frames, the latter in the order of the tree's visits and without shapes.
pub(super) fn bodies(tree: &Tree, locked: &[(String, f64)], floating_base: bool) -> Result<RobotDescription> {
    let mut joints: Vec<JointDescription> = vec![];
    let mut links: Vec<LinkDescription> = Vec::with_capacity(tree.visits.len());
    for visit in &tree.visits {
        let (body, placement) = match visit.joint.map(|number| &tree.robot.joints[number]) {
            None if floating_base => {
                joints.push(joint(
                    ROOT_JOINT,
                    BodyIndex::WORLD,
                    JointKind::FreeFlyer,
                    Vector3::zeros(),
                    Pose::identity(),
                ));
                (BodyIndex::new(1), Pose::identity())
            }
            None => (BodyIndex::WORLD, Pose::identity()),
            Some(urdf) => {
                let parent = &links[visit.parent];
                let here = parent.placement.compose(&pose(&urdf.origin));
                let axis = Vector3::from(*urdf.axis.xyz);
                match (kind(urdf)?, locked.iter().find(|(name, _)| *name == urdf.name)) {
                    (None, _) => (parent.body, here),
                    (Some(kind), Some((_, position))) => {
                        (parent.body, here.compose(&motion(kind, &axis, *position)))
                    }
                    (Some(kind), None) => {
                        joints.push(joint(&urdf.name, parent.body, kind, axis.normalize(), here));
                        (BodyIndex::new(joints.len()), Pose::identity())
                    }
                }
            }
        };
        let link = &tree.robot.links[visit.link];
        // What is fixed to the world never moves.
        if let Some(moving) = body.get().checked_sub(1).and_then(|index| joints.get_mut(index)) {
            add(moving, &placement, &link.inertial);
        }
        let inertial = pose(&link.inertial.origin);
        links.push(LinkDescription {
            name: link.name.clone(),
            body,
            placement,
            parent: visit.joint.map(|_| LinkIndex::new(visit.parent)),
            mass: link.inertial.mass.value,
            com: inertial.translation,
            inertia: inertial.rotation * tensor(&link.inertial) * inertial.rotation.transpose(),
            geometry: vec![],
        });
    }
    Ok(RobotDescription {
        name: tree.robot.name.clone(),
        joints,
        links,
        gravity: Vector3::zeros(),
        warnings: vec![],
    })
}

/// A URDF origin: `R = Rz(yaw) Ry(pitch) Rx(roll)`.
pub(super) fn pose(origin: &urdf_rs::Pose) -> Pose {
    let [roll, pitch, yaw] = *origin.rpy;
    let ((sr, cr), (sp, cp), (sy, cy)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
    Pose {
        rotation: Matrix3::new(
            cy * cp,
            cy * sp * sr - sy * cr,
            cy * sp * cr + sy * sr,
            sy * cp,
            sy * sp * sr + cy * cr,
            sy * sp * cr - cy * sr,
            -sp,
            cp * sr,
            cp * cr,
        ),
        translation: Vector3::from(*origin.xyz),
    }
}

/// How a joint moves, none where it is fixed.
fn kind(joint: &urdf_rs::Joint) -> Result<Option<JointKind>> {
    match joint.joint_type {
        JointType::Fixed => Ok(None),
        JointType::Revolute => Ok(Some(JointKind::Revolute)),
        JointType::Continuous => Ok(Some(JointKind::Continuous)),
        JointType::Prismatic => Ok(Some(JointKind::Prismatic)),
        _ => Err(Error::model(format!(
            "joint '{}' is {:?}; supported: {}",
            joint.name,
            joint.joint_type,
            super::guard::joint::SUPPORTED_JOINTS
        ))
        .of(&format!("joint '{}'", joint.name))),
    }
}

/// Where a joint held at `position` [rad or m] leaves its link.
fn motion(kind: JointKind, axis: &Vector3<f64>, position: f64) -> Pose {
    let axis = Unit::new_normalize(*axis);
    match kind {
        JointKind::Prismatic => Pose { translation: axis.scale(position), ..Pose::identity() },
        _ => Pose { rotation: Rotation3::from_axis_angle(&axis, position).into_inner(), ..Pose::identity() },
    }
}

fn joint(
    name: &str,
    parent: BodyIndex,
    kind: JointKind,
    axis: Vector3<f64>,
    placement: Pose,
) -> JointDescription {
    JointDescription {
        name: name.to_owned(),
        parent,
        kind,
        axis,
        placement,
        mass: 0.0,
        com: Vector3::zeros(),
        inertia: Matrix3::zeros(),
        armature: 0.0,
    }
}

/// Adds a link's inertia to a body's; `placement` is the link's in the joint's frame.
fn add(body: &mut JointDescription, placement: &Pose, inertial: &Inertial) {
    let frame = placement.compose(&pose(&inertial.origin));
    let (mass, com) = (inertial.mass.value, frame.translation);
    let total = body.mass + mass;
    // Without mass the centre of mass means nothing; it is then zero, as in Pinocchio.
    let share = 1.0 / total.max(f64::EPSILON);
    let apart = body.com - com;
    let spread = Matrix3::from_diagonal_element(apart.norm_squared()) - apart * apart.transpose();
    body.inertia += frame.rotation * tensor(inertial) * frame.rotation.transpose();
    body.inertia += body.mass * mass * share * spread;
    body.com = (body.mass * body.com + mass * com) * share;
    body.mass = total;
}

/// The inertia about the link's centre of mass, in the inertial frame's axes.
pub(super) fn tensor(inertial: &Inertial) -> Matrix3<f64> {
    let i = &inertial.inertia;
    Matrix3::new(i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz)
}
