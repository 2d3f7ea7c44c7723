//! `ContactMonitor` and `ContactReport`.

use std::sync::Arc;

use contactsense::isolation::IsolatorOptions;
use contactsense::monitor::{ContactMonitor, ContactReport, MonitorOptions};
use contactsense::robot::Robot;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays::{Number, Vector};
use crate::errors::to_python;
use crate::isolator::{contact_count, contacts, names};
use crate::observer::scalar_or_vector;
use crate::robot::PyRobot;

/// What the monitor says of one tick.
#[pyclass(frozen, name = "ContactReport", module = "contactsense._core")]
pub struct PyContactReport {
    robot: Arc<Robot>,
    report: ContactReport,
}

#[pymethods]
impl PyContactReport {
    /// Since the first call [s].
    #[getter]
    fn time(&self) -> f64 {
        self.report.time
    }

    /// Whether there is a contact.
    #[getter]
    fn collision(&self) -> bool {
        self.report.collision
    }

    /// Whether the contact began with this tick.
    #[getter]
    fn onset(&self) -> bool {
        self.report.onset
    }

    /// Links that detection alone names: on every branch those between the last joint over its threshold and the next.
    #[getter]
    fn links<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        names(py, &self.robot, &self.report.links)
    }

    /// `(nv,)` [Nm, N], free of the tracked bias.
    #[getter]
    fn external_torque<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.report.external_torque)
    }

    /// Estimated acceleration, `(nv,)`.
    #[getter]
    fn acceleration<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.report.acceleration)
    }

    /// The contacts; empty while there is no collision.
    #[getter]
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        contacts(py, &self.robot, &self.report.isolation)
    }

    fn __repr__(&self) -> String {
        format!(
            "ContactReport(time={:.4}, collision={}, {} contacts)",
            self.report.time,
            if self.report.collision { "True" } else { "False" },
            self.report.isolation.contacts.len()
        )
    }
}

/// The sense of touch of one robot, called once a control tick: observer, bias, detection, isolation.
///
/// `dt`: time between two calls [s]. `observer_gain`: scalar or `(nv,)` [1/s], default 50. `torque_threshold`: scalar
/// or `(nv,)` [Nm, N], default 0.5. `bias_time_constant` [s]: tracks the torque that a model's errors feign while
/// nothing touches; the first time constant is taken as free of contact. `hold_time` [s], default 0.02: a signal stays on so
/// long after it was last over its threshold. `max_contacts`, `pushing`: as in `ContactIsolator`. Raises `InputError` that
/// names the argument.
#[pyclass(name = "ContactMonitor", module = "contactsense._core")]
pub struct PyContactMonitor(ContactMonitor);

#[pymethods]
impl PyContactMonitor {
    #[new]
    #[pyo3(signature = (robot, *, dt, observer_gain=None, torque_threshold=None, bias_time_constant=None,
                        bias_settle_time=None, hold_time=None, max_contacts=None, pushing=true))]
    #[allow(clippy::too_many_arguments)] // the keywords of the Python class
    fn new(
        robot: &Bound<'_, PyRobot>,
        dt: Number,
        observer_gain: Option<&Bound<'_, PyAny>>,
        torque_threshold: Option<&Bound<'_, PyAny>>,
        bias_time_constant: Option<Number>,
        bias_settle_time: Option<Number>,
        hold_time: Option<Number>,
        max_contacts: Option<&Bound<'_, PyAny>>,
        pushing: bool,
    ) -> PyResult<Self> {
        let or_default = |name, object: Option<&Bound<'_, PyAny>>, default| {
            object.map_or(Ok(vec![default]), |object| scalar_or_vector(name, object))
        };
        let options = MonitorOptions {
            dt: dt.0,
            observer_gain: or_default("observer_gain", observer_gain, 50.0)?,
            isolation: IsolatorOptions {
                torque_threshold: or_default("torque_threshold", torque_threshold, 0.5)?,
                max_contacts: contact_count(max_contacts)?,
                pushing,
            },
            hold_time: hold_time.map_or(0.02, |number| number.0),
            bias_time_constant: bias_time_constant.map(|number| number.0),
            bias_settle_time: bias_settle_time.map(|number| number.0),
        };
        let monitor = ContactMonitor::new(robot.get().0.clone(), &options);
        Ok(Self(monitor.map_err(|error| to_python(robot.py(), error))?))
    }

    /// One tick: `q` `(nq,)`, `v` `(nv,)`, `tau` and `friction` `(nv,)` or `(nv - 6,)` for a floating base.
    ///
    /// Raises `InputError` that names the argument; the state is then unchanged.
    #[pyo3(signature = (q, v, tau, *, friction=None))]
    fn update(
        &mut self,
        py: Python<'_>,
        q: &Bound<'_, PyAny>,
        v: &Bound<'_, PyAny>,
        tau: &Bound<'_, PyAny>,
        friction: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PyContactReport> {
        let (q, v, tau) = (Vector::new("q", q)?, Vector::new("v", v)?, Vector::new("tau", tau)?);
        let friction = Vector::optional("friction", friction)?;
        let friction = friction.as_ref().map(|friction| friction.slice());
        self.0.update(q.slice(), v.slice(), tau.slice(), friction).map_err(|error| to_python(py, error))?;
        Ok(PyContactReport { robot: self.0.robot().clone(), report: self.0.report() })
    }

    /// Forgets all ticks, the bias too.
    fn reset(&mut self) {
        self.0.reset();
    }
}
