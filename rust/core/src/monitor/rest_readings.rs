//! Means of what a robot reads while nothing touches it.

use nalgebra::Vector6;

use super::sensing::Sensing;
use crate::robot::Kinematics;

/// What is read is averaged over this time (s): longer than noise, shorter than a person waits.
const MEAN_TIME: f64 = 0.25;

/// Means of what is read while nothing touches.
#[derive(Debug, Clone)]
pub(super) struct RestReadings {
    /// Since the start or the end of a contact, gaps left out (s).
    pub since: f64,
    /// The external torque, bias included `(nv,)`.
    pub torque: Vec<f64>,
    /// By sensor: the external wrench as it adds to a reading, and for how long it was read (s).
    pub wrenches: Vec<(Vector6<f64>, f64)>,
    /// Whether there was no contact since the start.
    pub free: bool,
}

impl RestReadings {
    pub fn new(nv: usize, sensors: usize) -> Self {
        RestReadings {
            since: 0.0,
            torque: vec![0.0; nv],
            wrenches: vec![(Vector6::zeros(), 0.0); sensors],
            free: false,
        }
    }

    /// Takes in a step of `length` (s) without contact; `settling` (s) after the start the torque is known.
    #[inline]
    pub fn update(
        &mut self,
        torque: &[f64],
        sensing: Option<(&Sensing, &Kinematics)>,
        settling: f64,
        length: f64,
    ) {
        let share = |since: f64| length / (since - settling).min(MEAN_TIME).max(length);
        self.since += length;
        if self.since > settling {
            let share = share(self.since);
            self.torque.iter_mut().zip(torque).for_each(|(mean, torque)| *mean += share * (torque - *mean));
        }
        let Some((sensing, kinematics)) = sensing else { return };
        for (sensor, (mean, since)) in self.wrenches.iter_mut().enumerate() {
            let Some(reading) = sensing.external_reading(kinematics, sensor) else {
                *since = 0.0;
                continue;
            };
            *since += length;
            if *since > settling {
                *mean += (reading - *mean) * share(*since);
            }
        }
    }

    /// Forgets all steps.
    pub fn reset(&mut self) {
        self.restart();
        self.free = false;
    }

    /// Begins the means anew.
    pub fn restart(&mut self) {
        self.since = 0.0;
        self.wrenches.iter_mut().for_each(|(_, since)| *since = 0.0);
    }
}
