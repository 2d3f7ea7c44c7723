//! `LoadCompensator`.

use std::sync::Mutex;

use contactsense::sensor::{ForceTorqueSensor, LoadCompensator};
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arguments::{robot, sole};
use crate::arrays::{Readings, Vector};
use crate::errors::to_python;
use crate::returned::wrench_rows;
use crate::robot::PyRobot;
use crate::sensor::{sensor_tuple, sensors};

/// Frees the readings of force/torque sensors of the weight and inertia behind them (Vorndamme 2017, eqs. 13-19).
///
/// One pass for all sensors, also for several in a chain and at fixed joints. One thread at a time may use it.
///
/// Args:
///     robot: The robot.
///     sensors: Of `ForceTorqueSensor`; names and links are unique.
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
    sensors: Vec<ForceTorqueSensor>,
    compensator: Mutex<LoadCompensator>,
}

#[pymethods]
impl PyLoadCompensator {
    #[new]
    fn new(
        #[pyo3(from_py_with = robot)] robot: Bound<'_, PyRobot>,
        sensors: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let sensors = self::sensors(sensors)?;
        let compensator = LoadCompensator::new(robot.get().0.clone(), &sensors);
        let compensator = Mutex::new(compensator.map_err(|error| to_python(robot.py(), error))?);
        Ok(Self { robot: robot.unbind(), sensors, compensator })
    }

    /// The robot.
    #[getter]
    fn robot(&self, py: Python<'_>) -> Py<PyRobot> {
        self.robot.clone_ref(py)
    }

    /// The sensors, of `ForceTorqueSensor`, in the order of the wrenches.
    #[getter]
    fn sensors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        sensor_tuple(py, &self.sensors)
    }

    fn __repr__(&self) -> String {
        format!("LoadCompensator('{}', {} sensors)", self.robot.get().0.name(), self.sensors.len())
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
        let mut compensator = sole(py, "LoadCompensator", &self.compensator)?;
        match compensator.update(q.slice(), v.slice(), a.slice(), wrenches.rows()) {
            Ok(external) => wrench_rows(py, external),
            Err(error) => Err(to_python(py, error)),
        }
    }
}
