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
}

impl UrdfGeometry {
    /// The element that holds a shape.
    pub(super) fn tag(self) -> &'static str {
        match self {
            UrdfGeometry::Collision => "collision",
            UrdfGeometry::Visual => "visual",
        }
    }
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
///     locked_joints: vec![("left_wrist".into(), Some(0.5))],
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
    /// Joints to hold at a position [rad or m], or at neutral. Of a joint named twice the last counts.
    pub locked_joints: Vec<(String, Option<f64>)>,
    /// Which shapes make the surface.
    pub geometry: UrdfGeometry,
    /// Gravity in the world frame (m/s^2).
    pub gravity: Vector3<f64>,
}

impl Default for UrdfOptions {
    /// A fixed base, no locked joints, collision geometry, gravity along -z.
    fn default() -> Self {
        Self {
            package_dirs: Vec::new(),
            floating_base: false,
            locked_joints: Vec::new(),
            geometry: UrdfGeometry::Collision,
            gravity: Vector3::new(0.0, 0.0, -9.81),
        }
    }
}
