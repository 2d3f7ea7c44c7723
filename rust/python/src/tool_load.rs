//! `identify_tool` and `ToolLoad`.

use contactsense::sensor::{self, ToolLoad};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::shown;
use crate::arrays::{Readings, Table};
use crate::errors::{input, to_python};
use crate::pickle::{plain_dict, reduced, Reduced};
use crate::returned::{from_rows, numbers, read_only};
use crate::robot::PyRobot;
use crate::robot_argument::robot;
use crate::sensor::PyForceTorqueSensor;

/// A tool behind a force/torque sensor, and the sensor's offset, as `identify_tool` finds them.
///
/// `robot.with_payload(tool.link, tool.mass, tool.com)` and a sensor with `offset=tool.offset` read zero where nothing
/// touches the robot. Frozen; equal where all numbers are; can be pickled and copied.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> sensor = cs.ForceTorqueSensor("wrist", "iiwa_link_7")
///     >>> q = np.array([robot.random_configuration(seed) for seed in range(6)])
///     >>> compensator = cs.LoadCompensator(robot, [sensor])
///     >>> readings = np.concatenate([-compensator.tare(row, np.zeros((1, 6))) for row in q])
///     >>> tool = cs.identify_tool(robot, sensor, q, readings)  # of a robot that has no tool
///     >>> round(tool.mass, 6), tool.com_std.round(3).tolist()
///     (0.0, [0.3, 0.3, 0.3])
#[pyclass(frozen, eq, skip_from_py_object, name = "ToolLoad", module = "contactsense")]
#[derive(PartialEq, Clone)]
pub struct PyToolLoad(pub ToolLoad);

#[pymethods]
impl PyToolLoad {
    /// The sensor's link, which holds the tool.
    #[getter]
    fn link(&self) -> &str {
        &self.0.link
    }

    /// Mass in addition to the robot's description [kg]; not negative.
    #[getter]
    fn mass(&self) -> f64 {
        self.0.mass
    }

    /// Standard deviation of `mass` [kg].
    #[getter]
    fn mass_std(&self) -> f64 {
        self.0.std()[0]
    }

    /// Its centre of mass, `(3,)`, link frame [m]; a read-only copy.
    #[getter]
    fn com<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        numbers(py, &self.0.com)
    }

    /// Standard deviation of each coordinate of `com`, `(3,)` [m]; a read-only copy.
    ///
    /// It is 0.3 m where the mass is too small to tell.
    #[getter]
    fn com_std<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        numbers(py, &self.0.std()[1..4])
    }

    /// What the sensor reads without load, `(6,)` [N, Nm], in its own axes and convention; a read-only copy.
    #[getter]
    fn offset<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        numbers(py, &self.0.offset)
    }

    /// Standard deviation of each number of `offset`, `(6,)` [N, Nm]; a read-only copy.
    #[getter]
    fn offset_std<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        numbers(py, &self.0.std()[4..])
    }

    /// Covariance of mass, centre of mass and offset, in this order, `(10, 10)` [kg, m, N, Nm]; a read-only copy.
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        Ok(read_only(from_rows(py, self.0.covariance.iter().copied())?))
    }

    /// What is left of the mean readings, root mean square over the poses, `(6,)` [N, Nm]; a read-only copy.
    #[getter]
    fn residual<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        numbers(py, &self.0.residual)
    }

    /// All attributes by name.
    ///
    /// Returns:
    ///     Plain Python values: numbers, strings, and lists in place of arrays.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        plain_dict(
            slf.as_any(),
            &["link", "mass", "mass_std", "com", "com_std", "offset", "offset_std", "covariance", "residual"],
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "ToolLoad", &self.0)
    }

    fn __repr__(&self) -> String {
        let ToolLoad { link, mass, com, .. } = &self.0;
        format!("ToolLoad('{link}', mass={mass:.4} +- {:.4}, com={com:.4?})", self.0.std()[0])
    }
}

/// Finds the mass and centre of a tool that the robot's description lacks, and the sensor's offset, from poses at rest.
///
/// For a sensor that was zeroed with the tool on, or never: one pose cannot tell offset from weight, four can. Gravity must
/// point in four directions of the sensor frame that differ about two axes; more and larger differences are better. The
/// robot stands still in each pose, and nothing touches it behind the sensor. The sensor's own `offset` is not looked at.
///
/// Args:
///     robot: The robot, without the tool.
///     sensor: A `ForceTorqueSensor`.
///     q: Configurations, `(n, nq)`, one for each pose.
///     wrenches: Readings as the sensor gives them, `(n, 6)`, or several in each pose, `(n, k, 6)`, whose mean counts
///         [N, Nm], sensor axes. A NaN leaves a reading out; a pose without any is left out.
///
/// Returns:
///     A `ToolLoad`.
///
/// Raises:
///     InputError: Names the argument: also where the poses do not suffice, with the directions of gravity that are missing,
///         and where the readings are those of no tool.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> sensor = cs.ForceTorqueSensor("wrist", "iiwa_link_7")
///     >>> loaded = cs.LoadCompensator(robot.with_payload("iiwa_link_7", 1.2, [0.0, 0.0, 0.1]), [sensor])
///     >>> q = np.array([robot.random_configuration(seed) for seed in range(6)])
///     >>> readings = np.concatenate([-loaded.tare(row, np.zeros((1, 6))) for row in q])
///     >>> tool = cs.identify_tool(robot, sensor, q, readings + [5.0, 0.0, 0.0, 0.0, 0.0, 0.0])
///     >>> round(tool.mass, 3), round(float(tool.com[2]), 3), round(float(tool.offset[0]), 3)
///     (1.2, 0.1, 5.0)
#[pyfunction]
pub fn identify_tool(
    #[pyo3(from_py_with = robot)] robot: Bound<'_, PyRobot>,
    sensor: &Bound<'_, PyAny>,
    q: &Bound<'_, PyAny>,
    wrenches: &Bound<'_, PyAny>,
) -> PyResult<PyToolLoad> {
    let py = robot.py();
    let model = &robot.get().0;
    let sensor = sensor.cast::<PyForceTorqueSensor>().map_err(|_| {
        input(py, format!("sensor: expected a contactsense.ForceTorqueSensor, got {}", shown(sensor)))
    })?;
    let expected = format!("(n, {})", model.nq());
    let q = Table::new("q", q, 2, &expected)?;
    if q.shape[1] != model.nq() {
        return Err(input(py, format!("q: expected shape {expected}, got {:?}", q.shape)));
    }
    let wrenches = Readings::in_poses(wrenches, q.shape[0])?;
    let found = sensor::identify_tool(model, &sensor.get().0, &q.numbers, wrenches.rows());
    found.map(PyToolLoad).map_err(|error| to_python(py, error))
}
