//! A tick with the vendor's external torque in place of the observer's.

use super::contact_monitor::ContactMonitor;
use super::report::ContactReport;
use super::source::Source;
use crate::error::{Error, Result};
use crate::observer::Step;
use crate::sample::ExternalSample;

impl ContactMonitor {
    /// One control tick with an external torque that the robot's own controller estimates, as those of Franka, KUKA and
    /// Doosan do: it takes the place of the observer's and is reported as it comes, free of bias. No mass of the model
    /// matters but for the sensors' loads. With a calibration of such torques, all joints are tested at once behind the
    /// low-passes of [`ContactMonitor::update`].
    ///
    /// Time, checks and sensors are as in [`ContactMonitor::update`]; a torque after a gap is known at once. The acceleration
    /// is not known: NaN.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the argument; the state is then unchanged but for the time that passed. One monitor
    /// takes torques of one source: another is refused until [`ContactMonitor::reset`].
    ///
    /// ```
    /// use std::sync::Arc;
    ///
    /// use contactsense::monitor::{ContactMonitor, MonitorOptions};
    /// use contactsense::robot::Robot;
    /// use contactsense::ExternalSample;
    ///
    /// let mut monitor = ContactMonitor::new(Arc::new(Robot::example_arm()), &MonitorOptions::new(1e-3))?;
    /// let q = [0.4; 7];
    /// assert!(!monitor.update_external(&ExternalSample::new(&q, &[0.1; 7]))?.collision);
    /// assert!(monitor.update_external(&ExternalSample::new(&q, &[3.0; 7]))?.collision);
    /// # Ok::<(), contactsense::Error>(())
    /// ```
    pub fn update_external(&mut self, sample: &ExternalSample<'_>) -> Result<&ContactReport> {
        if let Err(error) = self.check_external(sample) {
            self.miss(sample.dt);
            return Err(error);
        }
        if self.source.replace(Source::External).is_none() {
            self.free.set_gain(|_| f64::INFINITY);
            if let Some(sensing) = &mut self.sensing {
                sensing.follow_without_lag();
            }
        }
        let step = self.clock.step(sample.dt);
        self.limits.set_configuration(sample.q);
        self.observer.follow(sample, step.is_gap() || !self.clock.started());
        self.note_motion(sample.q, step);
        self.clock.accept(sample.dt);
        self.sense(sample.wrenches, step);
        let known = if step.is_gap() { Step::Of(step.length(self.clock.dt())) } else { step };
        Ok(self.judge(known, true))
    }

    fn check_external(&self, sample: &ExternalSample<'_>) -> Result<()> {
        self.check_source(Source::External)?;
        self.check_readings(sample.wrenches)?;
        sample.check(&self.robot)
    }

    /// Whether torques of a source can be taken in.
    pub(super) fn check_source(&self, source: Source) -> Result<()> {
        let external = self.options.calibration.as_ref().map(|calibration| calibration.torque_is_external);
        let problem = match (source, self.source) {
            (Source::Motors, Some(Source::External)) => {
                "the monitor runs on external torques, of update_external; call reset() before torques of the motors"
            }
            (Source::External, Some(Source::Motors)) => {
                "the monitor runs on torques of the motors, of update; call reset() before external torques"
            }
            _ if source == Source::Motors && external == Some(true) => {
                "the calibration is of external torques; use update_external, or calibrate with torques of the motors"
            }
            _ if source == Source::External && external == Some(false) => {
                "the calibration is of torques of the motors; use update, or calibrate with external torques"
            }
            _ => return Ok(()),
        };
        Err(Error::input(source.argument(), problem))
    }

    /// The next torques may come from another source.
    pub(super) fn forget_source(&mut self) {
        if self.source.take() != Some(Source::External) {
            return;
        }
        let gain = self.observer.gain();
        self.free.set_gain(|k| gain[k]);
        if let Some(sensing) = &mut self.sensing {
            sensing.follow_gain(gain);
        }
    }
}
