//! A robot as plain data: what the loaders produce and `Robot::new` checks.

use nalgebra::{Matrix3, Vector3};

use super::ids::{BodyIndex, LinkIndex};
use crate::spatial::Pose;
use crate::surface::Part;

/// How a joint moves. `q` and `v` follow Pinocchio's order and meaning.
///
/// ```
/// use contactsense::robot::JointKind;
///
/// assert_eq!((JointKind::Continuous.nq(), JointKind::Continuous.nv()), (2, 1));
/// assert_eq!((JointKind::FreeFlyer.nq(), JointKind::FreeFlyer.nv()), (7, 6));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum JointKind {
    /// A floating base: `q` = position, quaternion (x, y, z, w); `v` = linear, angular, both in the base frame.
    FreeFlyer,
    /// `q` is the angle (rad).
    Revolute,
    /// `q` is (cos, sin) of the angle; `v` the angular velocity (rad/s).
    Continuous,
    /// `q` is the displacement (m).
    Prismatic,
}

impl JointKind {
    /// The kind's name in Python.
    pub fn name(self) -> &'static str {
        match self {
            JointKind::FreeFlyer => "free_flyer",
            JointKind::Revolute => "revolute",
            JointKind::Continuous => "continuous",
            JointKind::Prismatic => "prismatic",
        }
    }

    /// Number of configuration variables.
    pub fn nq(self) -> usize {
        match self {
            JointKind::FreeFlyer => 7,
            JointKind::Continuous => 2,
            JointKind::Revolute | JointKind::Prismatic => 1,
        }
    }

    /// Number of velocity variables.
    pub fn nv(self) -> usize {
        match self {
            JointKind::FreeFlyer => 6,
            _ => 1,
        }
    }
}

/// A joint and the rigid body it moves (all links fixed to it lumped).
///
/// ```
/// use contactsense::robot::{JointDescription, JointKind, Robot, RobotDescription};
///
/// let mut description = RobotDescription::example_arm();
/// let third: &mut JointDescription = &mut description.joints[2];
/// (third.kind, third.armature) = (JointKind::Continuous, 0.1);
/// assert_eq!(Robot::new(description)?.nq(), 8);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct JointDescription {
    /// Unique name.
    pub name: String,
    /// The body that carries it: the world, or the one that an earlier joint moves.
    pub parent: BodyIndex,
    /// How it moves.
    pub kind: JointKind,
    /// Axis in the joint frame (unused by a free flyer).
    pub axis: Vector3<f64>,
    /// Joint frame in the parent joint's frame at zero.
    pub placement: Pose,
    /// Mass of the body (kg).
    pub mass: f64,
    /// Centre of mass in the joint frame (m).
    pub com: Vector3<f64>,
    /// Inertia about the centre of mass, in joint axes (kg m^2).
    pub inertia: Matrix3<f64>,
    /// Rotor inertia added to the diagonal of the mass matrix (kg m^2 or kg).
    pub armature: f64,
    /// Smallest position (rad or m) of a revolute or prismatic joint; none where there is no limit.
    #[cfg_attr(feature = "serde", serde(default))]
    pub lower: Option<f64>,
    /// Largest position (rad or m).
    #[cfg_attr(feature = "serde", serde(default))]
    pub upper: Option<f64>,
    /// Largest effort (Nm or N).
    #[cfg_attr(feature = "serde", serde(default))]
    pub effort: Option<f64>,
    /// Largest velocity (rad/s or m/s).
    #[cfg_attr(feature = "serde", serde(default))]
    pub velocity: Option<f64>,
}

/// A URDF link: a named frame on a body, with the parts of its surface.
///
/// ```
/// use contactsense::robot::{LinkDescription, LinkIndex, Robot, RobotDescription};
///
/// let mut description = RobotDescription::example_arm();
/// // A frame at the tip, which has no surface and no mass.
/// let last = description.links[6].clone();
/// let parent = Some(LinkIndex::new(6));
/// let mut tip = LinkDescription { name: "tip".into(), parent, mass: 0.0, geometry: vec![], ..last };
/// tip.placement.translation.z = 0.3;
/// tip.inertia.fill(0.0);
/// description.links.push(tip);
/// let robot = Robot::new(description)?;
/// let pose = robot.link_pose(&robot.neutral(), robot.link("tip")?)?;
/// assert!((pose.translation.z - 2.4).abs() < 1e-12);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct LinkDescription {
    /// Unique name.
    pub name: String,
    /// The body it is fixed to.
    pub body: BodyIndex,
    /// Link frame in the joint's frame.
    pub placement: Pose,
    /// The link that its joint, fixed or moving, hangs from; none for the root.
    pub parent: Option<LinkIndex>,
    /// Its own mass (kg): of the joint's body, the part that is this link's.
    pub mass: f64,
    /// Its own centre of mass in the link frame (m).
    pub com: Vector3<f64>,
    /// Its own inertia about the centre of mass, in link axes (kg m^2).
    pub inertia: Matrix3<f64>,
    /// Shapes in the link frame; none where the link cannot be touched.
    pub geometry: Vec<Part>,
}

/// Everything `Robot::new` needs.
///
/// ```
/// use contactsense::robot::{Robot, RobotDescription};
///
/// let mut description = RobotDescription::example_arm();
/// description.gravity.fill(0.0);
/// let robot = Robot::new(description)?;
/// assert_eq!(robot.inverse_dynamics(&[0.4; 7], &[0.0; 7], &[0.0; 7])?, [0.0; 7]);
///
/// let mut description = RobotDescription::example_arm();
/// description.links[3].name = "link_1".into();
/// assert!(Robot::new(description).unwrap_err().to_string().contains("given more than once: 'link_1'"));
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct RobotDescription {
    /// The robot's name.
    pub name: String,
    /// Joints, parents before children.
    pub joints: Vec<JointDescription>,
    /// Links, in any order. A body's inertia is its joint's; what its links' own do not add up to is taken to sit
    /// at the link that the joint moves.
    pub links: Vec<LinkDescription>,
    /// Gravity in the world frame (m/s^2).
    pub gravity: Vector3<f64>,
    /// What a loader found odd and what it did about it.
    pub warnings: Vec<String>,
}
