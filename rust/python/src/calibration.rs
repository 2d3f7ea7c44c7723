//! `Calibration`, and how it is learnt.

use std::path::PathBuf;

use contactsense::calibration::{calibrate, Calibration, CalibrationOptions, Log};
use contactsense::NoiseModel;
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arguments::{number, text};
use crate::arrays::Vector;
use crate::calibration_parts::{PyBodyInertia, PyJointFriction, PyPayload};
use crate::errors::{input, interruptible, to_python};
use crate::noise::{noise_model, PyNoiseModel};
use crate::pickle::{plain_dict, reduced, Reduced};
use crate::returned::{from_rows, numbers, read_only};
use crate::robot::PyRobot;
use crate::robot_argument::robot;

/// The argument `calibration`.
pub fn calibration_of(object: &Bound<'_, PyAny>) -> PyResult<Calibration> {
    match object.cast::<PyCalibration>() {
        Ok(calibration) => Ok(calibration.get().0.clone()),
        Err(_) => {
            let text = format!("calibration: expected a contactsense.Calibration, got {}", object.get_type());
            Err(input(object.py(), text))
        }
    }
}

/// The arguments `noise` and `calibration`, of which one may be given: what the torques of a robot err by.
pub fn noise_of(
    robot: &Bound<'_, PyRobot>,
    noise: Option<&Bound<'_, PyAny>>,
    calibration: Option<&Bound<'_, PyAny>>,
) -> PyResult<Option<NoiseModel>> {
    match (noise, calibration) {
        (Some(_), Some(_)) => {
            Err(input(robot.py(), "noise: give it or calibration, which has its own, not both".into()))
        }
        (Some(noise), None) => noise_model(noise).map(Some),
        (None, Some(calibration)) => {
            let calibration = calibration_of(calibration)?;
            calibration.check(&robot.get().0).map_err(|error| to_python(robot.py(), error))?;
            Ok(Some(calibration.noise))
        }
        (None, None) => Ok(None),
    }
}

/// Base of the class that users have, which adds files.
#[pyclass(frozen, eq, subclass, skip_from_py_object, name = "Calibration", module = "contactsense")]
#[derive(PartialEq, Clone)]
pub struct PyCalibration(pub Calibration);

/// What `to_dict` holds.
const ATTRIBUTES: &[&str] = &[
    "robot_name",
    "fingerprint",
    "joint_names",
    "torque_bias",
    "torque_bias_std",
    "torque_scale",
    "torque_is_external",
    "friction",
    "hysteresis",
    "hysteresis_std",
    "hysteresis_width",
    "armature",
    "armature_std",
    "bodies",
    "payload",
    "inertial_change",
    "velocity_delay",
    "torque_delay",
    "sensor_offsets",
    "noise",
    "residual",
    "tails",
    "model_errors",
    "false_alarms_per_hour",
    "contacts",
    "notes",
];

type Array<'py> = Bound<'py, PyArray1<f64>>;

