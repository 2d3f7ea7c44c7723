//! Options of the isolator.

use std::sync::Arc;

use super::contact_evidence::ContactEvidence;
use super::surface_contact::SurfaceContact;
use crate::detection::check_threshold;
use crate::error::{Error, Result};
use crate::map::MapOptions;
use crate::robot::Robot;
use crate::sensor::{ForceTorqueSensor, SensorTree};
use crate::torque::{NoiseModel, TorqueNoise, LEVEL};

/// Default of [`IsolatorOptions::locate_within`]: about the width of a hand's contact (m).
const LOCATE_WITHIN: f64 = 0.05;

/// Settings of a [`ContactIsolator`](super::ContactIsolator).
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::isolation::{ContactIsolator, IsolatorOptions};
/// use contactsense::robot::Robot;
///
/// let robot = Arc::new(Robot::example_arm());
/// let options = IsolatorOptions { torque_threshold: Some(vec![0.5]), max_contacts: 2, ..IsolatorOptions::default() };
/// let mut isolator = ContactIsolator::new(robot, &options)?;
/// // No joint feels more than its threshold.
/// assert!(isolator.isolate(&[0.4; 7], &[0.3; 7])?.contacts.is_empty());
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct IsolatorOptions {
    /// A torque is felt above it: per velocity variable, or one for all (Nm, N). None for three standard deviations of
    /// `noise` at rest.
    // Without this a file that leaves it out would mean None.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "serde::Deserialize::deserialize"))]
    pub torque_threshold: Option<Vec<f64>>,
    /// Errors of the torques. None for a third of the thresholds, and a hundredth of the torque.
    pub noise: Option<NoiseModel>,
    /// Contacts reported at most.
    pub max_contacts: usize,
    /// Whether forces push on the surface (they may pull otherwise, and the point stays open).
    pub pushing: bool,
    /// Force/torque sensors, in the order of the wrenches.
    pub sensors: Vec<ForceTorqueSensor>,
    /// On the sensors' wrenches: one number, 6 for every sensor, or 6 times the number of sensors (N, Nm).
    pub wrench_threshold: Vec<f64>,
    /// Names of the sensors whose contacts are meant and not reported (eq. 20).
    pub wanted_contacts: Vec<String>,
    /// A contact is located if 90 % of the places that explain the torques are within this distance of its point (m).
    pub locate_within: f64,
    /// Samples of the surface by which a single contact is judged, where the torques have noise (3 mNm or more); zero for closed forms
    /// only.
    #[cfg_attr(feature = "serde", serde(default = "samples"))]
    pub samples: usize,
    /// Probability that a contact pulls on the surface.
    #[cfg_attr(feature = "serde", serde(default = "pull_probability"))]
    pub pull_probability: f64,
}

/// Enough for centimetres on an arm: pieces that matter are divided.
pub(crate) const SAMPLES: usize = 1000;

/// Torques with a smaller standard deviation than any sensor's are simulated (Nm): closed forms use all that they tell, and samples
/// of the surface would have to be finer than it is.
const IDEAL: f64 = 3e-3;

#[cfg(feature = "serde")]
pub(crate) fn samples() -> usize {
    SAMPLES
}

#[cfg(feature = "serde")]
fn pull_probability() -> f64 {
    MapOptions::default().pull_probability
}

impl Default for IsolatorOptions {
    fn default() -> Self {
        Self {
            torque_threshold: Some(vec![1e-3]),
            noise: None,
            max_contacts: 5,
            pushing: true,
            sensors: vec![],
            wrench_threshold: vec![1e-3],
            wanted_contacts: vec![],
            locate_within: LOCATE_WITHIN,
            samples: SAMPLES,
            pull_probability: MapOptions::default().pull_probability,
        }
    }
}

/// What torques err by relative to a contact's own, where thresholds are all that is given.
const RELATIVE_NOISE: f64 = 0.01;

impl IsolatorOptions {
    /// The thresholds on torques, and what these err by.
    ///
    /// # Errors
    /// [`Error::Input`] names the option.
    pub(crate) fn threshold_and_noise(&self, robot: &Robot) -> Result<(Vec<f64>, TorqueNoise)> {
        let given = self.torque_threshold.as_ref().map(|given| check_threshold(robot, given)).transpose()?;
        let noise = match (&self.noise, &given) {
            (Some(noise), _) => noise.of(robot)?,
            (None, Some(threshold)) => {
                let deviation = threshold.iter().map(|threshold| threshold / LEVEL).collect();
                NoiseModel::short(deviation, RELATIVE_NOISE).of(robot)?
            }
            (None, None) => NoiseModel::default().of(robot)?,
        };
        Ok((given.unwrap_or_else(|| noise.threshold()), noise))
    }

    /// What judges a contact by all surface; none where closed forms answer alone.
    ///
    /// # Errors
    /// [`Error::Input`] names the option.
    pub(super) fn surface(
        &self,
        robot: &Arc<Robot>,
        sensed: (&SensorTree, &ContactEvidence),
        noise: &TorqueNoise,
    ) -> Result<Option<SurfaceContact>> {
        let Self { samples, pull_probability, .. } = *self;
        let ideal = noise.at_rest().iter().all(|deviation| *deviation < IDEAL);
        if samples == 0 || !self.pushing || ideal {
            return Ok(None);
        }
        let options = MapOptions { samples, pull_probability, ..MapOptions::default() };
        SurfaceContact::new(Arc::clone(robot), &options, sensed, noise.clone(), self.locate_within)
    }

    /// # Errors
    /// [`Error::Input`] names the option.
    pub(super) fn check(&self) -> Result<()> {
        if self.max_contacts == 0 {
            return Err(Error::input("max_contacts", "must be at least 1"));
        }
        if !(self.locate_within > 0.0 && self.locate_within.is_finite()) {
            return Err(Error::input(
                "locate_within",
                format!("must be positive and finite [m], not {}", self.locate_within),
            ));
        }
        Ok(())
    }
}
