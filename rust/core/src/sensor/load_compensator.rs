//! Readings free of the weight and inertia behind a sensor (Vorndamme 2017, eqs. 13-19 and Algorithm 1).

mod offsets;

use std::sync::Arc;

use nalgebra::{Vector3, Vector6};

use super::distal_parts::{distal_parts, DistalPart};
use super::force_torque_sensor::ForceTorqueSensor;
use super::sensor_tree::SensorTree;
use crate::error::{Error, Result};
use crate::robot::{JointKind, Kinematics, Robot, LARGEST, WORLD};
use crate::spatial::vector::stack;

/// A force and its moment about the reference origin of [`Kinematics`].
#[derive(Debug, Clone, Copy)]
struct Load {
    force: Vector3<f64>,
    moment: Vector3<f64>,
}

/// Acceleration of a body: of its origin, without gravity's, and angular.
#[derive(Debug, Clone, Copy)]
struct Acceleration {
    origin: Vector3<f64>,
    angular: Vector3<f64>,
}

/// Finds the external wrench that each sensor sees: its reading less what the bodies behind it weigh and resist.
///
/// One Newton-Euler pass for all sensors; a body counts once, and sums pass on from sensor to sensor.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::robot::Robot;
/// use contactsense::sensor::{ForceTorqueSensor, LoadCompensator};
///
/// let robot = Arc::new(Robot::example_arm());
/// let sensor = ForceTorqueSensor::new("wrist", "link_7");
/// let mut compensator = LoadCompensator::new(robot, &[sensor])?;
/// let still = [0.0; 7];
/// // The arm stands upright: the sensor carries the 2 kg behind it, and somebody pulls at it with 5 N.
/// let reading = [0.0, 0.0, 5.0 - 2.0 * 9.81, 0.0, 0.0, 0.0];
/// let external = compensator.update(&still, &still, &still, &[Some(reading)])?;
/// assert!((external[0].unwrap()[2] - 5.0).abs() < 1e-9);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct LoadCompensator {
    robot: Arc<Robot>,
    tree: SensorTree,
    kinematics: Kinematics,
    parts: Vec<DistalPart>,
    /// Bodies with parts and those that carry them, parents first.
    moving: Vec<usize>,
    accelerations: Vec<Acceleration>,
    /// Of each sensor: what all behind it put on it but for external forces.
    loads: Vec<Load>,
    external: Vec<Option<Vector6<f64>>>,
}

impl LoadCompensator {
    /// A compensator for a robot's sensors; none is allowed.
    ///
    /// # Errors
    /// [`Error::Input`] names the sensor whose link, name or pose cannot be used.
    pub fn new(robot: Arc<Robot>, sensors: &[ForceTorqueSensor]) -> Result<Self> {
        let tree = SensorTree::new(&robot, sensors)?;
        let parts = distal_parts(&robot, &tree);
        let moves = |body: &usize| parts.iter().any(|part| robot.moves(*body, part.body));
        let zero = Vector3::zeros();
        Ok(Self {
            kinematics: Kinematics::new(&robot),
            moving: (WORLD + 1..robot.body_count()).filter(moves).collect(),
            accelerations: vec![Acceleration { origin: zero, angular: zero }; robot.body_count()],
            loads: vec![Load { force: zero, moment: zero }; tree.len()],
            external: vec![Some(Vector6::zeros()); tree.len()],
            parts,
            tree,
            robot,
        })
    }

    /// External wrenches at `q`, `v` and the acceleration `a`, one a sensor: (force, moment) on the robot at the
    /// sensor's origin, world axes (N, Nm). `wrenches` are the readings, sensor axes, in the sensors' order.
    ///
    /// A sensor without a reading is left out: it has no external wrench, the others hold.
    ///
    /// # Errors
    /// [`Error::Input`] names the argument; the state is then unchanged.
    pub fn update(
        &mut self,
        q: &[f64],
        v: &[f64],
        a: &[f64],
        wrenches: &[Option<[f64; 6]>],
    ) -> Result<&[Option<Vector6<f64>>]> {
        self.robot.check_configuration(q)?;
        self.robot.check_tangent("v", v)?;
        self.robot.check_tangent("a", a)?;
        check_readings(&self.tree, wrenches)?;
        let mut kinematics = std::mem::replace(&mut self.kinematics, Kinematics::empty());
        kinematics.set_configuration(&self.robot, q);
        kinematics.set_velocity(&self.robot, v);
        self.compensate_at(&kinematics, a, wrenches);
        self.kinematics = kinematics;
        Ok(&self.external)
    }

    /// The same with poses and velocities that are known already, for checked arguments.
    pub(crate) fn compensate_at(
        &mut self,
        kinematics: &Kinematics,
        acceleration: &[f64],
        wrenches: &[Option<[f64; 6]>],
    ) {
        self.accelerate(kinematics, acceleration);
        self.load(kinematics);
        for (sensor, reading) in wrenches.iter().enumerate() {
            self.external[sensor] =
                reading.as_ref().map(|reading| self.external_wrench(kinematics, sensor, reading));
        }
    }

    /// Checks readings as [`LoadCompensator::update`] does.
    ///
    /// # Errors
    /// [`Error::Input`] names the row.
    pub fn check_readings(&self, wrenches: &[Option<[f64; 6]>]) -> Result<()> {
        check_readings(&self.tree, wrenches)
    }

