//! `Isolation`.

use std::sync::Arc;

use contactsense::isolation::Isolation;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::contact::contacts;
use crate::names::Names;
use crate::once::Once;
use crate::pickle::{plain_dict, reduced, Reduced};

/// All contacts of one instant.
///
/// Frozen; can be pickled and copied.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> isolation = cs.ContactIsolator(robot).isolate(np.full(7, 0.4), [1.0, 2.0, 0.5, 0.0, 0.0, 0.0, 0.0])
///     >>> len(isolation.contacts), isolation.rank_deficit
///     (1, 3)
#[pyclass(frozen, name = "Isolation", module = "contactsense")]
pub struct PyIsolation {
    names: Arc<Names>,
    isolation: Isolation,
    contacts: Once<PyTuple>,
}

impl PyIsolation {
    pub fn new(names: Arc<Names>, isolation: Isolation) -> Self {
        Self { names, isolation, contacts: Once::default() }
    }

    pub fn from_content((names, isolation): (Names, Isolation)) -> Self {
        Self::new(Arc::new(names), isolation)
    }
}

#[pymethods]
impl PyIsolation {
    /// The contacts, farthest from the base first; the same tuple at every access.
    #[getter]
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        self.contacts.get(py, || contacts(py, &self.names, &self.isolation))
    }

    /// Components of the contacts' wrenches that the torques leave open (Vorndamme 2017, eq. 31).
    #[getter]
    fn rank_deficit(&self) -> usize {
        self.isolation.rank_deficit
    }

    /// Norm of the external torque that the contacts do not explain [Nm, N].
    #[getter]
    fn residual(&self) -> f64 {
        self.isolation.residual
    }

    /// Names of the links that may carry a contact, likeliest first.
    #[getter]
    fn link_candidates<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        self.names.of_links(py, &self.isolation.link_candidates)
    }

    /// Whether something was left out.
    ///
    /// There were more contacts than `max_contacts`, more intersections of a line than are kept (the nearest are), or
    /// more explanations to try than the bounded work of a call allows.
    #[getter]
    fn truncated(&self) -> bool {
        self.isolation.truncated
    }

    /// All attributes by name.
    ///
    /// Returns:
    ///     Plain Python values: numbers, strings, lists in place of arrays and tuples, and dicts in place of contacts.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let attributes = ["contacts", "rank_deficit", "residual", "link_candidates", "truncated"];
        plain_dict(slf.as_any(), &attributes)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "Isolation", &(&*self.names, &self.isolation))
    }

    fn __repr__(&self) -> String {
        format!(
            "Isolation({} contacts, rank_deficit={}, residual={:.3e})",
            self.isolation.contacts.len(),
            self.isolation.rank_deficit,
            self.isolation.residual
        )
    }
}
