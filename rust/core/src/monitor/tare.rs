//! What an untouched robot reads becomes zero.

use nalgebra::Vector6;

use super::contact_monitor::ContactMonitor;
use super::source::Source;
use crate::detection::ContactTest;
use crate::error::{Error, Result};

/// Observers have forgotten a start after so many time constants.
const SETTLED: f64 = 5.0;
impl ContactMonitor {
    /// The robot is untouched and at rest: from the next tick on, what it reads here is zero. The offsets of the sensors and
    /// the bias become what the last 0.25 s showed; a sensor without readings keeps its offset. Both last as long as a
    /// bias and an offset that were given or learnt: [`ContactMonitor::reset`] forgets the bias, not the offsets.
    ///
    /// A contact that has been reported ever since the first call or a reset may be a bias or an offset, and is tared away.
    /// Not for the control loop: it allocates.
    ///
    /// # Errors
    /// [`Error::Input`] before the observers know the torque, during a contact that began after a time without, and for a bias
    /// beyond `bias_limit`; nothing is then changed.
    ///
    /// ```
    /// use std::sync::Arc;
    ///
    /// use contactsense::monitor::{ContactMonitor, MonitorOptions};
    /// use contactsense::robot::Robot;
    /// use contactsense::Sample;
    ///
    /// let mut monitor = ContactMonitor::new(Arc::new(Robot::example_arm()), &MonitorOptions::new(1e-3))?;
    /// assert!(monitor.tare().is_err());
    /// let upright = [0.0; 7];
    /// for _ in 0..200 {
    ///     monitor.update(&Sample::new(&upright, &upright, &[0.3; 7]))?;
    /// }
    /// monitor.tare()?;
    /// let report = monitor.update(&Sample::new(&upright, &upright, &[0.3; 7]))?;
    /// assert!(report.external_torque.iter().all(|torque| torque.abs() < 1e-3));
    /// assert!((monitor.bias().unwrap()[0] + 0.3).abs() < 1e-3);
    /// # Ok::<(), contactsense::Error>(())
    /// ```
    pub fn tare(&mut self) -> Result<()> {
        let settling = self.settling();
        if self.detector.collision() && self.rest.free {
            return Err(refuse(format!(
                "there is a contact; if nothing touches the robot, call reset() and updates for {settling:.2} s first"
            )));
        }
        if self.rest.since <= settling {
            return Err(refuse(format!(
                "the torques of the untouched robot are not known yet; call updates without contact for {settling:.2} s \
                 first"
            )));
        }
        let limit = self.options.greatest_bias(&self.threshold)?;
        let torque = &self.rest.torque;
        if let Some(k) = (0..torque.len()).find(|k| torque[*k].abs() > limit[*k]) {
            return Err(refuse(format!(
                "the external torque of velocity variable {k} is {:.3} [Nm, N], beyond the {:.3} that bias_limit allows; \
                 check the model, the tool and the sign of the torques",
                torque[k], limit[k]
            )));
        }
        match (&mut self.test, &mut self.bias) {
            (Some(test), _) => test.slow_mut().tare(torque),
            (None, Some(bias)) => bias.tare(torque),
            (None, None) => self.fixed_bias = Some(torque.clone()),
        }
        if let Some(sensing) = &mut self.sensing {
            for (sensor, (reading, since)) in self.rest.wrenches.iter_mut().enumerate() {
                if *since > settling {
                    sensing.add_offset(sensor, reading);
                    *reading = Vector6::zeros();
                }
            }
            self.options.isolation.sensors = sensing.tree().sensors().to_vec();
        }
        self.rest.free = false;
        self.detector.reset();
        self.release.reset();
        Ok(())
    }

    /// Takes in what a step of `length` (s) with a new torque read; `detected` is false while nothing is detected yet.
    #[inline]
    pub(super) fn note_rest(&mut self, length: f64, detected: bool) {
        let settling = self.settling();
        let sensing = self.sensing.as_ref().map(|sensing| (sensing, self.observer.kinematics()));
        // A contact that began is left out; one that has been there from the start may be none.
        if self.detector.collision() && self.rest.free {
            return self.rest.restart();
        }
        let torque = self.observer.external_torque();
        self.rest.update(torque, sensing, settling, length);
        self.rest.free |= detected && self.rest.since > settling && !self.detector.collision();
    }

    /// After which time a start is forgotten (s).
    #[inline]
    fn settling(&self) -> f64 {
        let external = self.source == Some(Source::External);
        let of_observer = self.observer.gain().iter().filter(|_| !external);
        let of_test = self.test.as_ref().map_or(&[][..], ContactTest::gains);
        let of_wrenches = self.sensing.as_ref().map(|sensing| sensing.wrenches().wrench_gain());
        let gains = of_observer.chain(of_test).copied().chain(of_wrenches);
        SETTLED / gains.fold(f64::INFINITY, f64::min)
    }
}

#[cold]
fn refuse(problem: String) -> Error {
    Error::input("tare", problem)
}
