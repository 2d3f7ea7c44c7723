//! Options of the isolator.

use crate::error::{Error, Result};
use crate::sensor::ForceTorqueSensor;

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
/// let options = IsolatorOptions { torque_threshold: vec![0.5], max_contacts: 2, ..IsolatorOptions::default() };
/// let mut isolator = ContactIsolator::new(robot, &options)?;
/// // No joint feels more than its threshold.
/// assert!(isolator.isolate(&[0.4; 7], &[0.3; 7])?.contacts.is_empty());
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct IsolatorOptions {
    /// Per velocity variable, or one for all (Nm, N). Also the scale of the torques' errors.
    pub torque_threshold: Vec<f64>,
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
}

impl Default for IsolatorOptions {
    fn default() -> Self {
        Self {
            torque_threshold: vec![1e-3],
            max_contacts: 5,
            pushing: true,
            sensors: vec![],
            wrench_threshold: vec![1e-3],
            wanted_contacts: vec![],
            locate_within: LOCATE_WITHIN,
        }
    }
}

impl IsolatorOptions {
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
