//! `ContactReport`.

use std::sync::Arc;

use contactsense::monitor::ContactReport;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::contact::contacts;
use crate::names::Names;
use crate::once::Once;
use crate::pickle::{plain_dict, reduced, Reduced};
use crate::returned::{numbers, wrench_rows};

const ATTRIBUTES: [&str; 15] = [
    "time",
    "collision",
    "onset",
    "significance",
    "remainder_learned",
    "links",
    "external_torque",
    "collision_torque",
    "wrenches",
    "sensors_left_out",
    "joints_left_out",
    "limited_joints",
    "acceleration",
    "contacts",
    "truncated",
];

/// What the monitor says of one tick.
///
/// Frozen; can be pickled and copied.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> monitor = cs.ContactMonitor(cs.Robot.named("iiwa14"), dt=1e-3)
///     >>> report = monitor.update(np.zeros(7), np.zeros(7), np.zeros(7))
///     >>> report.collision, report.contacts, report.to_dict()["time"]
///     (False, (), 0.0)
#[pyclass(frozen, name = "ContactReport", module = "contactsense")]
pub struct PyContactReport {
    names: Arc<Names>,
    report: ContactReport,
    acceleration: Vec<f64>,
    arrays: Arrays,
    contacts: Once<PyTuple>,
}

#[derive(Default)]
struct Arrays {
    external_torque: Once<PyArray1<f64>>,
    collision_torque: Once<PyArray1<f64>>,
    wrenches: Once<PyArray2<f64>>,
    acceleration: Once<PyArray1<f64>>,
}

impl PyContactReport {
    pub fn new(names: Arc<Names>, report: ContactReport, acceleration: Vec<f64>) -> Self {
        Self { names, report, acceleration, arrays: Arrays::default(), contacts: Once::default() }
    }

    pub fn report(&self) -> &ContactReport {
        &self.report
    }

    pub fn from_content((names, report, acceleration): (Names, ContactReport, Vec<f64>)) -> Self {
        Self::new(Arc::new(names), report, acceleration)
    }
}

#[pymethods]
impl PyContactReport {
    /// Time since the first accepted call [s].
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

    /// How unlikely the torques are without contact [standard deviations], or None where each joint has a threshold.
    ///
    /// A Gaussian number would be so many standard deviations off as rarely; the largest over the gains of all observers.
    #[getter]
    fn significance(&self) -> Option<f64> {
        self.report.significance
    }

    /// Whether a torque that stood still became the bias in this tick, which ended the contact.
    ///
    /// That is what `hysteresis` may have left, what outlasted `bias_settle_time`, or no torque at all where the bias
    /// before was wrong.
    #[getter]
    fn remainder_learned(&self) -> bool {
        self.report.remainder_learned
    }

    /// Names of the links that detection alone leaves for a contact.
    ///
    /// On every branch those between the last joint or sensor over its threshold and the next (Vorndamme 2017, eq. 21).
    #[getter]
    fn links<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        self.names.of_links(py, &self.report.links)
    }

    /// External torque of all contacts, free of the tracked bias, `(nv,)` [Nm; N for sliding joints]; read-only.
    #[getter]
    fn external_torque<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.arrays.external_torque.get(py, || Ok(numbers(py, &self.report.external_torque)))
    }

    /// `external_torque` without wanted contacts and stops, `(nv,)` [Nm; N for sliding joints]; read-only.
    ///
    /// Zero at joints left out. Of contacts wanted at points, what no force there explains, by least squares.
    #[getter]
    fn collision_torque<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.arrays.collision_torque.get(py, || Ok(numbers(py, &self.report.collision_torque)))
    }

    /// The external wrench that each sensor sees, `(n_sensors, 6)` [N, Nm]; read-only.
    ///
    /// (force, moment) on the robot at the sensor's origin, world axes; NaN where a sensor is left out.
    #[getter]
    fn wrenches<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.arrays.wrenches.get(py, || wrench_rows(py, &self.report.wrenches))
    }

    /// Names of the sensors without a reading in this tick.
    #[getter]
    fn sensors_left_out<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.report.sensors_left_out.iter().map(|sensor| &self.names.sensors[sensor.get()]))
    }

    /// Names of the joints whose torques say nothing of a collision, since a wanted contact loads them unmeasured.
    ///
    /// Those behind its sensor, and while that gives no reading (and a little after) those between it and the base.
    #[getter]
    fn joints_left_out<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.report.joints_left_out.iter().map(|joint| &self.names.joints[*joint]))
    }

    /// Names of the joints at a limit of their position whose stop pushes them inward, which is no contact.
    ///
    /// Within 0.005 rad, 1 mm for sliding joints, and at most 0.2 % of the range, or ten times that beyond the limit.
    #[getter]
    fn limited_joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.report.limited_joints.iter().map(|joint| &self.names.joints[*joint]))
    }

    /// Estimated acceleration, `(nv,)` [rad/s^2; m/s^2 for sliding joints]; read-only.
    ///
    /// NaN after `update_external`: the motors' torque is not known there.
    #[getter]
    fn acceleration<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.arrays.acceleration.get(py, || Ok(numbers(py, &self.acceleration)))
    }

    /// The contacts; empty while there is no collision. The same tuple at every access.
    #[getter]
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        self.contacts.get(py, || contacts(py, &self.names, &self.report.isolation))
    }

    /// Whether something was left out.
    ///
    /// There were more contacts than `max_contacts`, more intersections of a line than are kept (the nearest are), or
    /// more explanations to try than the bounded work of a call allows.
    #[getter]
    fn truncated(&self) -> bool {
        self.report.isolation.truncated
    }

    /// All attributes by name.
    ///
    /// Returns:
    ///     Plain Python values: numbers, strings, lists in place of arrays and tuples, and dicts in place of contacts.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        plain_dict(slf.as_any(), &ATTRIBUTES)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "ContactReport", &(&*self.names, &self.report, &self.acceleration))
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
