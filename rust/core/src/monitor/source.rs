//! Where a monitor's torques come from: the motors, or a vendor's estimate of the external torque.

use super::options::MonitorOptions;
use crate::calibration::Calibration;

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
    pub fn argument(self) -> &'static str {
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
