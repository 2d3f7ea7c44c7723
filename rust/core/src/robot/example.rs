//! A robot for examples and tests that needs no files.

use nalgebra::{Matrix3, Vector3};

use super::{BodyIndex, JointDescription, JointKind, LinkDescription, LinkIndex, Robot, RobotDescription};
use crate::spatial::Pose;
use crate::surface::{Geometry, Part};

/// Distance from joint to joint (m), and the links' radius (m).
const LENGTH: f64 = 0.3;
const RADIUS: f64 = 0.05;
/// Of each link (kg).
const MASS: f64 = 2.0;

impl RobotDescription {
    /// A made-up arm of seven revolute joints, alternately about z and y, with a capsule a link; not a real robot.
    pub fn example_arm() -> Self {
        let up = |z| Pose { rotation: Matrix3::identity(), translation: Vector3::new(0.0, 0.0, z) };
        let com = Vector3::new(0.0, 0.0, 0.5 * LENGTH);
        let rod = MASS * LENGTH * LENGTH / 12.0;
        let inertia = Matrix3::from_diagonal(&Vector3::new(rod, rod, 0.5 * MASS * RADIUS * RADIUS));
        let joint = |k: usize| JointDescription {
            name: format!("joint_{}", k + 1),
            parent: BodyIndex::new(k),
            kind: JointKind::Revolute,
            axis: if k.is_multiple_of(2) { Vector3::z() } else { Vector3::y() },
            placement: up(LENGTH),
            mass: MASS,
            com,
            inertia,
            armature: 0.0,
            lower: None,
            upper: None,
            effort: None,
            velocity: None,
        };
        let link = |k: usize| LinkDescription {
            name: format!("link_{}", k + 1),
            body: BodyIndex::new(k + 1),
            placement: Pose::identity(),
            parent: k.checked_sub(1).map(LinkIndex::new),
            mass: MASS,
            com,
            inertia,
            geometry: vec![Part {
                geometry: Geometry::Capsule { radius: RADIUS, half_length: 0.5 * LENGTH },
                pose: up(0.5 * LENGTH),
            }],
        };
        RobotDescription {
            name: "example arm".into(),
            joints: (0..7).map(joint).collect(),
            links: (0..7).map(link).collect(),
            gravity: Vector3::new(0.0, 0.0, -9.81),
            warnings: vec![],
        }
    }
}

impl Robot {
    /// The robot of [`RobotDescription::example_arm`].
    ///
    /// ```
    /// let robot = contactsense::robot::Robot::example_arm();
    /// assert_eq!((robot.nv(), robot.touchable_links().len()), (7, 7));
    /// ```
    pub fn example_arm() -> Robot {
        #[allow(clippy::expect_used)] // its description is a constant
        Robot::new(RobotDescription::example_arm()).expect("the description is valid")
    }
}
