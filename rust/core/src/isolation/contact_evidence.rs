//! What one instant tells of contacts that are not wanted: torques of the joints and wrenches of sensors, as rows of one
//! measurement.

use nalgebra::Vector6;

use super::torque_now::TorqueNow;
use crate::robot::{Kinematics, Robot};
use crate::sensor::{exclude_wanted, leave_out_blind, sensor_torque, SensorTree};
use crate::torque::{SensorMount, TorqueNoise, LEVEL, SENSOR_RELATIVE, WRENCH};

/// A row that is left out counts with so many times its standard deviation.
pub(crate) const LEFT_OUT: f64 = 1e6;

/// External wrenches of the sensors of a robot where some contacts are wanted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WithoutWanted<'a> {
    /// Of each sensor without wanted contacts, none where that is not known.
    pub unwanted: &'a [Option<Vector6<f64>>],
    /// Of each sensor with them, none where it is not trusted.
    pub all: &'a [Option<Vector6<f64>>],
    /// By velocity variable: wanted contacts may load it unmeasured.
    pub blind: &'a [bool],
}

/// Rows: one a velocity variable, then six a sensor that sees contacts which are not wanted.
#[derive(Debug, Clone)]
pub(crate) struct ContactEvidence {
    /// Those whose wrenches are rows.
    sensors: Vec<usize>,
    wanted: Vec<bool>,
    /// Of each sensor's wrench without contact (N, Nm).
    wrench_deviation: Vec<Vector6<f64>>,
    /// What is measured, and its standard deviations without contact (Nm, N).
    value: Vec<f64>,
    deviation: Vec<f64>,
    columns: Vec<f64>,
    scratch: Scratch,
}

/// Memory to exclude wanted contacts.
#[derive(Debug, Clone, Default)]
struct Scratch {
    torque: Vec<f64>,
    columns: Vec<f64>,
    unwanted: Vec<Option<Vector6<f64>>>,
    blind: Vec<bool>,
}

impl ContactEvidence {
    /// For the sensors of a tree, with the standard deviations of their wrenches as thresholds.
    pub fn new(robot: &Robot, tree: &SensorTree, wanted: &[bool], wrench_threshold: &[Vector6<f64>]) -> Self {
        let sensors: Vec<usize> = (0..tree.len()).filter(|sensor| !wanted[*sensor]).collect();
        let rows = robot.nv() + WRENCH * sensors.len();
        ContactEvidence {
            sensors,
            wanted: wanted.to_vec(),
            wrench_deviation: wrench_threshold.iter().map(|threshold| threshold / LEVEL).collect(),
            value: vec![0.0; rows],
            deviation: vec![1.0; rows],
            columns: vec![0.0; robot.nv()],
            scratch: Scratch {
                torque: vec![0.0; robot.nv()],
                columns: vec![0.0; robot.nv()],
                unwanted: vec![None; tree.len()],
                blind: vec![false; robot.nv()],
            },
        }
    }

    /// The sensors whose wrenches are rows, as the links load them.
    pub fn mounts(&self, robot: &Robot, tree: &SensorTree) -> Vec<SensorMount> {
        let loads = |sensor: usize, link: usize| {
            tree.fixed_of_link(link).is_some_and(|nearest| tree.is_behind(nearest, sensor))
        };
        let mount = |&sensor: &usize| SensorMount {
            body: tree.body(sensor),
            origin: tree.origin(sensor),
            loads: (0..robot.links().len()).map(|link| loads(sensor, link)).collect(),
        };
        self.sensors.iter().map(mount).collect()
    }

    /// Whether contacts on a link are wanted: a wanted sensor carries it.
    pub fn is_wanted(&self, tree: &SensorTree, link: usize) -> bool {
        tree.fixed_of_link(link).is_some_and(|sensor| self.wanted[sensor])
    }

    /// The noise of the rows, from that of the joints' torques.
    pub fn noise(&self, of_joints: TorqueNoise) -> TorqueNoise {
        of_joints.with_sensors(self.sensors.iter().map(|sensor| self.wrench_deviation[*sensor]))
    }

