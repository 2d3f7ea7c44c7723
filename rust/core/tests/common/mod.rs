//! Robots for tests, written as descriptions.
#![allow(dead_code)] // each test binary uses its part

use std::sync::Arc;

use contactsense::robot::{
    BodyIndex, JointDescription, JointKind, LinkDescription, LinkIndex, Robot, RobotDescription,
};
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
        body: BodyIndex::new(joint),
        placement: Pose::identity(),
        parent: parent.map(LinkIndex::new),
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
        parent: BodyIndex::new(parent),
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
        lower: None,
        upper: None,
        effort: None,
        velocity: None,
    }
}

/// Appends a chain of revolute joints with alternating axes behind `parent`; returns its last joint.
fn chain(description: &mut RobotDescription, name: &str, parent: usize, at: Vector3<f64>, count: usize) {
    let axes = [Vector3::z(), Vector3::y(), Vector3::x(), Vector3::new(0.3, -0.5, 0.8)];
    let mut link = description.links.iter().position(|link| link.body.get() == parent);
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

/// The same arm with a mesh of 640 triangles a link: 20 around, barrels of 0.05 to 0.07 m.
pub fn meshed_arm() -> Arc<Robot> {
    let mut description = empty("meshed arm");
    chain(&mut description, "arm", 0, Vector3::new(0.0, 0.0, 0.2), 7);
    for link in &mut description.links {
        link.geometry = vec![Part { geometry: barrel(20, 16, 0.3), pose: Pose::identity() }];
    }
    Arc::new(Robot::new(description).expect("a valid description"))
}

/// A closed barrel along z, from -0.06 m on: rings of `around` vertices, a vertex at both ends.
fn barrel(around: u32, rings: u32, length: f64) -> Geometry {
    let mut vertices = vec![[0.0, 0.0, -0.06], [0.0, 0.0, length + 0.06]];
    let mut triangles = vec![];
    let at = |ring: u32, k: u32| 2 + ring * around + k % around;
    for ring in 0..rings {
        let share = f64::from(ring) / f64::from(rings - 1);
        let radius = 0.05 + 0.02 * (std::f64::consts::PI * share).sin();
        for k in 0..around {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(around)).sin_cos();
            vertices.push([radius * cos, radius * sin, length * share]);
            if ring + 1 < rings {
                let (a, b, c, d) = (at(ring, k), at(ring, k + 1), at(ring + 1, k + 1), at(ring + 1, k));
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    for k in 0..around {
        triangles.extend([[0, at(0, k + 1), at(0, k)], [1, at(rings - 1, k), at(rings - 1, k + 1)]]);
    }
    Geometry::Mesh { vertices, triangles }
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
pub fn torque_of(
    robot: &Robot,
    q: &[f64],
    link: LinkIndex,
    point: [f64; 3],
    force: Vector3<f64>,
) -> Vec<f64> {
    let jacobian = robot.jacobian(q, link, Some(point)).expect("a valid link");
    (jacobian.rows(0, 3).transpose() * force).as_slice().to_vec()
}

/// An arm in touch with a ball: its poses, and what a springy ball that stays puts on the joints.
pub struct BallRun {
    /// Index of the touched link.
    pub link: LinkIndex,
    pub poses: Vec<Vec<f64>>,
    pub torques: Vec<Vec<f64>>,
    /// Contact points, world frame [m].
    pub points: Vec<Vector3<f64>>,
}

/// Small motions of an arm against a ball of 5 cm and 2500 N/m, pressed in by 8 mm at the start.
pub fn ball_run(robot: &Robot, link: &str, updates: usize) -> BallRun {
    const RADIUS: f64 = 0.05;
    const STIFFNESS: f64 = 2500.0;
    let link = robot.link(link).expect("a link of the robot");
    let surface = robot[link].surface.as_ref().expect("a touchable link");
    let start = configuration(robot, 0.4);
    let sample = surface.sample(1, 3)[0];
    let centre = robot
        .link_pose(&start, link)
        .expect("a valid link")
        .transform_point(&(sample.point + sample.normal * (RADIUS - 0.008)));
    let mut run = BallRun { link, poses: vec![], torques: vec![], points: vec![] };
    for update in 0..updates {
        // As large as keeps the ball pressed in by one to twenty millimetres.
        let mut amplitude = 0.03;
        let (q, pose, local, near) = loop {
            let q = swing(robot, &start, update, amplitude);
            let pose = robot.link_pose(&q, link).expect("a valid link");
            let local = pose.inverse_transform_point(&centre);
            let near = surface.closest_point(&local);
            let outside = (local - near.point).dot(&near.normal) > 0.0;
            if outside && (RADIUS - 0.02..RADIUS - 0.001).contains(&near.distance) {
                break (q, pose, local, near);
            }
            amplitude *= 0.5;
        };
        let outward = (local - near.point) / near.distance;
        let force = STIFFNESS * (RADIUS - near.distance);
        let point = pose.transform_point(&near.point);
        run.torques.push(torque_of(robot, &q, link, point.into(), pose.rotation * outward * -force));
        run.poses.push(q);
        run.points.push(point);
    }
    run
}

/// A configuration near `start`.
fn swing(robot: &Robot, start: &[f64], update: usize, amplitude: f64) -> Vec<f64> {
    let mut q = start.to_vec();
    let mut index = 0;
    for (k, kind) in robot.joint_kinds().enumerate() {
        let phase = 1.3 * k as f64;
        let angle = amplitude * (((0.4 + 0.13 * k as f64) * update as f64 + phase).sin() - phase.sin());
        if kind == JointKind::Continuous {
            let (sin, cos) = angle.sin_cos();
            let (c, s) = (q[index], q[index + 1]);
            (q[index], q[index + 1]) = (c * cos - s * sin, s * cos + c * sin);
        } else {
            q[index] += angle;
        }
        index += kind.nq();
    }
    q
}

/// Torques with reproducible noise of about this standard deviation [Nm].
pub fn noisy(torque: &[f64], deviation: f64, phase: f64) -> Vec<f64> {
    let noise = |k: usize| deviation * 2.0_f64.sqrt() * (12.9898 * (k as f64 + 1.0) * (phase + 1.0)).sin();
    torque.iter().enumerate().map(|(k, torque)| torque + noise(k)).collect()
}
