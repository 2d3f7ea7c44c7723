//! A robot from a URDF file: the same robot as the Python package's loader gives, without Python.
//!
//! Order and meaning of joints, bodies and links are Pinocchio's.

mod build;
mod checked;
mod element;
mod for_pinocchio;
mod joints;
mod lock;
mod meshes;
mod options;
mod shapes;
mod text;
mod tree;
mod xml;

#[cfg(test)]
mod tests;

use std::path::Path;

pub use for_pinocchio::CheckedUrdf;
pub use options::{MissingMeshes, UrdfGeometry, UrdfOptions};

use self::checked::Checked;
use crate::error::{Error, Result};
use crate::robot::description::RobotDescription;
use crate::robot::Robot;

/// Reads a URDF file.
///
/// Joints are ordered as in the Pinocchio model of the same file: depth-first, a link's child joints by name. A body
/// is all that is fixed to one joint, also through locked joints; what is fixed to the world has no inertia. Links
/// come depth-first and keep their frames. Mimic joints stay independent. Mesh files come from the URDF's folder and
/// `package_dirs` only, symbolic links resolved.
///
/// # Errors
/// [`Error::Model`] for the file and its links and joints, [`Error::Geometry`] for shapes and mesh files,
/// [`Error::Input`] for the options; each names the element and says what would be right.
///
/// # Example
/// ```
/// use contactsense::load::{from_urdf, UrdfOptions};
///
/// let urdf = r#"
///     <robot name="pendulum">
///       <link name="base"/>
///       <link name="rod">
///         <inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
///         <collision><geometry><cylinder radius="0.02" length="0.5"/></geometry></collision>
///       </link>
///       <joint name="hinge" type="continuous">
///         <parent link="base"/><child link="rod"/><axis xyz="0 1 0"/>
///       </joint>
///     </robot>"#;
/// let path = std::env::temp_dir().join(format!("contactsense_pendulum_{}.urdf", std::process::id()));
/// std::fs::write(&path, urdf).expect("a folder for temporary files");
/// let description = from_urdf(&path, &UrdfOptions::default())?;
/// assert_eq!(description.joints[0].name, "hinge");
/// assert_eq!(description.links[1].geometry.len(), 1);
/// # std::fs::remove_file(&path).expect("it is there");
/// # Ok::<(), contactsense::Error>(())
/// ```
pub fn from_urdf(path: impl AsRef<Path>, options: &UrdfOptions) -> Result<RobotDescription> {
    let path = path.as_ref();
    read(path, options).map_err(|error| error.in_file(path))
}

fn read(path: &Path, options: &UrdfOptions) -> Result<RobotDescription> {
    if !options.gravity.iter().all(|x| x.is_finite()) {
        let text = format!("must be 3 finite numbers [m/s^2], not {:?}", options.gravity.as_slice());
        return Err(Error::input("gravity", text));
    }
    let Checked { name, robot, mut warnings, .. } = checked::read(path, options)?;
    let visits = tree::visits(&robot, options.floating_base)?;
    let locked = lock::by_joint(&robot, "locked_joints", &options.locked_joints)?;
    let armature = lock::by_joint(&robot, "armature", &options.armature)?;
    warnings.extend(lock::outside_limits(&robot, &locked));
    let mut description = build::bodies(&robot, &visits, &locked, options.floating_base);
    for joint in &mut description.joints {
        let given = armature.iter().find(|(name, _)| *name == joint.name);
        joint.armature = given.map_or(0.0, |(_, value)| *value);
    }
    for (link, visit) in description.links.iter_mut().zip(&visits) {
        link.geometry = shapes::parts(&robot.links[visit.link])?;
    }
    Ok(RobotDescription { name, gravity: options.gravity, warnings, ..description })
}

impl Robot {
    /// A robot from a URDF file; see [`from_urdf`].
    ///
    /// # Errors
    /// As [`from_urdf`] and [`Robot::new`].
    pub fn from_urdf(path: impl AsRef<Path>, options: &UrdfOptions) -> Result<Robot> {
        let path = path.as_ref();
        Robot::new(from_urdf(path, options)?).map_err(|error| error.in_file(path))
    }
}
