//! Options of a map, and checks of them.

use crate::error::{Error, Result};
use crate::robot::Robot;
use crate::torque::{ForceModel, ForcePrior, NoiseModel};

/// Options of a [`ContactMap`](super::ContactMap).
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::map::{ContactMap, MapOptions};
/// use contactsense::robot::Robot;
///
/// let robot = Arc::new(Robot::example_arm());
/// let options = MapOptions { samples: 500, friction: 0.3, ..MapOptions::default() };
/// assert!(ContactMap::new(robot.clone(), &options).is_ok());
/// assert!(ContactMap::new(robot, &MapOptions { samples: 0, ..options }).is_err());
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct MapOptions {
    /// Samples of the surface, over all links.
    pub samples: usize,
    /// Coefficient of friction.
    pub friction: f64,
    /// Errors of the torques.
    pub noise: NoiseModel,
    /// Names of the links to look on; all that move and have a surface by default.
    pub links: Option<Vec<String>>,
    /// Probability that a contact pulls on the surface.
    pub pull_probability: f64,
}

impl Default for MapOptions {
    fn default() -> Self {
        MapOptions {
            samples: 5_000,
            friction: 0.5,
            noise: NoiseModel::default(),
            links: None,
            pull_probability: 0.05,
        }
    }
}

/// A contact's normal force lies between these (N): from what the best torque sensors show to what stops a robot.
pub(crate) const LEAST_FORCE: f64 = 2.0;
pub(crate) const GREATEST_FORCE: f64 = 300.0;
/// As many samples at most.
const MOST_SAMPLES: usize = 1_000_000;

impl MapOptions {
    /// Indices of the links to look on.
    ///
    /// # Errors
    /// [`Error::Input`] names the option.
    pub(crate) fn check(&self, robot: &Robot) -> Result<Vec<usize>> {
        if !(1..=MOST_SAMPLES).contains(&self.samples) {
            return Err(Error::input(
                "samples",
                format!("must be a whole number from 1 to {MOST_SAMPLES}, got {}", self.samples),
            ));
        }
        ForceModel::FrictionCone(self.friction).check()?;
        if !(0.0..1.0).contains(&self.pull_probability) {
            return Err(Error::input(
                "pull_probability",
                format!("must be a probability less than one, got {}", self.pull_probability),
            ));
        }
        robot.contact_links(self.links.as_deref(), "a contact map")
    }

    pub(super) fn prior(&self) -> ForcePrior {
        ForcePrior::new(self.friction, [LEAST_FORCE, GREATEST_FORCE], self.pull_probability)
    }
}
