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
/// One pass for all sensors, also for several in a chain and at fixed joints. `sensors`: of `ForceTorqueSensor`, names and
/// links unique. Raises `InputError` that names what is wrong.
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

    /// The external wrench that each sensor sees, `(n_sensors, 6)` [N, Nm]: on the robot, world axes, at the sensor's origin.
    ///
    /// `q` `(nq,)`, `v` and `a` `(nv,)`, `wrenches` `(n_sensors, 6)`: the readings, sensor axes. A reading with a NaN
    /// leaves its sensor out: its row is NaN, the others hold. Raises `InputError` that names the argument.
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
