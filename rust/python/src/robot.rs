//! `Robot`.

use std::sync::Arc;

use contactsense::robot::{LinkIndex, Robot};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arguments::text;
use crate::arrays::Vector;
use crate::description::description;
use crate::errors::{detached, input, to_python};
use crate::returned::{matrix, pose};
use crate::surface::PySurface;

/// A robot: immutable, shareable between threads.
#[pyclass(frozen, subclass, name = "Robot", module = "contactsense._core")]
pub struct PyRobot(pub Arc<Robot>);

impl PyRobot {
    /// Index of a link by its name.
    fn link(&self, link: &Bound<'_, PyAny>) -> PyResult<LinkIndex> {
        self.0.link(text("link", link)?).map_err(|error| to_python(link.py(), error))
    }
}

#[pymethods]
impl PyRobot {
    #[new]
    fn new(
        py: Python<'_>,
        name: String,
        joints: &Bound<'_, PyAny>,
        links: &Bound<'_, PyAny>,
        gravity: &Bound<'_, PyAny>,
        warnings: Vec<String>,
    ) -> PyResult<Self> {
        let description = description(name, joints, links, gravity, warnings)?;
        let robot = detached(py, || description.load().and_then(Robot::new))?;
        Ok(Self(Arc::new(robot.map_err(|error| to_python(py, error))?)))
    }

    /// The robot's name.
    #[getter]
    fn name(&self) -> &str {
        self.0.name()
    }

    /// Number of configuration variables.
    #[getter]
    fn nq(&self) -> usize {
        self.0.nq()
    }

    /// Number of velocity variables.
    #[getter]
    fn nv(&self) -> usize {
        self.0.nv()
    }

    /// Whether the base moves freely.
    #[getter]
    fn floating_base(&self) -> bool {
        self.0.floating_base()
    }

    /// Names of the moving joints, in the order of `v`.
    #[getter]
    fn joint_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.0.joint_names())
    }

    /// One of "free_flyer", "revolute", "continuous", "prismatic" a joint.
    #[getter]
    fn joint_kinds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.0.joint_kinds().map(|kind| kind.name()))
    }

    /// Names of the links that have a surface.
    #[getter]
    fn link_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.0.touchable_links().iter().map(|link| &self.0[*link].name))
    }

    /// What was odd in the description, and what was done about it.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.0.warnings())
    }

    /// The neutral configuration, `(nq,)`.
    fn neutral<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.0.neutral())
    }

    /// The joint-space mass matrix `M(q)`, `(nv, nv)`.
    ///
    /// Raises `InputError` where `q` is not `(nq,)`, finite, with unit quaternions and (cos, sin) pairs.
    fn mass_matrix<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let py = q.py();
        let q = Vector::new("q", q)?;
        matrix(py, &self.0.mass_matrix(q.slice()).map_err(|error| to_python(py, error))?)
    }

    /// `M(q) a + C(q, v) v + g(q)`, `(nv,)` [Nm; N for sliding joints and a base's linear part].
    ///
    /// Raises `InputError` that names the argument.
    fn inverse_dynamics<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        a: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let py = q.py();
        let (q, v, a) = (Vector::new("q", q)?, Vector::new("v", v)?, Vector::new("a", a)?);
        let tau = self.0.inverse_dynamics(q.slice(), v.slice(), a.slice());
        Ok(PyArray1::from_vec(py, tau.map_err(|error| to_python(py, error))?))
    }

    /// `M(q)^-1 (tau + tau_ext - C(q, v) v - g(q))`, `(nv,)`.
    ///
    /// `tau` is `(nv,)`, or `(nv - 6,)` for a floating base; `tau_ext` is `(nv,)`. A joint that moves no inertia gets
    /// acceleration 0. Raises `InputError` that names the argument.
    #[pyo3(signature = (q, v, tau, tau_ext=None))]
    fn forward_dynamics<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        tau: &Bound<'py, PyAny>,
        tau_ext: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let py = q.py();
        let (q, v, tau) = (Vector::new("q", q)?, Vector::new("v", v)?, Vector::new("tau", tau)?);
        let tau_ext = Vector::optional("tau_ext", tau_ext)?;
        let tau_ext = tau_ext.as_ref().map(|tau_ext| tau_ext.slice());
        let a = self.0.forward_dynamics(q.slice(), v.slice(), tau.slice(), tau_ext);
        Ok(PyArray1::from_vec(py, a.map_err(|error| to_python(py, error))?))
    }

    /// Pose of a link in the world, `(4, 4)`; any URDF link, also one without surface.
    ///
    /// Raises `InputError` that names the argument; an unknown link's message lists the links.
    fn link_pose<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        link: &Bound<'_, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let py = q.py();
        let q = Vector::new("q", q)?;
        let link = self.link(link)?;
        pose(py, &self.0.link_pose(q.slice(), link).map_err(|error| to_python(py, error))?)
    }

    /// Geometric Jacobian of a link, `(6, nv)`, linear rows first, world axes, at a world `point` fixed to the link
    /// (default: the link's origin).
    ///
    /// Raises `InputError` that names the argument.
    #[pyo3(signature = (q, link, point=None))]
    fn jacobian<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        link: &Bound<'_, PyAny>,
        point: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let py = q.py();
        let q = Vector::new("q", q)?;
        let link = self.link(link)?;
        let point = Vector::optional("point", point)?;
        let point = point.map(|point| point.fixed::<3>(py, "point")).transpose()?;
        matrix(py, &self.0.jacobian(q.slice(), link, point).map_err(|error| to_python(py, error))?)
    }

    /// The surface of a link, in the link frame.
    ///
    /// Raises `InputError` where the link is unknown or has no surface.
    fn surface(&self, py: Python<'_>, link: &Bound<'_, PyAny>) -> PyResult<PySurface> {
        let index = self.link(link)?;
        if self.0[index].surface.is_none() {
            let names: Vec<&str> =
                self.0.touchable_links().iter().map(|i| self.0[*i].name.as_str()).collect();
            return Err(input(
                py,
                format!(
                    "link: '{}' has no surface; links that have one: {}",
                    text("link", link)?,
                    names.join(", ")
                ),
            ));
        }
        Ok(PySurface { robot: self.0.clone(), link: index })
    }

    fn __repr__(&self) -> String {
        format!(
            "Robot('{}', {} joints, {} links with surface, nq={}, nv={})",
            self.0.name(),
            self.0.joint_names().len(),
            self.0.touchable_links().len(),
            self.0.nq(),
            self.0.nv()
        )
    }
}
