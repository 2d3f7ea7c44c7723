//! Which links a contact can be on: those between the last signal over its threshold and the next one under it
//! (Vorndamme 2017, eq. 21).

use std::sync::Arc;

use nalgebra::Vector6;

use super::gate::{check_hold_time, check_threshold, check_wrench_threshold, Gate};
use super::signal_tree::{Signal, SignalTree};
use crate::error::Result;
use crate::robot::{LinkIndex, Robot};
use crate::sensor::SensorTree;

/// The signals of joints and sensors, and the links that they leave for a contact.
#[derive(Debug, Clone)]
pub(crate) struct Detector {
    robot: Arc<Robot>,
    joints: Gate,
    sensors: Gate,
    wrench_threshold: Vec<Vector6<f64>>,
    /// By sensor: its largest component, in thresholds; zero where it is left out.
    wrench_size: Vec<f64>,
    is_known: Vec<bool>,
    tree: SignalTree,
    links: Vec<LinkIndex>,
    collision: bool,
    onset: bool,
}

impl Detector {
    /// `threshold` per velocity variable, or one for all [Nm; N for prismatic joints and a base's linear part], and on the
    /// sensors' wrenches: one number for all (N, Nm), six for each sensor, or six times the number of sensors;
    /// `hold_time` (s).
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) names the argument.
    pub fn new(
        robot: Arc<Robot>,
        threshold: &[f64],
        sensors: &SensorTree,
        wrench_threshold: &[f64],
        hold_time: f64,
    ) -> Result<Self> {
        let threshold = check_threshold(&robot, threshold)?;
        check_hold_time(hold_time)?;
        Ok(Self {
            joints: Gate::new(threshold, hold_time),
            sensors: Gate::new(vec![1.0; sensors.len()], hold_time),
            wrench_threshold: check_wrench_threshold(sensors, wrench_threshold)?,
            wrench_size: vec![0.0; sensors.len()],
            is_known: vec![true; sensors.len()],
            tree: SignalTree::new(&robot, sensors),
            links: Vec::with_capacity(robot.touchable_links().len()),
            robot,
            collision: false,
            onset: false,
        })
    }

    /// Takes in the external wrenches of a tick, none where a sensor is left out; empty without sensors. A sensor over its
    /// threshold says that the contact is behind it, one under it that it is not. Returns whether one is over.
    pub fn sense(&mut self, wrenches: &[Option<Vector6<f64>>]) -> bool {
        for (sensor, wrench) in wrenches.iter().enumerate() {
            let shares =
                wrench.map_or(Vector6::zeros(), |it| it.abs().component_div(&self.wrench_threshold[sensor]));
            self.wrench_size[sensor] = shares.iter().copied().fold(0.0, f64::max);
            self.is_known[sensor] = wrench.is_some();
        }
        self.sensors.any_over(self.wrench_size.iter().copied())
    }

    /// The rest of the tick of `dt` [s] with the joints' signals `(nv,)`, finite: external torques, or what else the
    /// thresholds are of.
    pub fn update(&mut self, signals: &[f64], dt: f64) {
        let before = self.collision;
        let on_joints = self.joints.update(signals, dt);
        let on_sensors = self.sensors.update(&self.wrench_size, dt);
        self.collision = on_joints || on_sensors;
        self.onset = self.collision && !before;
        let Self { robot, tree, joints, sensors, is_known, links, .. } = self;
        let over = |signal| match signal {
            Signal::Joint { body } => robot.velocity_range(body).any(|k| joints.is_on(k)),
            Signal::Sensor(sensor) => sensors.is_on(sensor),
        };
        tree.region(over, |sensor| !is_known[sensor], links);
    }

    /// Whether a torque `(nv,)` is over a threshold, whatever was before.
    pub fn any_over(&self, torque: impl IntoIterator<Item = f64>) -> bool {
        self.joints.any_over(torque)
    }

    /// Forgets all signals but what was sensed in this tick.
    pub fn reset(&mut self) {
        self.joints.reset();
        self.sensors.reset();
        self.links.clear();
        self.collision = false;
        self.onset = false;
    }

    /// Whether there is a contact.
    pub fn collision(&self) -> bool {
        self.collision
    }

    /// Whether the contact began with the last update.
    pub fn onset(&self) -> bool {
        self.onset
    }

    /// Touchable links between the last signal over its threshold and the next under it, on every branch.
    pub fn links(&self) -> &[LinkIndex] {
        &self.links
    }

    /// Other thresholds of the joints, checked; what is on stays on for its time.
    pub fn set_threshold(&mut self, threshold: Vec<f64>) {
        self.joints.set_threshold(threshold);
    }

    /// Other thresholds of the sensors, as checked by [`check_wrench_threshold`].
    pub fn set_wrench_threshold(&mut self, threshold: Vec<Vector6<f64>>) {
        self.wrench_threshold = threshold;
    }

    /// The thresholds on each sensor's wrench (N, Nm).
    pub fn wrench_threshold(&self) -> &[Vector6<f64>] {
        &self.wrench_threshold
    }
}
