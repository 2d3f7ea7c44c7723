//! What the signals of one instant say of wrenches: a row for every joint torque, all about one reference point.

use nalgebra::Vector6;

use super::region::Region;
use super::wrench::{WrenchEstimate, ORIGIN};
use super::wrench_rows::WrenchRows;
use crate::robot::jacobian::jacobian_column;
use crate::robot::{Kinematics, Robot};
use crate::torque::{largest, TorqueNoise, LEVEL};

/// A joint that feels less than this feels nothing, if the torques are exact (tolerances).
pub(super) const SILENT: f64 = 1e-5;
/// Force/torque sensors err by a part of what they measure, too: three standard deviations, as the threshold is.
pub(super) const SENSOR_SHARE: f64 = 0.03;

/// Columns of the Jacobian about the kinematics' origin, torques and their tolerances, by velocity variable.
#[derive(Debug, Clone)]
pub(super) struct TorqueRows {
    pub axes: Vec<Vector6<f64>>,
    /// What is not explained yet.
    pub torque: Vec<f64>,
    /// The threshold, widened by a share of the torque.
    pub tolerance: Vec<f64>,
    /// The total wrench where a sensor gives it.
    pub root: Option<Root>,
}

/// A sensor's wrench, component by component.
#[derive(Debug, Clone, Copy)]
pub(super) struct Root {
    /// What each component says of a wrench about the origin.
    pub axes: [Vector6<f64>; 6],
    pub value: [f64; 6],
    pub tolerance: [f64; 6],
    /// What the tolerance is without its share of the wrench.
    pub threshold: [f64; 6],
}

impl Root {
    /// The same with the thresholds for tolerances.
    pub fn narrow(&self) -> Self {
        Self { tolerance: self.threshold, ..*self }
    }

    /// The wrench that is measured.
    pub fn estimate(&self) -> WrenchEstimate {
        let mut rows = WrenchRows::new();
        self.push(&mut rows);
        WrenchEstimate::from_rows(rows)
    }

    pub fn push(&self, rows: &mut WrenchRows) {
        for i in 0..6 {
            rows.push(&self.axes[i], self.value[i], 1.0 / self.tolerance[i]);
        }
    }
}

impl TorqueRows {
    pub fn new(robot: &Robot) -> Self {
        let nv = robot.nv();
        Self { axes: vec![Vector6::zeros(); nv], torque: vec![0.0; nv], tolerance: vec![1.0; nv], root: None }
    }

    /// `measured` is the part of the torque that sensors have explained already: it errs, too. Tolerances are the
    /// thresholds, widened by the noise that grows with the torques where that is given.
    pub fn set(
        &mut self,
        robot: &Robot,
        kinematics: &Kinematics,
        torque: &[f64],
        measured: &[f64],
        threshold: &[f64],
        noise: Option<&TorqueNoise>,
    ) {
        for body in 1..robot.body_count() {
            for (column, k) in robot.velocity_range(body).enumerate() {
                self.axes[k] = jacobian_column(robot, kinematics, body, column, &ORIGIN);
            }
        }
        self.torque.copy_from_slice(torque);
        self.tolerance.copy_from_slice(threshold);
        if let Some(noise) = noise {
            let largest = largest(torque);
            for (k, tolerance) in self.tolerance.iter_mut().enumerate() {
                let growing = noise.growing(k, LEVEL, torque[k], largest);
                *tolerance = growing.hypot(SENSOR_SHARE * measured[k]).hypot(threshold[k]);
            }
        }
        self.root = None;
    }

    /// Takes what a wrench on `body` explains out of the torques.
    pub fn explain(&mut self, robot: &Robot, region: &Region, body: usize, wrench: &WrenchEstimate) {
        for joint in region.chain(robot, body) {
            for k in robot.velocity_range(joint) {
                self.torque[k] -= wrench.torque_on(&self.axes[k]);
            }
        }
        if let Some(root) = &mut self.root {
            for (value, axis) in root.value.iter_mut().zip(&root.axes) {
                *value -= wrench.torque_on(axis);
            }
        }
    }

    /// The largest share of a tolerance that its threshold is: tolerances that are narrower by this share are still no
    /// narrower than the thresholds.
    pub fn widest_threshold(&self, threshold: &[f64]) -> f64 {
        let joints =
            threshold.iter().zip(&self.tolerance).map(|(threshold, tolerance)| threshold / tolerance);
        let root = self.root.iter().flat_map(|root| root.threshold.iter().zip(&root.tolerance));
        joints.chain(root.map(|(threshold, tolerance)| threshold / tolerance)).fold(0.0, f64::max)
    }

    /// Whether a joint feels what a wrench would cause, but for `limit` [tolerances].
    #[inline]
    pub fn explains(&self, robot: &Robot, joint: usize, wrench: &WrenchEstimate, limit: f64) -> bool {
        let misfit = |k: usize| (wrench.torque_on(&self.axes[k]) - self.torque[k]).abs();
        robot.velocity_range(joint).all(|k| misfit(k) <= limit * self.tolerance[k])
    }

    /// Adds the rows of a joint.
    #[inline]
    pub fn push_joint(&self, robot: &Robot, joint: usize, rows: &mut WrenchRows) {
        for k in robot.velocity_range(joint) {
            rows.push(&self.axes[k], self.torque[k], 1.0 / self.tolerance[k]);
        }
    }

    /// The total wrench that the joints up to `body`, and a sensor, feel.
    pub fn total_wrench(&self, robot: &Robot, region: &Region, body: usize) -> WrenchEstimate {
        let mut rows = WrenchRows::new();
        self.push_root(&mut rows);
        for joint in region.chain(robot, body) {
            self.push_joint(robot, joint, &mut rows);
        }
        WrenchEstimate::from_rows(rows)
    }

    /// Adds the total wrench if there is one.
    pub fn push_root(&self, rows: &mut WrenchRows) {
        if let Some(root) = &self.root {
            root.push(rows);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::torque::NoiseModel;

    #[test]
    fn tolerances_are_three_standard_deviations_of_the_one_noise_model() {
        let robot = Robot::example_arm();
        let kinematics = Kinematics::new(&robot);
        let noise = NoiseModel { model: vec![0.3], relative: vec![0.07], ..NoiseModel::default() };
        let noise = noise.of(&robot).expect("valid noise");
        let torque = [0.0, -12.0, 3.0, 0.5, -0.2, 0.1, 0.0];
        let mut rows = TorqueRows::new(&robot);
        rows.set(&robot, &kinematics, &torque, &[0.0; 7], &noise.threshold(), Some(&noise));
        let mut deviations = [0.0; 7];
        noise.set_deviations(&torque, &mut deviations);
        for (tolerance, deviation) in rows.tolerance.iter().zip(deviations) {
            assert!((tolerance - LEVEL * deviation).abs() < 1e-12, "{tolerance} {deviation}");
        }
    }
}
