//! `ContactMonitor` on rows of a log: the calls of a control loop, without a Python object a row.

use contactsense::{ExternalSample, Sample};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays::{Readings, Vector};
use crate::classification::{PyContactClass, PyContactClassifier};
use crate::contact::contacts;
use crate::errors::{input, to_python};
use crate::monitor::PyContactMonitor;

type Column<'py> = Bound<'py, PyArray1<f64>>;

/// A class of a row: the row, the number of the contact that is classified, its place among the row's contacts, and the class.
type Classified<'py> = (usize, u64, Option<usize>, Bound<'py, PyContactClass>);

/// Collision, onset (1 or 0) and significance of each row, the external torques one after the other, the contacts of each row
/// that has some, and all classes.
type Columns<'py> = (
    Column<'py>,
    Column<'py>,
    Column<'py>,
    Column<'py>,
    Vec<(usize, Bound<'py, PyTuple>)>,
    Vec<Classified<'py>>,
);

#[pymethods]
impl PyContactMonitor {
    /// `update` of rows one after the other, or `update_external` where `external` says so.
    ///
    /// All arrays are flat; a step of NaN is that of the monitor, `wrenches` has one row for each sensor of each row. Without a
    /// `classifier` there are no classes.
    fn _update_rows<'py>(
        &self,
        py: Python<'py>,
        arrays: [Bound<'py, PyAny>; 4],
        wrenches: Option<&Bound<'py, PyAny>>,
        external: bool,
        classifier: Option<&Bound<'py, PyContactClassifier>>,
    ) -> PyResult<Columns<'py>> {
        let [q, v, tau, steps] = &arrays;
        let (q, v) = (Vector::new("q", q)?, Vector::new("v", v)?);
        let (tau, steps) = (Vector::new("tau", tau)?, Vector::new("steps", steps)?);
        let readings = wrenches.map(Readings::new).transpose()?;
        let rows = steps.slice().len();
        let mut monitor = self.sole(py)?;
        let mut classifier = classifier.map(|classifier| classifier.get().sole(py)).transpose()?;
        let width = |array: &Vector| array.slice().len() / rows.max(1);
        let (nq, nv, nt) = (width(&q), width(&v), width(&tau));
        if [(&q, nq), (&v, nv), (&tau, nt)].iter().any(|(array, width)| array.slice().len() != width * rows) {
            return Err(input(py, "rows: all arrays must have as many as there are steps".into()));
        }
        let sensors = readings.as_ref().map_or(0, |readings| readings.rows().len() / rows.max(1));
        let mut columns = [vec![0.0; rows], vec![0.0; rows], vec![f64::NAN; rows]];
        let mut torques = Vec::with_capacity(rows * nv);
        let (mut found, mut classified) = (vec![], vec![]);
        for (row, step) in steps.slice().iter().enumerate() {
            let parts = [(&q, nq), (&v, nv), (&tau, nt)];
            let [q, v, tau] = parts.map(|(array, width)| &array.slice()[row * width..(row + 1) * width]);
            let wrenches = readings.as_ref().map(|it| &it.rows()[row * sensors..(row + 1) * sensors]);
            let step = (!step.is_nan()).then_some(*step);
            let report = if external {
                let mut sample = ExternalSample::new(q, tau).velocity(v);
                sample = wrenches.map_or(sample, |wrenches| sample.wrenches(wrenches));
                monitor.update_external(&step.map_or(sample, |step| sample.dt(step)))
            } else {
                let mut sample = Sample::new(q, v, tau);
                sample = wrenches.map_or(sample, |wrenches| sample.wrenches(wrenches));
                monitor.update(&step.map_or(sample, |step| sample.dt(step)))
            };
            let report = report.map_err(|error| to_python(py, error))?;
            columns[0][row] = f64::from(u8::from(report.collision));
            columns[1][row] = f64::from(u8::from(report.onset));
            columns[2][row] = report.significance.unwrap_or(f64::NAN);
            torques.extend_from_slice(&report.external_torque);
            if !report.isolation.contacts.is_empty() {
                found.push((row, contacts(py, &self.names, &report.isolation)?));
            }
            if let Some(classifier) = classifier.as_mut() {
                classifier.update(q, v, report).map_err(|error| to_python(py, error))?;
                for (class, (number, place)) in classifier.classes().iter().zip(classifier.reported()) {
                    classified.push((row, *number, *place, Bound::new(py, PyContactClass(*class))?));
                }
            }
        }
        let [collision, onset, significance] = columns.map(|column| PyArray1::from_vec(py, column));
        Ok((collision, onset, significance, PyArray1::from_vec(py, torques), found, classified))
    }
}
