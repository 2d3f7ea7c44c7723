//! `Finding` and `diagnose`.

use contactsense::diagnosis::{self, Recording};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::{Readings, Table, Vector};
use crate::errors::{detached, input, to_python};
use crate::pickle::{plain_dict, reduced, Reduced};
use crate::returned::vector;
use crate::robot::PyRobot;
use crate::robot_argument::robot;
use crate::sensor::sensors;

/// One thing that is wrong with a robot's model or measurements, as `diagnose` finds it.
///
/// Frozen; equal where all attributes are; can be pickled and copied.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> time = np.arange(0.0, 12.0, 0.01)[:, None]
///     >>> phase = time * np.linspace(1.0, 2.0, 7) + np.arange(7)
///     >>> q, v, a = 0.5 * np.sin(phase), 0.5 * np.linspace(1.0, 2.0, 7) * np.cos(phase), -0.5 * np.linspace(1.0, 2.0, 7) ** 2 * np.sin(phase)
///     >>> tau = np.array([robot.inverse_dynamics(*row) for row in zip(q, v, a)])
///     >>> cs.diagnose(robot, q, v, tau)
///     ()
///     >>> finding = cs.diagnose(robot, q, v, -tau)[0]
///     >>> finding.code, finding.severity, finding.joint
///     ('sign', 'major', None)
#[pyclass(frozen, eq, skip_from_py_object, name = "Finding", module = "contactsense")]
#[derive(PartialEq, Clone)]
pub struct PyFinding(pub diagnosis::Finding);

#[pymethods]
impl PyFinding {
    /// What is wrong.
    ///
    /// "sign", "scale", "gravity_free", "permuted", "payload", "tool", "armature", "friction", "bias", "delay",
    /// "filtered", "limit", "sensor_offset", "gravity_direction", "units", or "not_judged" where something could not be
    /// judged.
    #[getter]
    fn code(&self) -> &'static str {
        self.0.code.name()
    }

    /// Name of the joint; None where it is not one joint.
    #[getter]
    fn joint(&self) -> Option<&str> {
        self.0.joint.as_deref()
    }

    /// Name of the link that carries a payload or a tool; otherwise None.
    #[getter]
    fn link(&self) -> Option<&str> {
        self.0.link.as_deref()
    }

    /// Name of the force/torque sensor; otherwise None.
    #[getter]
    fn sensor(&self) -> Option<&str> {
        self.0.sensor.as_deref()
    }

    /// How large it is, in `unit`; NaN where the fault has no size. Of several joints, the worst.
    #[getter]
    fn value(&self) -> f64 {
        self.0.value.unwrap_or(f64::NAN)
    }

    /// Unit of `value`, such as "kg", "Nm", "s" or "deg"; empty for a factor.
    #[getter]
    fn unit(&self) -> &str {
        &self.0.unit
    }

    /// Centre of mass of a payload in the link's frame [m], gravity in the world frame [m/s^2], or the offset of a sensor.
    ///
    /// `(3,)`, NaN for other faults; read-only.
    #[getter]
    fn vector<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.0.vector.map(Into::into))
    }

    /// What is wrong, with sizes and units.
    #[getter]
    fn message(&self) -> &str {
        &self.0.message
    }

    /// Share of the variance, unexplained until then, that it explains, from 0 to 1.
    #[getter]
    fn evidence(&self) -> f64 {
        self.0.evidence
    }

    /// How much it matters: "major" where it spoils the detection of contacts, otherwise "minor".
    #[getter]
    fn severity(&self) -> &'static str {
        self.0.severity.name()
    }

    /// All attributes by name.
    ///
    /// Returns:
    ///     Plain Python values: numbers, strings, None, and a list in place of the array.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let names =
            ["code", "joint", "link", "sensor", "value", "unit", "vector", "message", "evidence", "severity"];
        plain_dict(slf.as_any(), &names)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "Finding", &self.0)
    }

    fn __repr__(&self) -> String {
        format!("Finding('{}', {}: {})", self.0.code.name(), self.0.severity.name(), self.0.message)
    }
}

