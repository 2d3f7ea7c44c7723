//! Thresholds with a hold time (Vorndamme 2017, eq. 21).

use std::sync::Arc;

use nalgebra::Vector6;

use super::signal_tree::{Signal, SignalTree};
use crate::error::{Error, Result};
use crate::robot::Robot;
use crate::sensor::{is_known, SensorTree};

/// Element-wise thresholds; a signal stays on for a hold time after it was last over its threshold.
#[derive(Debug, Clone)]
pub(crate) struct Detector {
    robot: Arc<Robot>,
    threshold: Vec<f64>,
    hold_time: f64,
    /// Time left until a joint's signal goes off [s].
    remaining: Vec<f64>,
    /// Per sensor.
    wrench_threshold: Vec<Vector6<f64>>,
    wrench_remaining: Vec<f64>,
    is_known: Vec<bool>,
    tree: SignalTree,
    links: Vec<usize>,
    collision: bool,
    onset: bool,
}

impl Detector {
    /// `threshold` per velocity variable, or one for all [Nm; N for prismatic joints and a base's linear part], and on the
    /// sensors' wrenches: one number for all [N, Nm], six for each sensor, or six times the number of sensors;
    /// `hold_time` [s].
    ///
    /// # Errors
    /// [`Error::Input`] names the argument.
    pub fn new(
        robot: Arc<Robot>,
        threshold: &[f64],
        sensors: &SensorTree,
        wrench_threshold: &[f64],
        hold_time: f64,
    ) -> Result<Self> {
        let threshold = check_threshold(&robot, threshold)?;
        if !(hold_time.is_finite() && hold_time >= 0.0) {
            return Err(Error::input(
                "hold_time",
                format!("must be finite and not negative [s], not {hold_time}"),
            ));
        }
        Ok(Self {
            remaining: vec![-1.0; robot.nv()],
            wrench_threshold: check_wrench_threshold(sensors, wrench_threshold)?,
            wrench_remaining: vec![-1.0; sensors.len()],
            is_known: vec![true; sensors.len()],
            tree: SignalTree::new(&robot, sensors),
            links: Vec::with_capacity(robot.touchable_links().len()),
            robot,
            threshold,
            hold_time,
            collision: false,
            onset: false,
        })
    }

    /// One tick of `dt` [s] with the external torque `(nv,)`, finite, and the external wrenches that the sensors see, NaN
    /// where one is left out; none without sensors. A sensor over its threshold says that the contact is behind it, one
    /// under it that it is not.
    pub fn update(&mut self, external_torque: &[f64], wrenches: &[Vector6<f64>], dt: f64) {
        let before = self.collision;
        self.collision = false;
        for ((remaining, threshold), torque) in
            self.remaining.iter_mut().zip(&self.threshold).zip(external_torque)
        {
            *remaining = if torque.abs() > *threshold { self.hold_time } else { *remaining - dt };
            self.collision |= *remaining >= 0.0;
        }
        for (sensor, wrench) in wrenches.iter().enumerate() {
            let over = self.is_wrench_over(sensor, wrench);
            let remaining = &mut self.wrench_remaining[sensor];
            *remaining = if over { self.hold_time } else { *remaining - dt };
            self.collision |= *remaining >= 0.0;
            self.is_known[sensor] = is_known(wrench);
        }
        self.onset = self.collision && !before;
        let Self { robot, tree, remaining, wrench_remaining, is_known, links, .. } = self;
        let over = |signal| match signal {
            Signal::Joint { body } => robot.velocity_range(body).any(|k| remaining[k] >= 0.0),
            Signal::Sensor(sensor) => wrench_remaining[sensor] >= 0.0,
        };
        tree.region(over, |sensor| !is_known[sensor], links);
    }

    /// Whether a sensor's external wrench is over its threshold in any component.
    pub fn is_wrench_over(&self, sensor: usize, wrench: &Vector6<f64>) -> bool {
        wrench.iter().zip(&self.wrench_threshold[sensor]).any(|(value, threshold)| value.abs() > *threshold)
    }

    /// Forgets all signals.
    pub fn reset(&mut self) {
        self.remaining.fill(-1.0);
        self.wrench_remaining.fill(-1.0);
        self.is_known.fill(true);
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
    pub fn links(&self) -> &[usize] {
        &self.links
    }

    /// The thresholds `(nv,)`.
    pub fn threshold(&self) -> &[f64] {
        &self.threshold
    }
}

/// One threshold for all velocity variables, or one for each; positive and finite.
pub(crate) fn check_threshold(robot: &Robot, threshold: &[f64]) -> Result<Vec<f64>> {
    let threshold = robot.per_velocity("torque_threshold", threshold)?;
    if threshold.iter().any(|x| *x <= 0.0) {
        return Err(Error::input("torque_threshold", "must be positive [Nm]"));
    }
    Ok(threshold)
}

/// One threshold for all components of all sensors, six for each sensor, or six times the number of sensors.
pub(crate) fn check_wrench_threshold(sensors: &SensorTree, threshold: &[f64]) -> Result<Vec<Vector6<f64>>> {
    if threshold.iter().any(|x| !(x.is_finite() && *x > 0.0)) {
        return Err(Error::input("wrench_threshold", "must be positive and finite [N, Nm]"));
    }
    match threshold.len() {
        1 => Ok(vec![Vector6::repeat(threshold[0]); sensors.len()]),
        6 => Ok(vec![Vector6::from_column_slice(threshold); sensors.len()]),
        count if count == 6 * sensors.len() && count > 0 => {
            Ok(threshold.chunks_exact(6).map(Vector6::from_column_slice).collect())
        }
        count => Err(Error::input(
            "wrench_threshold",
            format!("expected one number, 6, or shape ({}, 6), got {count} numbers", sensors.len()),
        )),
    }
}
