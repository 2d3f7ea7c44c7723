//! `LoadCompensator`.

use std::sync::{Arc, Mutex, MutexGuard};

use contactsense::sensor::LoadCompensator;
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arguments::sole;
use crate::arrays::{rows, Readings, Vector};
use crate::calibration::calibration_of;
use crate::errors::to_python;
use crate::returned::{from_rows, read_only, wrench_rows};
use crate::robot::PyRobot;
use crate::robot_argument::robot;
use crate::sensor::{sensor_tuple, sensors};

/// Frees the readings of force/torque sensors of the weight and inertia behind them (Vorndamme 2017, eqs. 13-19).
///
/// One pass for all sensors, also for several in a chain and at fixed joints. One thread at a time may use it.
///
/// Args:
///     robot: The robot.
///     sensors: Of `ForceTorqueSensor`; names and links are unique.
///     calibration: A `Calibration` of this robot: inertias are those that its motion showed, and its `sensor_offsets`
///         replace the offset of each sensor that they name.
///
/// Raises:
///     InputError: Names the argument.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> compensator = cs.LoadCompensator(robot, [cs.ForceTorqueSensor("wrist", robot.link_names[-1])])
///     >>> compensator.update(np.zeros(7), np.zeros(7), np.zeros(7), np.zeros((1, 6))).shape
///     (1, 6)
#[pyclass(frozen, name = "LoadCompensator", module = "contactsense")]
pub struct PyLoadCompensator {
    robot: Py<PyRobot>,
    compensator: Mutex<LoadCompensator>,
}

impl PyLoadCompensator {
    fn sole(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, LoadCompensator>> {
        sole(py, "LoadCompensator", &self.compensator)
    }
}

#[pymethods]
impl PyLoadCompensator {
    #[new]
    #[pyo3(signature = (robot, sensors, *, calibration=None))]
    fn new(
        #[pyo3(from_py_with = robot)] robot: Bound<'_, PyRobot>,
        sensors: &Bound<'_, PyAny>,
        calibration: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let (py, model) = (robot.py(), &robot.get().0);
        let sensors = self::sensors(sensors)?;
        let compensator = match calibration.map(calibration_of).transpose()? {
            Some(calibration) => calibration.corrected(model).and_then(|corrected| {
                LoadCompensator::new(Arc::new(corrected), &calibration.sensors_with_offsets(&sensors))
            }),
            None => LoadCompensator::new(model.clone(), &sensors),
        };
        let compensator = Mutex::new(compensator.map_err(|error| to_python(py, error))?);
        Ok(Self { robot: robot.unbind(), compensator })
    }

    /// The robot.
    #[getter]
    fn robot(&self, py: Python<'_>) -> Py<PyRobot> {
        self.robot.clone_ref(py)
    }

    /// The sensors, of `ForceTorqueSensor`, in the order of the wrenches, with their present offsets.
    #[getter]
    fn sensors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        sensor_tuple(py, self.sole(py)?.sensors())
    }

    /// What is subtracted from the readings, `(n_sensors, 6)` [N, Nm], sensor axes; a read-only copy. Can be set.
    #[getter]
    fn offsets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let compensator = self.sole(py)?;
        Ok(read_only(from_rows(py, compensator.sensors().iter().map(|sensor| sensor.offset))?))
    }

    #[setter]
    fn set_offsets(&self, offsets: &Bound<'_, PyAny>) -> PyResult<()> {
        let (py, offsets) = (offsets.py(), rows::<6>("offsets", offsets)?);
        self.sole(py)?.set_offsets(&offsets).map_err(|error| to_python(py, error))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let sensors = self.sole(py)?.sensors().len();
        Ok(format!("LoadCompensator('{}', {sensors} sensors)", self.robot.get().0.name()))
    }

    /// Sets the offsets so that the free load reads zero.
    ///
    /// The robot is at rest at `q`, and nothing touches it behind the sensors. One pose cannot tell an offset from a
    /// weight that the robot lacks: where the tool is not in the model, see `identify_tool`.
    ///
    /// Args:
    ///     q: Configuration, `(nq,)`.
    ///     wrenches: Readings as the sensors give them, `(n_sensors, 6)`, or several rows `(n, n_sensors, 6)`, whose mean
    ///         counts [N, Nm], sensor axes. A NaN leaves a reading out; a sensor without any keeps its offset.
    ///
    /// Returns:
    ///     The offsets, `(n_sensors, 6)` [N, Nm]; read-only.
    ///
    /// Raises:
    ///     InputError: Names the argument; the offsets are then unchanged.
    fn tare<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        wrenches: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (py, q) = (q.py(), Vector::new("q", q)?);
        let count = self.sole(py)?.sensors().len();
        let wrenches = Readings::one_or_several(wrenches, count)?;
        self.sole(py)?.tare(q.slice(), wrenches.rows()).map_err(|error| to_python(py, error))?;
        self.offsets(py)
    }

    /// The external wrench that each sensor sees.
    ///
    /// Args:
    ///     q: Configuration, `(nq,)`.
    ///     v: Velocity, `(nv,)` [rad/s; m/s for sliding joints].
    ///     a: Acceleration, `(nv,)` [rad/s^2; m/s^2 for sliding joints].
    ///     wrenches: The readings, `(n_sensors, 6)` [N, Nm], sensor axes. A NaN in a row leaves its sensor out: its row of
    ///         the answer is NaN, the others hold.
    ///
    /// Returns:
    ///     `(n_sensors, 6)` [N, Nm]: (force, moment) on the robot at each sensor's origin, world axes; read-only.
    ///
    /// Raises:
    ///     InputError: Names the argument.
    fn update<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        a: &Bound<'py, PyAny>,
        wrenches: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let py = q.py();
        let (q, v, a) = (Vector::new("q", q)?, Vector::new("v", v)?, Vector::new("a", a)?);
        let wrenches = Readings::new(wrenches)?;
        let mut compensator = self.sole(py)?;
        match compensator.update(q.slice(), v.slice(), a.slice(), wrenches.rows()) {
            Ok(external) => wrench_rows(py, external),
            Err(error) => Err(to_python(py, error)),
        }
    }
}
