//! Offsets of the readings, given or by taring.

use nalgebra::{Vector3, Vector6};

use super::{check_numbers, wrong_count, LoadCompensator};
use crate::error::{Error, Result};
use crate::robot::{Kinematics, LARGEST};
use crate::sensor::ForceTorqueSensor;
use crate::spatial::vector::stack;

impl LoadCompensator {
    /// The sensors, in their order, with the offsets that are subtracted now.
    pub fn sensors(&self) -> &[ForceTorqueSensor] {
        self.tree.sensors()
    }

    /// Other offsets, one a sensor, in the sensors' own axes and conventions (N, Nm).
    ///
    /// # Errors
    /// [`Error::Input`] for another number of offsets and for a number that is not finite; nothing is then changed.
    pub fn set_offsets(&mut self, offsets: &[[f64; 6]]) -> Result<()> {
        if offsets.len() != self.tree.len() {
            let text = format!("expected shape ({}, 6), one row a sensor", self.tree.len());
            return Err(Error::input("offsets", text));
        }
        if let Some(row) = offsets.iter().position(|row| !row.iter().all(|x| x.abs() < LARGEST)) {
            let name = &self.tree.names()[row];
            return Err(Error::input("offsets", format!("row {row} ('{name}') must be finite [N, Nm]")));
        }
        offsets.iter().enumerate().for_each(|(sensor, offset)| self.tree.set_offset(sensor, *offset));
        Ok(())
    }

    /// Sets the offsets so that the free load reads zero: the robot is at rest at `q`, without contact.
    ///
    /// `wrenches` are readings without correction, one a sensor, of one row or of several, whose mean counts. A sensor
    /// without any reading keeps its offset.
    ///
    /// ```
    /// use std::sync::Arc;
    ///
    /// use contactsense::robot::Robot;
    /// use contactsense::sensor::{ForceTorqueSensor, LoadCompensator};
    ///
    /// let robot = Arc::new(Robot::example_arm());
    /// let mut compensator = LoadCompensator::new(robot, &[ForceTorqueSensor::new("wrist", "link_7")])?;
    /// let still = [0.0; 7];
    /// // Somebody has zeroed the sensor with its load on.
    /// let reading = [Some([0.0; 6])];
    /// compensator.tare(&still, &reading)?;
    /// assert!((compensator.sensors()[0].offset[2] - 2.0 * 9.81).abs() < 1e-9);
    /// let external = compensator.update(&still, &still, &still, &reading)?;
    /// assert!(external[0].unwrap().norm() < 1e-9);
    /// # Ok::<(), contactsense::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Input`] names the argument; nothing is then changed.
    pub fn tare(&mut self, q: &[f64], wrenches: &[Option<[f64; 6]>]) -> Result<()> {
        self.robot.check_configuration(q)?;
        let count = self.tree.len();
        if count == 0 && wrenches.is_empty() {
            return Ok(());
        }
        if count == 0 || wrenches.is_empty() || !wrenches.len().is_multiple_of(count) {
            return Err(wrong_count(&self.tree, wrenches.len()));
        }
        wrenches.chunks_exact(count).try_for_each(|row| check_numbers(&self.tree, row))?;
        let kinematics = self.rest(q);
        for sensor in 0..count {
            if let Some(mean) = mean(wrenches.iter().skip(sensor).step_by(count).flatten()) {
                let offset = mean - self.free_reading(&kinematics, sensor);
                self.tree.set_offset(sensor, offset.into());
            }
        }
        Ok(())
    }

    /// What the first sensor reads at rest, without offset and contact, and gravity in its axes.
    ///
    /// # Errors
    /// [`Error::Input`] names the argument.
    pub(in crate::sensor) fn free_reading_at(&mut self, q: &[f64]) -> Result<(Vector6<f64>, Vector3<f64>)> {
        self.robot.check_configuration(q)?;
        let kinematics = self.rest(q);
        let gravity = self.tree.rotation(&kinematics, 0).tr_mul(&self.robot.gravity);
        Ok((self.free_reading(&kinematics, 0), gravity))
    }

    /// Finds the loads of the robot at rest.
    fn rest(&mut self, q: &[f64]) -> Kinematics {
        let still = vec![0.0; self.robot.nv()];
        let mut kinematics = Kinematics::new(&self.robot);
        kinematics.set_configuration(&self.robot, q);
        kinematics.set_velocity(&self.robot, &still);
        self.accelerate(&kinematics, &still);
        self.load(&kinematics);
        kinematics
    }

    /// What a sensor without offset reads where nothing but its free load acts on it.
    fn free_reading(&self, kinematics: &Kinematics, sensor: usize) -> Vector6<f64> {
        let [force, moment] = self.load_at(kinematics, sensor);
        let turn = self.tree.rotation(kinematics, sensor);
        let own = |x: Vector3<f64>| turn.tr_mul(&-x);
        stack(&own(force), &own(moment)) * self.tree.sensors()[sensor].convention.sign()
    }
}

/// The mean of readings; none of none. Readings are of a size whose sum over any log can be computed.
fn mean<'a>(readings: impl Iterator<Item = &'a [f64; 6]>) -> Option<Vector6<f64>> {
    let (mut sum, mut count) = (Vector6::zeros(), 0.0);
    for reading in readings {
        sum += Vector6::from(*reading);
        count += 1.0;
    }
    (count > 0.0).then(|| sum / count)
}
