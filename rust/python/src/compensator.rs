//! `LoadCompensator`.

use std::sync::Mutex;

use contactsense::sensor::LoadCompensator;
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::arguments::{robot, sole};
use crate::arrays::{Readings, Vector};
use crate::errors::to_python;
use crate::returned::wrench_rows;
use crate::robot::PyRobot;
use crate::sensor::sensors;

/// Frees the readings of force/torque sensors of the weight and inertia behind them (Vorndamme 2017, eqs. 13-19).
///
/// One pass serves all sensors, also several in a chain and those at fixed joints.
///
/// Args:
///     robot: the robot that carries the sensors.
///     sensors: the sensors, in the order of the readings; names and links are unique.
///
/// Raises:
///     InputError: a sensor cannot be used; names it.
///
/// Example:
///     >>> import contactsense as cs
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> compensator = cs.LoadCompensator(robot, [cs.ForceTorqueSensor("wrist", "iiwa_link_7")])
///     >>> q, v = robot.neutral(), robot.velocity({})
///     >>> compensator.update(q, v, v, [[0.0, 0.0, -3.0, 0.0, 0.0, 0.0]]).shape
///     (1, 6)
#[pyclass(frozen, name = "LoadCompensator", module = "contactsense")]
pub struct PyLoadCompensator {
    compensator: Mutex<LoadCompensator>,
    shown: String,
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
        let shown = format!("LoadCompensator('{}', {} sensors)", robot.get().0.name(), sensors.len());
        Ok(Self { compensator, shown })
    }

    fn __repr__(&self) -> &str {
        &self.shown
    }

    /// The external wrench that each sensor measures.
    ///
    /// Args:
    ///     q: configuration, `(nq,)`.
    ///     v: velocity, `(nv,)` [rad/s, m/s].
    ///     a: acceleration, `(nv,)` [rad/s^2, m/s^2].
    ///     wrenches: the readings, `(n_sensors, 6)`, sensor axes [N, Nm]. A NaN in a reading leaves its sensor out.
    ///
    /// Returns:
    ///     `(n_sensors, 6)` [N, Nm]: force and moment on the robot at the sensor's origin, world axes; NaN for a sensor that
    ///     is left out.
    ///
    /// Raises:
    ///     InputError: an argument cannot be used; names it.
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
