//! Where a monitor's torques come from: the motors, or a vendor's estimate of the external torque.

use super::contact_monitor::ContactMonitor;
use super::options::MonitorOptions;
use crate::calibration::Calibration;
use crate::error::{Error, Result};

/// Of the torques that a monitor is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Source {
    /// The observer finds the external torque.
    Motors,
    /// It is given.
    External,
}

impl Source {
    /// The argument that brings the torque.
    fn argument(self) -> &'static str {
        match self {
            Source::Motors => "tau",
            Source::External => "tau_ext",
        }
    }
}

/// An observer this fast (1/s) hands each sample on as it is.
const UNFILTERED: f64 = 1e9;

/// Options and gain `(nv,)` that say what noise the reported torque has: an external torque that is given passes no observer,
/// and each sample of it has all its noise.
pub(super) fn signal_of(options: &MonitorOptions, gain: &[f64]) -> (MonitorOptions, Vec<f64>) {
    let mut options = options.clone();
    let Some(Calibration { noise, .. }) = options.calibration.as_mut().filter(|it| it.torque_is_external)
    else {
        return (options, gain.to_vec());
    };
    // The fastest observer still averages the torques at both ends of a step.
    noise.torque.iter_mut().for_each(|deviation| *deviation *= std::f64::consts::SQRT_2);
    // What noise of velocities does to the vendor's torque is part of the white noise.
    noise.velocity = vec![0.0];
    (options, vec![UNFILTERED; gain.len()])
}

impl ContactMonitor {
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
