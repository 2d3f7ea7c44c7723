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

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Vector3, Vector6};

    use super::{LaggedTorques, SensorTree};
    use crate::robot::{JointDescription, JointKind, Kinematics, LinkDescription, Robot, RobotDescription};
    use crate::sensor::{Convention, ForceTorqueSensor};
    use crate::spatial::Pose;

    const DT: f64 = 1e-3;
    const GAIN: f64 = 100.0;

    /// A prismatic joint along x: the torque of a wrench is its first component.
    fn slide() -> (Robot, SensorTree, Kinematics) {
        let joint = JointDescription {
            name: "slide".into(),
            parent: 0,
            kind: JointKind::Prismatic,
            axis: Vector3::x(),
            placement: Pose::identity(),
            mass: 1.0,
            com: Vector3::zeros(),
            inertia: Matrix3::identity(),
            armature: 0.0,
        };
        let link = |name: &str, joint, parent| LinkDescription {
            name: name.into(),
            joint,
            placement: Pose::identity(),
            parent,
            mass: 0.0,
            com: Vector3::zeros(),
            inertia: Matrix3::zeros(),
            geometry: vec![],
        };
        let robot = Robot::new(RobotDescription {
            name: "slide".into(),
            joints: vec![joint],
            links: vec![link("base", 0, None), link("carriage", 1, Some(0))],
            gravity: Vector3::zeros(),
            warnings: vec![],
        })
        .expect("a valid description");
        let sensor = ForceTorqueSensor {
            name: "S".into(),
            link: "carriage".into(),
            pose: Pose::identity(),
            convention: Convention::Load,
        };
        let tree = SensorTree::new(&robot, &[sensor]).expect("a valid sensor");
        let mut kinematics = Kinematics::new(&robot);
        kinematics.set_configuration(&robot, &[0.0]);
        (robot, tree, kinematics)
    }

    fn follow(forces: &[f64]) -> Vec<f64> {
        let (robot, tree, kinematics) = slide();
        let mut lag = LaggedTorques::new(1, &[GAIN], DT);
        forces
            .iter()
            .map(|force| {
                let wrench = [Vector6::new(*force, 3.0, 0.0, 0.0, 0.0, 0.0)];
                lag.step();
                lag.set(&robot, &kinematics, &tree, &wrench);
                lag.commit(&wrench);
                lag.lagged(0)[0]
            })
            .collect()
    }

    #[test]
    fn it_is_the_observers_low_pass() {
        let rate = 50.0;
        let forces: Vec<f64> = (0..200).map(|k| 10.0 * (rate * DT * k as f64).sin()).collect();
        let lagged = follow(&forces);
        // Response of 1 / (1 + s / gain) from rest.
        let share = GAIN / (GAIN * GAIN + rate * rate);
        for (k, lagged) in lagged.iter().enumerate() {
            let t = DT * k as f64;
            let steady = GAIN * (rate * t).sin() - rate * (rate * t).cos();
            let expected = 10.0 * share * (steady + rate * (-GAIN * t).exp());
            assert!((lagged - expected).abs() < 0.01, "{k}: {lagged} {expected}");
        }
    }

    #[test]
    fn after_a_gap_it_starts_where_the_sensor_is() {
        let mut forces = vec![10.0; 100];
        forces[30..50].fill(f64::NAN);
        forces[50..].fill(20.0);
        let lagged = follow(&forces);
        assert!((lagged[29] - lagged[40]).abs() < 1e-12, "held in the gap");
        assert!((lagged[50] - 20.0).abs() < 1e-12 && (lagged[99] - 20.0).abs() < 1e-12);
    }
}
