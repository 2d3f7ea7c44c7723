//! `Candidate`.

use std::sync::Arc;

use contactsense::isolation::Candidate;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::names::Names;
use crate::once::Once;
use crate::pickle::{plain_dict, reduced, Reduced};
use crate::returned::numbers;

type Array<'py> = Bound<'py, PyArray1<f64>>;

/// A place where the line of action meets a surface.
///
/// Frozen; can be pickled and copied.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> tau_ext = [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0]
///     >>> contact = cs.ContactIsolator(robot).isolate(np.full(7, 0.4), tau_ext).contacts[0]
///     >>> all(candidate.point.shape == (3,) for candidate in contact.candidates)
///     True
#[pyclass(frozen, name = "Candidate", module = "contactsense")]
pub struct PyCandidate {
    names: Arc<Names>,
    candidate: Candidate,
    point: Once<PyArray1<f64>>,
    normal: Once<PyArray1<f64>>,
}

impl PyCandidate {
    pub fn new(names: Arc<Names>, candidate: Candidate) -> Self {
        Self { names, candidate, point: Once::default(), normal: Once::default() }
    }

    pub fn from_content((names, candidate): (Names, Candidate)) -> Self {
        Self::new(Arc::new(names), candidate)
    }
}

#[pymethods]
impl PyCandidate {
    /// Name of the link.
    #[getter]
    fn link(&self) -> &str {
        self.names.link(self.candidate.link)
    }

    /// Where the line meets the surface, `(3,)`, world frame [m]; read-only.
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        self.point.get(py, || Ok(numbers(py, self.candidate.point.as_slice())))
    }

    /// Outward unit normal of the surface, `(3,)`, world frame; read-only.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        self.normal.get(py, || Ok(numbers(py, self.candidate.normal.as_slice())))
    }

    /// Whether the force enters the surface here.
    #[getter]
    fn pushing(&self) -> bool {
        self.candidate.pushing
    }

    /// All attributes by name.
    ///
    /// Returns:
    ///     Plain Python values: numbers, strings, and lists in place of arrays.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        plain_dict(slf.as_any(), &["link", "point", "normal", "pushing"])
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "Candidate", &(&*self.names, &self.candidate))
    }

    fn __repr__(&self) -> String {
        let (p, kind) = (&self.candidate.point, if self.candidate.pushing { "pushing" } else { "pulling" });
        format!("Candidate('{}', point=[{:.4}, {:.4}, {:.4}], {kind})", self.link(), p.x, p.y, p.z)
    }
}
