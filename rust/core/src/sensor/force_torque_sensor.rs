//! A six-axis force/torque sensor.

use crate::spatial::Pose;

/// Which side's wrench a reading is.
///
/// ```
/// use contactsense::sensor::Convention;
///
/// assert_eq!(Convention::default(), Convention::Load);
/// assert_eq!(Convention::Support.sign() * 3.0, -3.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Convention {
    /// What the distal side exerts on the sensor: a free hand at rest reads its weight.
    #[default]
    Load,
    /// What the sensor exerts on the distal side: the opposite.
    Support,
}

impl Convention {
    /// The convention's name in Python.
    pub fn name(self) -> &'static str {
        match self {
            Convention::Load => "load",
            Convention::Support => "support",
        }
    }

    /// The factor that turns a reading into what the distal side exerts.
    #[inline]
    pub fn sign(self) -> f64 {
        match self {
            Convention::Load => 1.0,
            Convention::Support => -1.0,
        }
    }
}

/// A sensor where a link joins its parent: the link and all behind it load the sensor.
///
/// A reading is (force, moment) about the sensor frame's origin, in that frame's axes (N, Nm).
///
/// ```
/// use contactsense::sensor::{Convention, ForceTorqueSensor};
/// use contactsense::spatial::Pose;
///
/// let sensor = ForceTorqueSensor {
///     name: "wrist".into(),
///     link: "link_7".into(),
///     pose: Pose::identity(),
///     convention: Convention::Load,
/// };
/// assert_eq!(sensor.pose.check_rigid(), Ok(()));
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct ForceTorqueSensor {
    /// Unique name.
    pub name: String,
    /// Name of the link.
    pub link: String,
    /// The sensor frame in the link's frame.
    pub pose: Pose,
    /// What a reading means.
    pub convention: Convention,
}