    /// Names of the sensors, in their order.
    pub fn sensor_names(&self) -> &[String] {
        self.tree.names()
    }

    /// The last call's external wrenches; zeros before the first.
    pub fn external(&self) -> &[Option<Vector6<f64>>] {
        &self.external
    }

    /// Forgets the last call.
    pub fn reset(&mut self) {
        self.external.fill(Some(Vector6::zeros()));
    }

    /// Accelerations of the bodies' origins, from the base outwards.
    fn accelerate(&mut self, kinematics: &Kinematics, acceleration: &[f64]) {
        self.accelerations[WORLD] = Acceleration { origin: -self.robot.gravity, angular: Vector3::zeros() };
        for &index in &self.moving {
            let body = &self.robot.bodies[index];
            let (state, carrier) = (&kinematics.bodies[index], &kinematics.bodies[body.parent]);
            let Acceleration { mut origin, mut angular } = self.accelerations[body.parent];
            let arm = state.position - carrier.position;
            let spin = carrier.angular;
            origin += angular.cross(&arm) + spin.cross(&spin.cross(&arm));
            match body.kind {
                JointKind::Revolute | JointKind::Continuous => {
                    angular += state.axis() * acceleration[body.idx_v] + spin.cross(&state.angular);
                }
                JointKind::Prismatic => {
                    let sliding = state.linear - carrier.linear;
                    origin += state.axis() * acceleration[body.idx_v] + spin.cross(&sliding) * 2.0;
                }
                JointKind::FreeFlyer => {
                    let rate = &acceleration[body.idx_v..body.idx_v + 6];
                    let linear = state.rotation * Vector3::new(rate[0], rate[1], rate[2]);
                    // The velocity's components are the base frame's, which turns.
                    origin += linear + state.angular.cross(&state.velocity_at(&state.position));
                    angular += state.rotation * Vector3::new(rate[3], rate[4], rate[5]);
                }
            }
            self.accelerations[index] = Acceleration { origin, angular };
        }
    }

    /// What each sensor carries: eq. 18 for every part once, then from sensor to sensor (Algorithm 1). About one
    /// origin for all, so that a wrench needs no moment arm to be passed on.
    fn load(&mut self, kinematics: &Kinematics) {
        let zero = Vector3::zeros();
        self.loads.fill(Load { force: zero, moment: zero });
        for part in &self.parts {
            let state = &kinematics.bodies[part.body];
            let Acceleration { origin, angular } = &self.accelerations[part.body];
            let (a, rate) = (state.rotation.tr_mul(origin), state.rotation.tr_mul(angular));
            let spin = state.rotation.tr_mul(&state.angular);
            let force = a * part.mass + rate.cross(&part.moment) + spin.cross(&spin.cross(&part.moment));
            let moment =
                part.moment.cross(&a) + part.rotational * rate + spin.cross(&(part.rotational * spin));
            let force = state.rotation * force;
            let load = &mut self.loads[part.sensor];
            load.force += force;
            load.moment += state.rotation * moment + state.position.cross(&force);
        }
        for &sensor in self.tree.distal_first() {
            if let Some(parent) = self.tree.fixed_parent(sensor) {
                let Load { force, moment } = self.loads[sensor];
                self.loads[parent].force += force;
                self.loads[parent].moment += moment;
            }
        }
    }

    /// `F_ext,S = F_S + F_c,S` (eq. 19).
    fn external_wrench(&self, kinematics: &Kinematics, sensor: usize, reading: &[f64; 6]) -> Vector6<f64> {
        let [force, moment] = self.load_at(kinematics, sensor);
        let [read_force, read_moment] = self.tree.exerted(kinematics, sensor, reading);
        stack(&(read_force + force), &(read_moment + moment))
    }

    /// `F_c,S`: what holds and accelerates all behind a sensor, about its origin, world axes.
    fn load_at(&self, kinematics: &Kinematics, sensor: usize) -> [Vector3<f64>; 2] {
        let Load { force, moment } = &self.loads[sensor];
        [*force, moment - self.tree.position(kinematics, sensor).cross(force)]
    }
}

/// One reading a sensor, or none; its numbers must be of a size to compute with.
pub(crate) fn check_readings(tree: &SensorTree, wrenches: &[Option<[f64; 6]>]) -> Result<()> {
    if wrenches.len() != tree.len() {
        return Err(wrong_count(tree, wrenches.len()));
    }
    check_numbers(tree, wrenches)
}

/// The numbers of one reading a sensor, or none.
fn check_numbers(tree: &SensorTree, wrenches: &[Option<[f64; 6]>]) -> Result<()> {
    for (row, reading) in wrenches.iter().enumerate() {
        if reading.iter().flatten().any(|x| x.is_nan() || x.abs() >= LARGEST) {
            return Err(too_large(tree, row));
        }
    }
    Ok(())
}

#[cold]
fn wrong_count(tree: &SensorTree, found: usize) -> Error {
    let names = tree.names().join(", ");
    Error::input(
        "wrenches",
        format!("expected shape ({}, 6), one row a sensor ({names}), got {found} rows", tree.len()),
    )
}

#[cold]
fn too_large(tree: &SensorTree, row: usize) -> Error {
    Error::input(
        "wrenches",
        format!(
            "row {row} ('{}') must be below {LARGEST:e}; none (NaN in NumPy) where a sensor gives no reading",
            tree.names()[row]
        ),
    )
}
