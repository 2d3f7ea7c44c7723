//! Bodies from links: what is fixed to one joint is one body.

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use urdf_rs::{Inertial, JointType};

use super::tree::{Visit, ROOT_JOINT};
use crate::robot::description::{JointDescription, JointKind, LinkDescription, RobotDescription};
use crate::robot::lump::joined;
use crate::robot::{BodyIndex, LinkIndex};
use crate::spatial::Pose;

/// Pinocchio writes "unlimited" as the largest number.
const UNLIMITED: f64 = 1e300;

/// Joints, bodies and link frames, the latter in the order of the visits and without shapes.
pub(super) fn bodies(
    robot: &urdf_rs::Robot,
    visits: &[Visit],
    locked: &[(String, f64)],
    floating_base: bool,
) -> RobotDescription {
    let mut joints: Vec<JointDescription> = vec![];
    let mut links: Vec<LinkDescription> = Vec::with_capacity(visits.len());
    for visit in visits {
        let (body, placement) = match visit.joint.map(|number| &robot.joints[number]) {
            None if floating_base => {
                joints.push(free_flyer(ROOT_JOINT, Pose::identity()));
                (BodyIndex::new(1), Pose::identity())
            }
            None => (BodyIndex::WORLD, Pose::identity()),
            Some(urdf) => {
                let parent = &links[visit.parent];
                let here = parent.placement.compose(&pose(&urdf.origin));
                let position =
                    locked.iter().find(|(name, _)| *name == urdf.name).map(|(_, position)| *position);
                match (kind(urdf), position) {
                    (None, _) => (parent.body, here),
                    (Some(kind), Some(position)) => {
                        (parent.body, here.compose(&motion(kind, urdf, position)))
                    }
                    (Some(kind), None) => {
                        joints.push(joint(urdf, parent.body, kind, here));
                        (BodyIndex::new(joints.len()), Pose::identity())
                    }
                }
            }
        };
        let link = &robot.links[visit.link];
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
    let (name, gravity) = (robot.name.clone(), Vector3::zeros());
    RobotDescription { name, joints, links, gravity, warnings: vec![] }
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
fn kind(joint: &urdf_rs::Joint) -> Option<JointKind> {
    match joint.joint_type {
        JointType::Revolute => Some(JointKind::Revolute),
        JointType::Continuous => Some(JointKind::Continuous),
        JointType::Prismatic => Some(JointKind::Prismatic),
        JointType::Floating => Some(JointKind::FreeFlyer),
        // Other types were refused.
        JointType::Fixed | JointType::Planar | JointType::Spherical => None,
    }
}

/// Where a joint held at `position` [rad or m] leaves its link.
fn motion(kind: JointKind, joint: &urdf_rs::Joint, position: f64) -> Pose {
    let axis = Unit::new_normalize(Vector3::from(*joint.axis.xyz));
    match kind {
        JointKind::Prismatic => Pose { translation: axis.scale(position), ..Pose::identity() },
        _ => Pose { rotation: Rotation3::from_axis_angle(&axis, position).into_inner(), ..Pose::identity() },
    }
}

fn free_flyer(name: &str, placement: Pose) -> JointDescription {
    JointDescription {
        name: name.to_owned(),
        parent: BodyIndex::WORLD,
        kind: JointKind::FreeFlyer,
        axis: Vector3::zeros(),
        placement,
        mass: 0.0,
        com: Vector3::zeros(),
        inertia: Matrix3::zeros(),
        armature: 0.0,
        lower: None,
        upper: None,
        effort: None,
        velocity: None,
    }
}

fn joint(urdf: &urdf_rs::Joint, parent: BodyIndex, kind: JointKind, placement: Pose) -> JointDescription {
    let none = free_flyer(&urdf.name, placement);
    if kind == JointKind::FreeFlyer {
        return none;
    }
    let limited = |value: f64| (value.abs() < UNLIMITED).then_some(value);
    let position = |value: f64| limited(value).filter(|_| kind != JointKind::Continuous);
    let (lower, upper) = (position(urdf.limit.lower), position(urdf.limit.upper));
    let [effort, velocity] =
        [urdf.limit.effort, urdf.limit.velocity].map(|value| limited(value).filter(|_| has_limit(urdf)));
    JointDescription {
        parent,
        kind,
        axis: Vector3::from(*urdf.axis.xyz).normalize(),
        lower,
        upper,
        effort,
        velocity,
        ..none
    }
}

/// Whether it has a `<limit>`: `urdf-rs` gives zeros where a continuous joint has none.
fn has_limit(joint: &urdf_rs::Joint) -> bool {
    let limit = &joint.limit;
    [limit.lower, limit.upper, limit.effort, limit.velocity] != [0.0; 4]
}

/// Adds a link's inertia to a body's; `placement` is the link's in the joint's frame.
fn add(body: &mut JointDescription, placement: &Pose, inertial: &Inertial) {
    let frame = placement.compose(&pose(&inertial.origin));
    let inertia = frame.rotation * tensor(inertial) * frame.rotation.transpose();
    (body.mass, body.com, body.inertia) =
        joined((body.mass, body.com, body.inertia), (inertial.mass.value, frame.translation, inertia));
}

/// The inertia about the link's centre of mass, in the inertial frame's axes.
pub(super) fn tensor(inertial: &Inertial) -> Matrix3<f64> {
    let i = &inertial.inertia;
    Matrix3::new(i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz)
}
