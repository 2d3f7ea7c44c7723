//! The tool behind a sensor and the sensor's offset, from readings in several poses at rest.

mod fit;

use std::sync::Arc;

use super::force_torque_sensor::ForceTorqueSensor;
use super::gravity_span::missing;
use super::load_compensator::LoadCompensator;
use crate::error::{Error, Result};
use crate::robot::Robot;
use fit::{Fit, StaticPose};

/// A centre of mass that is farther from its sensor is an error of units or frames (m).
const FARTHEST: f64 = 2.0;
/// Standard deviations beyond which a number is not noise.
const SIGNIFICANT: f64 = 3.0;

/// What a robot's description lacks behind a sensor, and what the sensor reads without load.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::robot::Robot;
/// use contactsense::sensor::{identify_tool, ForceTorqueSensor, LoadCompensator};
/// use nalgebra::{Matrix3, Vector3};
///
/// let robot = Robot::example_arm();
/// let sensor = ForceTorqueSensor::new("wrist", "link_7");
/// let loaded = robot.with_payload(robot.link("link_7")?, 1.0, Vector3::new(0.0, 0.02, 0.1), Matrix3::zeros())?;
/// let mut truth = LoadCompensator::new(Arc::new(loaded), &[sensor.clone()])?;
/// let poses: Vec<f64> = (0..5).flat_map(|k| [0.7 * f64::from(k); 7]).collect();
/// let mut readings = vec![];
/// for q in poses.chunks_exact(7) {
///     truth.tare(q, &[Some([0.0; 6])])?;
///     let [fx, fy, fz, mx, my, mz] = truth.sensors()[0].offset.map(|x| -x);
///     readings.push(Some([fx + 5.0, fy, fz, mx, my, mz]));
/// }
/// let tool = identify_tool(&robot.into(), &sensor, &poses, &readings)?;
/// assert!((tool.mass - 1.0).abs() < 1e-6 && (tool.com[2] - 0.1).abs() < 1e-6);
/// assert!((tool.offset[0] - 5.0).abs() < 1e-6);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct ToolLoad {
    /// The sensor's link, which holds the tool.
    pub link: String,
    /// Mass in addition to the description (kg).
    pub mass: f64,
    /// Its centre, in the link's frame (m).
    pub com: [f64; 3],
    /// What the sensor reads without load, in its own axes and convention (N, Nm).
    pub offset: [f64; 6],
    /// Of mass, centre of mass and offset, in this order.
    pub covariance: [[f64; 10]; 10],
    /// What is left of the mean readings, root mean square over the poses (N, Nm).
    pub residual: [f64; 6],
}

impl ToolLoad {
    /// One standard deviation of mass, centre of mass and offset.
    pub fn std(&self) -> [f64; 10] {
        std::array::from_fn(|k| self.covariance[k][k].max(0.0).sqrt())
    }
}

/// Finds the tool behind a sensor that the description lacks, and the sensor's offset.
///
/// The robot is at rest and free of contacts in each of the poses `q`, flat rows of `nq`; `wrenches` are readings as the
/// sensor gives them, equally many in each pose, one pose after the other. An offset that `sensor` has already is not
/// looked at.
///
/// # Errors
/// [`Error::Input`] names the argument: also where the directions of gravity do not tell offset from load (it says which
/// are missing), and where the readings are those of no tool.
pub fn identify_tool(
    robot: &Arc<Robot>,
    sensor: &ForceTorqueSensor,
    q: &[f64],
    wrenches: &[Option<[f64; 6]>],
) -> Result<ToolLoad> {
    robot.check_moves()?;
    if robot.gravity.norm() == 0.0 {
        return Err(Error::input("robot", "has no gravity, so that a tool has no weight"));
    }
    let poses = read(robot, sensor, q, wrenches)?;
    let directions: Vec<_> = poses.iter().map(|pose| pose.gravity.normalize()).collect();
    if let Some(missing) = missing(&directions) {
        return Err(Error::input(
            "q",
            format!(
                "the {} poses with readings do not tell the offset from the load, which takes four directions of gravity \
                 that differ about two axes of the sensor; add poses in which gravity points along {} of the sensor frame",
                poses.len(),
                missing.join(", ")
            ),
        ));
    }
    let fit = Fit::new(&poses);
    if fit.mass < -SIGNIFICANT * fit.mass_std {
        return Err(Error::input(
            "wrenches",
            format!(
                "show a load behind '{}' that is {:.3} kg lighter than the robot's description: take the tool out of it, \
                 or check the convention of the sensor",
                sensor.name, -fit.mass
            ),
        ));
    }
    let load = fit.load();
    let distance = load.com.norm();
    if distance > FARTHEST + SIGNIFICANT * load.com_std() {
        return Err(Error::input(
            "wrenches",
            format!(
                "show a centre of mass {distance:.2} m from '{}', which no tool has: check the units of the moments [Nm] \
                 and the order (force, moment)",
                sensor.name
            ),
        ));
    }
    Ok(load.at(sensor))
}

/// What the model does not explain of the readings, pose by pose; poses without any reading are left out.
fn read(
    robot: &Arc<Robot>,
    sensor: &ForceTorqueSensor,
    q: &[f64],
    wrenches: &[Option<[f64; 6]>],
) -> Result<Vec<StaticPose>> {
    let count = q.len() / robot.nq().max(1);
    if count == 0 || count * robot.nq() != q.len() {
        return Err(Error::input("q", format!("expected rows of {} numbers, one or more", robot.nq())));
    }
    if wrenches.is_empty() || !wrenches.len().is_multiple_of(count) {
        let text =
            format!("expected equally many readings for each of the {count} poses, got {}", wrenches.len());
        return Err(Error::input("wrenches", text));
    }
    let mut compensator = LoadCompensator::new(robot.clone(), std::slice::from_ref(sensor))?;
    let mut poses = vec![];
    for (q, readings) in q.chunks_exact(robot.nq()).zip(wrenches.chunks_exact(wrenches.len() / count)) {
        readings.chunks(1).try_for_each(|reading| compensator.check_readings(reading))?;
        let (free, gravity) = compensator.free_reading_at(q)?;
        let sign = sensor.convention.sign();
        poses.extend(StaticPose::new(readings.iter().flatten(), &free, gravity, sign));
    }
    Ok(poses)
}
