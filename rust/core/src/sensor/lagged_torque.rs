//! The observer's low-pass for what sensors see at once (the filter of Vorndamme 2017, fig. 4).

use nalgebra::Vector6;

use super::exclusion::sensor_torque;
use super::sensor_tree::SensorTree;
use crate::robot::{Kinematics, Robot};

/// Each sensor's `J(S)^T F_ext,S`, now and as the momentum observer knows it by now.
#[derive(Debug, Clone)]
pub struct LaggedTorques {
    /// `exp(-gain dt)` per velocity variable.
    decay: Vec<f64>,
    now: Vec<Vec<f64>>,
    before: Vec<Vec<f64>>,
    lagged: Vec<Vec<f64>>,
    known: Vec<bool>,
    started: bool,
}

impl LaggedTorques {
    /// For the sensors of a tree, the observer's gain `(nv,)` [1/s] and its time step [s].
    pub fn new(sensors: usize, gain: &[f64], dt: f64) -> Self {
        let rows = vec![vec![0.0; gain.len()]; sensors];
        Self {
            decay: gain.iter().map(|gain| (-gain * dt).exp()).collect(),
            now: rows.clone(),
            before: rows.clone(),
            lagged: rows,
            known: vec![false; sensors],
            started: false,
        }
    }

    /// A tick begins: what was now is before.
    pub fn step(&mut self) {
        std::mem::swap(&mut self.now, &mut self.before);
    }

    /// Takes in a tick's external wrenches, NaN where a sensor is left out; may be repeated within a tick until
    /// [`LaggedTorques::commit`].
    pub fn set(
        &mut self,
        robot: &Robot,
        kinematics: &Kinematics,
        tree: &SensorTree,
        wrenches: &[Vector6<f64>],
    ) {
        for (sensor, wrench) in wrenches.iter().enumerate() {
            if is_known(wrench) {
                sensor_torque(robot, kinematics, tree, sensor, wrench, &mut self.now[sensor]);
            }
        }
    }

    /// The tick's last wrenches were set: moves the low-pass on, by the observer's step. A sensor that comes back is
    /// taken to have stood still meanwhile.
    pub fn commit(&mut self, wrenches: &[Vector6<f64>]) {
        for (sensor, wrench) in wrenches.iter().enumerate() {
            let known = is_known(wrench);
            if known && self.known[sensor] {
                for k in 0..self.decay.len() {
                    self.lagged[sensor][k] = self.next(sensor, k);
                }
            } else if known && self.started {
                self.lagged[sensor].copy_from_slice(&self.now[sensor]);
            }
            self.known[sensor] = known;
        }
        self.started = true;
    }

    /// Adds what a sensor sees beyond what the observer knows, before [`LaggedTorques::commit`].
    pub fn add_ahead(&self, sensor: usize, torque: &mut [f64]) {
        if self.known[sensor] || !self.started {
            for (k, torque) in torque.iter_mut().enumerate() {
                let lagged = if self.known[sensor] { self.next(sensor, k) } else { 0.0 };
                *torque += self.now[sensor][k] - lagged;
            }
        }
    }

    /// A sensor's torque as the observer knows it `(nv,)`.
    pub fn lagged(&self, sensor: usize) -> &[f64] {
        &self.lagged[sensor]
    }

    /// Forgets all ticks.
    pub fn reset(&mut self) {
        self.lagged.iter_mut().for_each(|row| row.fill(0.0));
        self.known.fill(false);
        self.started = false;
    }

    /// The observer's step: exact for a torque that is constant, second-order for one that is not.
    fn next(&self, sensor: usize, k: usize) -> f64 {
        let mean = 0.5 * (self.now[sensor][k] + self.before[sensor][k]);
        mean + self.decay[k] * (self.lagged[sensor][k] - mean)
    }
}

/// Whether a sensor gave a reading.
pub(crate) fn is_known(wrench: &Vector6<f64>) -> bool {
    !wrench[0].is_nan()
}