/// Finds what is wrong with a robot's model or measurements, from motion without contact.
///
/// Ten seconds or more in which all joints move say most. A few rows with contacts do no harm.
///
/// Args:
///     robot: The robot.
///     q: Configurations, `(n, nq)`, at least 30 rows in the order of time.
///     v: Velocities, `(n, nv)` [rad/s; m/s for sliding joints].
///     tau: Joint torques, `(n, nv)`, or `(n, nv - 6)` for a floating base [Nm; N for sliding joints].
///     sensors: Force/torque sensors, of `ForceTorqueSensor`.
///     wrenches: Their readings, `(n, n_sensors, 6)` [N, Nm], sensor axes; NaN where there is none.
///     time: Time of each row, `(n,)`, increasing [s]. Without it, equal steps are assumed, and their length follows from
///         `q` and `v`.
///
/// Returns:
///     What is wrong, the most important first; empty where all is well.
///
/// Raises:
///     InputError: Names the argument.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> rng = np.random.default_rng(0)
///     >>> q, v = rng.uniform(-1.0, 1.0, (60, 7)), np.zeros((60, 7))
///     >>> [finding.code for finding in cs.diagnose(robot, q, v, np.zeros((60, 7)))]
///     ['gravity_free', 'not_judged']
#[pyfunction]
#[pyo3(signature = (robot, q, v, tau, *, sensors=None, wrenches=None, time=None),
       text_signature = "(robot, q, v, tau, *, sensors=(), wrenches=None, time=None)")]
pub fn diagnose<'py>(
    #[pyo3(from_py_with = robot)] robot: Bound<'py, PyRobot>,
    q: &Bound<'py, PyAny>,
    v: &Bound<'py, PyAny>,
    tau: &Bound<'py, PyAny>,
    sensors: Option<&Bound<'py, PyAny>>,
    wrenches: Option<&Bound<'py, PyAny>>,
    time: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyTuple>> {
    let py = robot.py();
    let sensors = sensors.map_or_else(|| Ok(vec![]), self::sensors)?;
    let core = &robot.get().0;
    let (nq, nv) = (core.nq(), core.nv());
    let q = Table::new("q", q, 2, &format!("(n, {nq})"))?;
    let v = Table::new("v", v, 2, &format!("(n, {nv})"))?;
    let tau = Table::new("tau", tau, 2, &format!("(n, {})", nv - core.unactuated()))?;
    let n = q.shape[0];
    for (name, table, width) in [("q", &q, nq), ("v", &v, nv)] {
        if table.shape != [n, width] {
            return Err(input(py, format!("{name}: expected shape ({n}, {width}), got {:?}", table.shape)));
        }
    }
    if tau.shape != [n, nv] && tau.shape != [n, nv - core.unactuated()] {
        let wanted = nv - core.unactuated();
        return Err(input(py, format!("tau: expected shape ({n}, {wanted}), got {:?}", tau.shape)));
    }
    let time = Vector::optional("time", time)?;
    let readings = match wrenches {
        None if sensors.is_empty() => None,
        None => return Err(input(py, "wrenches: expected the readings of the sensors".into())),
        Some(wrenches) => Some(Readings::several(wrenches, Some(n), sensors.len())?),
    };
    let recording = Recording {
        time: time.as_ref().map(Vector::slice),
        q: &q.numbers,
        v: &v.numbers,
        tau: &tau.numbers,
        sensors: &sensors,
        wrenches: readings.as_ref().map_or(&[], Readings::rows),
    };
    let findings =
        detached(py, || diagnosis::diagnose(core, &recording))?.map_err(|error| to_python(py, error))?;
    PyTuple::new(py, findings.into_iter().map(PyFinding))
}
