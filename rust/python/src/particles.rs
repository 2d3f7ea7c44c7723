//! `Particles`: those of a filter or a sampler.

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::pickle::arrays_alone;
use crate::returned::{from_rows, numbers, read_only};
use crate::robot::PyRobot;

/// A copy of the particles, one row each; all arrays are read-only.
///
/// Frozen; can be pickled and copied.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> particle_filter = cs.ContactParticleFilter(cs.Robot.named("iiwa14"), particles=500)
///     >>> estimate = particle_filter.update(np.full(7, 0.4), [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])
///     >>> particle_filter.particles.point.shape
///     (500, 3)
#[pyclass(frozen, get_all, module = "contactsense")]
pub struct Particles {
    /// Number of the contact, `(n,)`: zero where there is one. Of several contacts, the rows of the second follow those of the first.
    pub contact: Py<PyArray1<i64>>,
    /// Index into `robot.link_names`, `(n,)`.
    pub link: Py<PyArray1<i64>>,
    /// Points on the surface, `(n, 3)`, world frame [m].
    pub point: Py<PyArray2<f64>>,
    /// Outward unit normals there, `(n, 3)`, world frame.
    pub normal: Py<PyArray2<f64>>,
    /// Force along the inward normal, `(n,)` [N].
    pub force: Py<PyArray1<f64>>,
    /// Stiffness of the contact, `(n,)` [N/m].
    pub stiffness: Py<PyArray1<f64>>,
    /// Weights, `(n,)`, which sum to one for each contact.
    pub weight: Py<PyArray1<f64>>,
}

/// One contact of a particle; the link by its number in the core, force along the inward normal.
pub struct Row {
    pub contact: usize,
    pub link: usize,
    pub point: [f64; 3],
    pub normal: [f64; 3],
    pub force: f64,
    pub stiffness: f64,
    pub weight: f64,
}

impl Particles {
    pub fn of(py: Python<'_>, robot: &PyRobot, rows: impl Iterator<Item = Row>) -> PyResult<Self> {
        let rows: Vec<Row> = rows.collect();
        let touchable = robot.0.touchable_links();
        let number = |link: usize| touchable.iter().position(|l| l.get() == link).map_or(-1, |k| k as i64);
        let column = |f: fn(&Row) -> f64| numbers(py, &rows.iter().map(f).collect::<Vec<_>>()).unbind();
        let contact = PyArray1::from_iter(py, rows.iter().map(|row| row.contact as i64));
        Ok(Particles {
            contact: read_only(contact).unbind(),
            link: read_only(PyArray1::from_iter(py, rows.iter().map(|row| number(row.link)))).unbind(),
            point: read_only(from_rows::<3>(py, rows.iter().map(|row| row.point))?).unbind(),
            normal: read_only(from_rows::<3>(py, rows.iter().map(|row| row.normal))?).unbind(),
            force: column(|row| row.force),
            stiffness: column(|row| row.stiffness),
            weight: column(|row| row.weight),
        })
    }
}

arrays_alone!(Particles, "Particles", contact, link, point, normal, force, stiffness, weight);