#[pymethods]
impl PyCalibration {
    /// From the core's content as JSON, or the same calibration once more.
    #[new]
    fn new(py: Python<'_>, content: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(calibration) = content.cast::<PyCalibration>() {
            return Ok(calibration.get().clone());
        }
        let Ok(json) = content.extract::<&str>() else {
            return Err(input(py, "use calibrate or Calibration.load to make a calibration".into()));
        };
        let read = serde_json::from_str(json);
        read.map(Self).map_err(|error| input(py, format!("calibration: {error}")))
    }

    /// The core's content as JSON.
    fn _content(&self, py: Python<'_>) -> PyResult<String> {
        serde_json::to_string(&self.0).map_err(|error| input(py, format!("calibration: {error}")))
    }

    #[staticmethod]
    fn _load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        Calibration::load(path).map(Self).map_err(|error| to_python(py, error))
    }

    /// The text of a file.
    fn _to_yaml(&self, py: Python<'_>, source: &str, date: &str) -> PyResult<String> {
        self.0.to_yaml(source, date).map_err(|error| to_python(py, error))
    }

    #[staticmethod]
    fn _of_description(robot: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = robot.py();
        let robot = self::robot(robot)?;
        let robot = &robot.get().0;
        robot.check_moves().map_err(|error| to_python(py, error))?;
        Ok(Self(Calibration::of_description(robot)))
    }

    /// Name of the robot that it is of.
    #[getter]
    fn robot_name(&self) -> &str {
        &self.0.robot
    }

    /// Of that robot's joints and inertias, to tell it from others.
    #[getter]
    fn fingerprint(&self) -> &str {
        &self.0.fingerprint
    }

    /// Names of the robot's moving joints, in the order of `v`.
    #[getter]
    fn joint_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.0.joints)
    }

    /// Constant torque that the measurement adds, `(nv,)` [Nm; N for sliding joints]; a read-only copy.
    #[getter]
    fn torque_bias<'py>(&self, py: Python<'py>) -> Array<'py> {
        numbers(py, &self.0.torque_bias)
    }

    /// Standard deviation of `torque_bias`, `(nv,)` [Nm; N for sliding joints]; a read-only copy.
    #[getter]
    fn torque_bias_std<'py>(&self, py: Python<'py>) -> Array<'py> {
        numbers(py, &self.0.torque_bias_std)
    }

    /// Factor from measured to true torque, its sign included, `(nv,)`; a read-only copy.
    #[getter]
    fn torque_scale<'py>(&self, py: Python<'py>) -> Array<'py> {
        numbers(py, &self.0.torque_scale)
    }

    /// Whether the torques are external torques of the vendor: then only bias, scale and noise are corrected.
    #[getter]
    fn torque_is_external(&self) -> bool {
        self.0.torque_is_external
    }

    /// Friction inside the measured torque: a `JointFriction`.
    #[getter]
    fn friction(&self) -> PyJointFriction {
        let Calibration { friction, coulomb_std, viscous_std, .. } = self.0.clone();
        PyJointFriction { friction, coulomb_std, viscous_std }
    }

    /// Share of a change of the torque that gears keep back, `(nv,)`; a read-only copy.
    ///
    /// Three times this share while the torque has changed by at most twice `hysteresis_width` since it last turned
    /// round, twice up to six widths, once up to eighteen, none beyond.
    #[getter]
    fn hysteresis<'py>(&self, py: Python<'py>) -> Array<'py> {
        numbers(py, &self.0.hysteresis)
    }

    /// Standard deviation of `hysteresis`, `(nv,)`; a read-only copy.
    #[getter]
    fn hysteresis_std<'py>(&self, py: Python<'py>) -> Array<'py> {
        numbers(py, &self.0.hysteresis_std)
    }

    /// The scale of the torque over which hysteresis levels off, `(nv,)` [Nm; N for sliding joints]; a read-only copy.
    #[getter]
    fn hysteresis_width<'py>(&self, py: Python<'py>) -> Array<'py> {
        numbers(py, &self.0.hysteresis_width)
    }

    /// Rotor inertia, reflected through the gear, `(nv,)` [kg m^2; kg for sliding joints]; a read-only copy.
    #[getter]
    fn armature<'py>(&self, py: Python<'py>) -> Array<'py> {
        numbers(py, &self.0.armature)
    }

    /// Standard deviation of `armature`, `(nv,)` [kg m^2; kg for sliding joints]; a read-only copy.
    #[getter]
    fn armature_std<'py>(&self, py: Python<'py>) -> Array<'py> {
        numbers(py, &self.0.armature_std)
    }

    /// Inertias of all that moves with each joint, without the payload: a tuple of `BodyInertia`, one a joint.
    #[getter]
    fn bodies<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.0.bodies.iter().cloned().map(PyBodyInertia))
    }

    /// What the description lacks on `payload_link`: a `Payload`, or None where none was asked for.
    #[getter]
    fn payload(&self) -> Option<PyPayload> {
        self.0.payload.clone().map(PyPayload)
    }

    /// The share by which inertias may differ from the description, as held-out blocks of the log chose it.
    #[getter]
    fn inertial_change(&self) -> f64 {
        self.0.inertial_change
    }

    /// How late the velocity is against the position [s].
    #[getter]
    fn velocity_delay(&self) -> f64 {
        self.0.velocity_delay
    }

    /// How late the torque is against the position [s].
    #[getter]
    fn torque_delay(&self) -> f64 {
        self.0.torque_delay
    }

    /// What force/torque sensors read without load, by name: a new dict of `(6,)` arrays [N, Nm].
    #[getter]
    fn sensor_offsets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let offsets = PyDict::new(py);
        for (name, offset) in &self.0.sensor_offsets {
            offsets.set_item(name, numbers(py, offset))?;
        }
        Ok(offsets)
    }

    /// Errors of the external torque that are left: a `NoiseModel`.
    #[getter]
    fn noise(&self) -> PyNoiseModel {
        PyNoiseModel(self.0.noise.clone())
    }

    /// What is left of the low-passed torque, `(nv,)` [Nm; N for sliding joints]; a read-only copy.
    ///
    /// Root mean square over blocks of the log that were held out of the fit, behind a low-pass of 8/s (slower where the log has few rows a second).
    #[getter]
    fn residual<'py>(&self, py: Python<'py>) -> Array<'py> {
        numbers(py, &self.0.residual)
    }

    /// How large the errors made the statistic of detection on those blocks, `(k, 3)`; a read-only copy.
    ///
    /// One row a gain of the observers: the gain [1/s], the statistic that was exceeded 0.8 times a second, and by how much
    /// more it is at a rate that is a factor of e lower. Where the torques contain the friction
    /// of gears, no less than of Gaussian errors.
    #[getter]
    fn tails<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = self.0.tails.iter().map(|tail| [tail.gain, tail.level, tail.scale]);
        Ok(read_only(from_rows(py, rows)?))
    }

    /// Errors of the model that the motion of the log leaves possible and did not show, `(k, joints, 6)`; a read-only copy.
    ///
    /// The k errors are independent of each other, each one standard deviation. By joint: mass [kg] and first moment [kg m] of
    /// all that moves with the joint, about the joint's origin in its axes; bias of the torque [Nm, N]; and viscous friction
    /// [Nm s/rad, N s/m]. Where the log visited most poses and speeds, there are few or none. A monitor expects less accurate
    /// torques at poses and speeds where these errors matter.
    #[getter]
    fn model_errors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let errors = &self.0.model_errors;
        let shape = [errors.len(), self.0.joints.len(), 6];
        let flat: Vec<f64> = errors.iter().flat_map(|error| error.by_joint()).flatten().collect();
        Ok(read_only(PyArray1::from_vec(py, flat).reshape(shape)?))
    }

    /// The rate of false alarms that thresholds are set for [1/h].
    #[getter]
    fn false_alarms_per_hour(&self) -> f64 {
        self.0.false_alarms_per_hour
    }

    /// From when to when contacts were found in the log and left out, `(k, 2)` [s]; a read-only copy.
    #[getter]
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        Ok(read_only(from_rows(py, self.0.contacts.iter().copied())?))
    }

    /// What the motion could not tell, and which motion would: a tuple of sentences.
    #[getter]
    fn notes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.0.notes)
    }

    /// Whether it is of this robot and can be used.
    ///
    /// Args:
    ///     robot: The robot.
    ///
    /// Raises:
    ///     InputError: The calibration is of another robot, or a number cannot be used; the message says which.
    fn check(&self, robot: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = robot.py();
        let robot = self::robot(robot)?;
        self.0.check(&robot.get().0).map_err(|error| to_python(py, error))
    }

    /// All attributes by name.
    ///
    /// Returns:
    ///     Plain Python values: numbers, strings, and lists in place of arrays.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        plain_dict(slf.as_any(), ATTRIBUTES)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "Calibration", &self.0)
    }

    fn __repr__(&self) -> String {
        let largest = self.0.residual.iter().fold(0.0_f64, |largest, x| largest.max(*x));
        let count = |number: usize, what: &str| match number {
            0 => String::new(),
            1 => format!(", 1 {what}"),
            _ => format!(", {number} {what}s"),
        };
        format!(
            "Calibration('{}', {} joints, residual at most {} Nm{}{}{})",
            self.0.robot,
            self.0.joints.len(),
            if (1e-3..1e4).contains(&largest) { format!("{largest:.3}") } else { format!("{largest:.2e}") },
            if self.0.payload.is_some() { ", payload" } else { "" },
            count(self.0.contacts.len(), "contact"),
            count(self.0.notes.len(), "note"),
        )
    }
}

