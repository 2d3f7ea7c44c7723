//! Settings that can be changed between two ticks; bias and external torque stay as they are.

use super::contact_monitor::ContactMonitor;
use super::options::MonitorOptions;
use crate::detection::{check_threshold, check_wrench_threshold};
use crate::error::Result;
use crate::isolation::ContactIsolator;
use crate::sensor::SensorTree;

impl ContactMonitor {
    /// The settings in use.
    pub fn options(&self) -> &MonitorOptions {
        &self.options
    }

    /// The torque thresholds, one per velocity variable (Nm, N).
    pub fn torque_threshold(&self) -> &[f64] {
        self.detector.threshold()
    }

    /// Sets the torque threshold (Nm, N), per velocity variable or one for all.
    ///
    /// A signal that is on stays on for its hold time. The greatest bias follows, as it is counted in thresholds.
    ///
    /// ```
    /// use std::sync::Arc;
    ///
    /// use contactsense::monitor::{ContactMonitor, MonitorOptions};
    /// use contactsense::robot::Robot;
    ///
    /// let mut monitor = ContactMonitor::new(Arc::new(Robot::example_arm()), &MonitorOptions::new(1e-3))?;
    /// monitor.set_torque_threshold(&[2.0])?;
    /// assert!(monitor.set_torque_threshold(&[-1.0]).is_err());
    /// assert_eq!(monitor.torque_threshold(), [2.0; 7]);
    /// # Ok::<(), contactsense::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`crate::Error::Input`] where a threshold is not positive and finite, or their number is wrong; nothing is then
    /// changed.
    pub fn set_torque_threshold(&mut self, threshold: &[f64]) -> Result<()> {
        let mut options = self.options.clone();
        options.isolation.torque_threshold = Some(threshold.to_vec());
        self.set_thresholds(options)
    }

    /// Sets the threshold on the sensors' external wrenches: one number for all (N, Nm), six, or six for each sensor.
    ///
    /// # Errors
    /// As for [`set_torque_threshold`](Self::set_torque_threshold).
    pub fn set_wrench_threshold(&mut self, threshold: &[f64]) -> Result<()> {
        let mut options = self.options.clone();
        options.isolation.wrench_threshold = threshold.to_vec();
        self.set_thresholds(options)
    }

    /// Sets the observer's gain (1/s), per velocity variable or one for all; the external torque goes on from where it is.
    ///
    /// The low-pass on the sensors' wrenches keeps its gain.
    ///
    /// # Errors
    /// [`crate::Error::Input`] where a gain is not positive and finite, or their number is wrong.
    pub fn set_observer_gain(&mut self, gain: &[f64]) -> Result<()> {
        self.observer.set_gain(gain).map_err(|error| error.for_argument("gain", "observer_gain"))?;
        self.options.observer_gain = gain.to_vec();
        Ok(())
    }

    /// The observer's gain, one per velocity variable (1/s).
    pub fn observer_gain(&self) -> &[f64] {
        self.observer.gain()
    }

    fn set_thresholds(&mut self, options: MonitorOptions) -> Result<()> {
        // Everything that may be refused first.
        let (threshold, _) = options.isolation.threshold_and_noise(&self.robot)?;
        let threshold = check_threshold(&self.robot, &threshold)?;
        let tree = SensorTree::new(&self.robot, &options.isolation.sensors)?;
        let wrench_threshold = check_wrench_threshold(&tree, &options.isolation.wrench_threshold)?;
        let rule = options.release_rule(&self.robot, &threshold)?;
        let limit = options.greatest_bias(&threshold)?;
        self.isolator = ContactIsolator::new(self.robot.clone(), &options.isolation)?;
        self.detector.set_thresholds(threshold, wrench_threshold);
        self.release.set_rule(rule);
        if let Some(bias) = &mut self.bias {
            bias.set_limit(limit);
        }
        self.options = options;
        Ok(())
    }
}
