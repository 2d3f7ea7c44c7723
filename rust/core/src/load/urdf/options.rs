//! How to read a URDF.

use std::path::PathBuf;

use nalgebra::Vector3;

/// Which of a URDF's shapes make the surface.
///
/// ```
/// use contactsense::load::{UrdfGeometry, UrdfOptions};
///
/// let options = UrdfOptions { geometry: UrdfGeometry::Visual, ..UrdfOptions::default() };
/// assert_ne!(options.geometry, UrdfGeometry::default());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum UrdfGeometry {
    /// `<collision>` elements.
    #[default]
    Collision,
    /// `<visual>` elements.
    Visual,
    /// Of each link the `<collision>` elements, or the `<visual>` ones where it has none.
    CollisionOrVisual,
}

/// What to do about a mesh file that is missing, or lies outside the folders it may come from.
///
/// ```
/// use contactsense::load::{MissingMeshes, UrdfOptions};
///
/// assert_eq!(UrdfOptions::default().missing_meshes, MissingMeshes::Error);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum MissingMeshes {
    /// Refuse the robot.
    #[default]
    Error,
    /// Leave the shape out, with a warning; a link without other shapes has no surface.
    Warn,
}

/// How to read a URDF.
///
/// ```
/// use contactsense::load::UrdfOptions;
/// use contactsense::{robot::Robot, Error};
///
/// // A humanoid whose left wrist is held at 0.5 rad.
/// let options = UrdfOptions {
///     floating_base: true,
///     locked_joints: vec![("left_wrist".into(), 0.5)],
///     ..UrdfOptions::default()
/// };
/// assert!(matches!(Robot::from_urdf("no_such_file.urdf", &options), Err(Error::Model { .. })));
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct UrdfOptions {
    /// Folders that `package://` names and mesh files may come from, besides the URDF's own.
    pub package_dirs: Vec<PathBuf>,
    /// Whether the root link moves freely; its joint is then the first, named `root_joint`.
    pub floating_base: bool,
    /// Joints to hold at a position [rad or m]. Of a joint named twice the last counts.
    pub locked_joints: Vec<(String, f64)>,
    /// Which shapes make the surface.
    pub geometry: UrdfGeometry,
    /// Gravity in the world frame (m/s^2).
    pub gravity: Vector3<f64>,
    /// Rotor inertia, reflected through the gear, of joints by name (kg m^2 or kg); zero for the others.
    pub armature: Vec<(String, f64)>,
    /// What to do about mesh files that are missing.
    pub missing_meshes: MissingMeshes,
}

impl Default for UrdfOptions {
    /// A fixed base, no locked joints, collision geometry, gravity along -z, no armature.
    fn default() -> Self {
        Self {
            package_dirs: Vec::new(),
            floating_base: false,
            locked_joints: Vec::new(),
            geometry: UrdfGeometry::Collision,
            gravity: Vector3::new(0.0, 0.0, -9.81),
            armature: Vec::new(),
            missing_meshes: MissingMeshes::Error,
        }
    }
}