/// From the columns of a log, each flat.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // the columns of a log
pub fn _calibrate(
    robot: &Bound<'_, PyAny>,
    time: &Bound<'_, PyAny>,
    q: &Bound<'_, PyAny>,
    v: &Bound<'_, PyAny>,
    tau: &Bound<'_, PyAny>,
    false_alarms_per_hour: &Bound<'_, PyAny>,
    payload_link: Option<&Bound<'_, PyAny>>,
    torque_is_external: bool,
) -> PyResult<PyCalibration> {
    let py = robot.py();
    let robot = self::robot(robot)?.get().0.clone();
    let link = |object| {
        let name = text("payload_link", object)?;
        robot.link(name).map_err(|_| {
            let names: Vec<&str> = robot.links().iter().map(|link| link.name.as_str()).collect();
            input(py, format!("payload_link: there is no link '{name}'; the links are {}", names.join(", ")))
        })
    };
    let options = CalibrationOptions {
        false_alarms_per_hour: number("false_alarms_per_hour", false_alarms_per_hour)?,
        payload_link: payload_link.map(link).transpose()?,
        torque_is_external,
    };
    let (time, q) = (Vector::new("time", time)?, Vector::new("q", q)?);
    let (v, tau) = (Vector::new("v", v)?, Vector::new("tau", tau)?);
    let work = move || {
        let log = Log { time: time.slice(), q: q.slice(), v: v.slice(), tau: tau.slice() };
        calibrate(&robot, &log, &options)
    };
    let calibration = interruptible(py, work)?;
    calibration.map(PyCalibration).map_err(|error| to_python(py, error))
}
