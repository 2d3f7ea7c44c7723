//! Bodies from links: what is fixed to one joint is one body.

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use urdf_rs::JointType;

use super::tree::{Visit, ROOT_JOINT};
use crate::robot::description::{JointDescription, JointKind, LinkDescription, RobotDescription};
use crate::robot::lump::{joined, placed, Inertia};
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
        let (mass, com, inertia) = inertia(&link.inertial);
        // What is fixed to the world never moves.
        if let Some(body) = body.get().checked_sub(1).and_then(|index| joints.get_mut(index)) {
            let added = placed((mass, com, inertia), &placement);
            (body.mass, body.com, body.inertia) = joined((body.mass, body.com, body.inertia), added);
        }
        let parent = visit.joint.map(|_| LinkIndex::new(visit.parent));
        let (name, geometry) = (link.name.clone(), vec![]);
        links.push(LinkDescription { name, body, placement, parent, mass, com, inertia, geometry });
    }
    let (name, gravity) = (robot.name.clone(), Vector3::zeros());
    RobotDescription { name, joints, links, gravity, warnings: vec![] }
}

/// A URDF origin: `R = Rz(yaw) Ry(pitch) Rx(roll)`.
pub(super) fn pose(origin: &urdf_rs::Pose) -> Pose {
    let [roll, pitch, yaw] = *origin.rpy;
    Pose {
        rotation: Rotation3::from_euler_angles(roll, pitch, yaw).into_inner(),
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
    let [effort, velocity] = [urdf.limit.effort, urdf.limit.velocity].map(limited);
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

/// A link's inertia in its frame.
fn inertia(inertial: &urdf_rs::Inertial) -> Inertia {
    let i = &inertial.inertia;
    let tensor = Matrix3::new(i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz);
    placed((inertial.mass.value, Vector3::zeros(), tensor), &pose(&inertial.origin))
}
