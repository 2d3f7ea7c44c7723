//! Thresholds and gains of a monitor that are read and changed while it runs: bias, observer and signals stay.

use nalgebra::Vector6;

use super::options::of_observer;
use super::source::Source;
use super::{ContactMonitor, MonitorOptions};
use crate::detection::{check_wrench_threshold, Whitening};
use crate::error::{Error, Result};
use crate::isolation::{ContactIsolator, IsolatorOptions};
use crate::sensor::SensorTree;

impl ContactMonitor {
    /// The thresholds on torques `(nv,)` (Nm, N).
    pub fn torque_threshold(&self) -> &[f64] {
        &self.threshold
    }

    /// Other thresholds on torques, in place of a test of all joints at once: one for all velocity variables or one for each (Nm, N). The greatest bias follows them.
    ///
    /// Not for the control loop: it allocates.
    ///
    /// # Errors
    /// [`Error::Input`] as in [`ContactMonitor::new`]; nothing is then changed.
    pub fn set_torque_threshold(&mut self, threshold: &[f64]) -> Result<()> {
        let isolation =
            IsolatorOptions { torque_threshold: Some(threshold.to_vec()), ..self.options.isolation.clone() };
        self.set_isolation(isolation)?;
        if self.test.take().is_some() {
            self.report.significance = None;
        }
        self.detector.set_threshold(self.threshold.clone());
        self.scale = Whitening::of_deviations(&self.threshold);
        Ok(())
    }

    /// The thresholds on each sensor's wrench (N, Nm).
    pub fn wrench_threshold(&self) -> &[Vector6<f64>] {
        self.detector.wrench_threshold()
    }

    /// Other thresholds on wrenches: one number, 6 for every sensor, or 6 times the number of sensors (N, Nm).
    ///
    /// Not for the control loop: it allocates.
    ///
    /// # Errors
    /// [`Error::Input`] as in [`ContactMonitor::new`]; nothing is then changed.
    pub fn set_wrench_threshold(&mut self, threshold: &[f64]) -> Result<()> {
        let isolation =
            IsolatorOptions { wrench_threshold: threshold.to_vec(), ..self.options.isolation.clone() };
        self.set_isolation(isolation)
    }

    /// Everything is checked and made before anything is changed.
    fn set_isolation(&mut self, isolation: IsolatorOptions) -> Result<()> {
        let options = MonitorOptions { isolation, ..self.options.clone() };
        let (threshold, noise) = options.isolation.threshold_and_noise(&self.robot)?;
        let tree = SensorTree::new(&self.robot, &options.isolation.sensors)?;
        let wrench_threshold = check_wrench_threshold(&tree, &options.isolation.wrench_threshold)?;
        let greatest_bias = options.greatest_bias(&threshold)?;
        let rule = options.release_rule(&self.robot, &threshold)?;
        self.isolator = ContactIsolator::new(self.robot.clone(), &options.isolation)?;
        if let Some(bias) = &mut self.bias {
            bias.set_limit(greatest_bias);
        }
        self.release.set_rule(rule);
        self.tracker = options.tracker(&self.robot, (&tree, self.isolator.evidence()), &noise)?;
        self.threshold = threshold;
        self.deviation.copy_from_slice(noise.at_rest());
        self.detector.set_wrench_threshold(wrench_threshold);
        self.options = options;
        Ok(())
    }

    /// The observer's gain `(nv,)` (1/s).
    pub fn observer_gain(&self) -> &[f64] {
        self.observer.gain()
    }

    /// Another gain of the observer, one for all velocity variables or one for each (1/s). The external torque goes on from
    /// where it is; the gain of the wrenches' low-pass follows, unless the options give it.
    ///
    /// # Errors
    /// [`Error::Input`] where a gain is not positive and finite, or their number is wrong; nothing is then changed.
    pub fn set_observer_gain(&mut self, gain: &[f64]) -> Result<()> {
        self.observer.set_gain(gain).map_err(of_observer)?;
        self.options.observer_gain = gain.to_vec();
        self.follow_gains()
    }

    /// The gain of the low-pass on the sensors' external wrenches (1/s), infinite for no low-pass; none without sensors.
    pub fn wrench_gain(&self) -> Option<f64> {
        self.sensing.as_ref().map(|sensing| sensing.wrenches().wrench_gain())
    }

    /// Another gain of that low-pass, as [`MonitorOptions::wrench_gain`]; the wrenches go on from where they are.
    ///
    /// # Errors
    /// [`Error::Input`] where it is not positive; nothing is then changed.
    pub fn set_wrench_gain(&mut self, gain: Option<f64>) -> Result<()> {
        if let Some(gain) = gain.filter(|gain| gain.is_nan() || *gain <= 0.0) {
            return Err(Error::input("wrench_gain", format!("must be positive [1/s], not {gain}")));
        }
        self.options.wrench_gain = gain;
        self.follow_gains()
    }

    fn follow_gains(&mut self) -> Result<()> {
        let Self { sensing, observer, options, free, .. } = self;
        if self.source != Some(Source::External) {
            free.set_gain(|k| observer.gain()[k]);
        }
        let Some(sensing) = sensing else { return Ok(()) };
        sensing.set_gain(observer.gain(), options.wrench_gain)?;
        if self.source == Some(Source::External) {
            sensing.follow_without_lag();
        }
        Ok(())
    }
}
