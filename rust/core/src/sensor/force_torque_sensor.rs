//! A six-axis force/torque sensor.

use nalgebra::Vector6;

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
///
/// let sensor = ForceTorqueSensor {
///     convention: Convention::Support,
///     offset: [0.0, 0.0, -12.0, 0.0, 0.0, 0.3],
///     ..ForceTorqueSensor::new("wrist", "link_7")
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
    /// Subtracted from readings before all else: what the sensor reads without load (N, Nm).
    #[cfg_attr(feature = "serde", serde(default))]
    pub offset: [f64; 6],
}

impl ForceTorqueSensor {
    /// A sensor in the link's frame that reads the load and is without offset.
    pub fn new(name: impl Into<String>, link: impl Into<String>) -> Self {
        ForceTorqueSensor {
            name: name.into(),
            link: link.into(),
            pose: Pose::identity(),
            convention: Convention::default(),
            offset: [0.0; 6],
        }
    }

    /// A reading without the offset: force and moment that the distal side exerts, sensor axes.
    #[inline]
    pub(crate) fn exerted(&self, reading: &[f64; 6]) -> Vector6<f64> {
        (Vector6::from(*reading) - Vector6::from(self.offset)) * self.convention.sign()
    }
}