    /// Takes on an external torque `(nv,)` with its standard deviations, and the external wrenches of all sensors.
    pub fn set(
        &mut self,
        robot: &Robot,
        kinematics: &Kinematics,
        tree: &SensorTree,
        torque: (&[f64], &[f64]),
        wrenches: &[Option<Vector6<f64>>],
    ) {
        let trusted = |sensor: usize| wrenches[sensor].is_some();
        let mut scratch = std::mem::take(&mut self.scratch);
        let Scratch { torque: left, columns, unwanted, blind } = &mut scratch;
        left.copy_from_slice(torque.0);
        exclude_wanted(kinematics, tree, &self.wanted, trusted, wrenches, unwanted, |sensor, wrench| {
            sensor_torque(robot, kinematics, tree, sensor, wrench, columns);
            left.iter_mut().zip(&*columns).for_each(|(left, wanted)| *left -= wanted);
        });
        leave_out_blind(robot, tree, &self.wanted, trusted, blind);
        let sensed = WithoutWanted { unwanted, all: wrenches, blind };
        self.set_without_wanted(robot, kinematics, tree, (left, torque.1), &sensed);
        self.scratch = scratch;
    }

    /// The same of a torque from which wanted contacts are excluded already.
    pub fn set_without_wanted(
        &mut self,
        robot: &Robot,
        kinematics: &Kinematics,
        tree: &SensorTree,
        torque: (&[f64], &[f64]),
        sensed: &WithoutWanted<'_>,
    ) {
        let nv = robot.nv();
        self.value[..nv].copy_from_slice(torque.0);
        self.deviation[..nv].copy_from_slice(torque.1);
        for position in 0..self.sensors.len() {
            let sensor = self.sensors[position];
            let own = nv + WRENCH * position..nv + WRENCH * (position + 1);
            self.deviation[own.clone()].copy_from_slice(self.wrench_deviation[sensor].as_slice());
            match &sensed.unwanted[sensor] {
                Some(wrench) => self.value[own].copy_from_slice(wrench.as_slice()),
                None => own.for_each(|row| self.leave_row_out(row)),
            }
        }
        self.add_errors_of_wanted(robot, kinematics, tree, sensed.all);
        self.leave_out(sensed.blind);
    }

    /// The rows at a pose.
    pub fn at<'a>(&'a self, kinematics: &'a Kinematics) -> TorqueNow<'a> {
        TorqueNow { kinematics, torque: &self.value, deviation: &self.deviation }
    }

    /// The torques of these velocity variables tell nothing.
    pub fn leave_out(&mut self, left_out: &[bool]) {
        let left_out = left_out.iter().enumerate().filter(|(_, left_out)| **left_out);
        left_out.for_each(|(k, _)| self.leave_row_out(k));
    }

    fn leave_row_out(&mut self, row: usize) {
        self.value[row] = 0.0;
        self.deviation[row] *= LEFT_OUT;
    }

    /// The errors of wanted contacts' wrenches are errors of the torques.
    fn add_errors_of_wanted(
        &mut self,
        robot: &Robot,
        kinematics: &Kinematics,
        tree: &SensorTree,
        wrenches: &[Option<Vector6<f64>>],
    ) {
        let Self { wanted, wrench_deviation, deviation, columns, .. } = self;
        for (sensor, wrench) in wrenches.iter().enumerate() {
            // All that is behind a wanted sensor is wanted too, and in its wrench.
            let outermost = tree.parent(sensor).is_none_or(|parent| !wanted[parent]);
            let Some(wrench) = wrench.filter(|_| wanted[sensor] && outermost) else { continue };
            // Components err one by one.
            for axis in 0..WRENCH {
                let error = wrench_deviation[sensor][axis].hypot(SENSOR_RELATIVE * wrench[axis]);
                sensor_torque(robot, kinematics, tree, sensor, &Vector6::ith(axis, error), columns);
                let of_joints = deviation.iter_mut().zip(&*columns);
                of_joints.for_each(|(deviation, error)| *deviation = deviation.hypot(*error));
            }
        }
    }
}
