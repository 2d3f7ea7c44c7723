//! `Robot`: how it is made and what it consists of. Its other methods are in `robot_vectors` and `robot_mechanics`.

use std::sync::Arc;

use contactsense::robot::{LinkIndex, Robot};
use nalgebra::Vector3;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arguments::{number, text};
use crate::arrays::Vector;
use crate::description::{description as read_description, square};
use crate::errors::{detached, input, to_python};
use crate::returned::read_only;

/// A robot: immutable, shareable between threads.
#[pyclass(frozen, subclass, name = "Robot", module = "contactsense")]
pub struct PyRobot(pub Arc<Robot>);

impl PyRobot {
    /// Index of a link by its name.
    pub fn link(&self, link: &Bound<'_, PyAny>) -> PyResult<LinkIndex> {
        self.0.link(text("link", link)?).map_err(|error| to_python(link.py(), error))
    }
}

#[pymethods]
impl PyRobot {
    /// From a loader's description, or the same robot once more.
    #[new]
    fn new(py: Python<'_>, description: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(robot) = description.cast::<PyRobot>() {
            return Ok(Self(robot.get().0.clone()));
        }
        let given = description.cast::<PyTuple>().map_err(|_| {
            input(py, "use Robot.from_urdf, Robot.from_pinocchio or Robot.named to make a robot".into())
        })?;
        let description = read_description(given)?;
        let robot = detached(py, || Robot::new(description))?;
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

    /// How each joint moves: "free_flyer", "revolute", "continuous" or "prismatic".
    #[getter]
    fn joint_kinds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.0.joint_kinds().map(|kind| kind.name()))
    }

    /// Names of the links that have a surface.
    #[getter]
    fn link_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.0.touchable_links().iter().map(|link| &self.0[*link].name))
    }

    /// Names of all links, also those without a surface.
    #[getter]
    fn all_link_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.0.links().iter().map(|link| &link.name))
    }

    /// Names of the joints that an actuator can move: all but a floating base's.
    #[getter]
    fn actuated_joint_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.0.actuated_joint_names())
    }

    /// Mass of all that moves [kg].
    #[getter]
    fn mass(&self) -> f64 {
        self.0.mass()
    }

    /// Gravity, `(3,)`, world frame [m/s^2].
    #[getter]
    fn gravity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        read_only(PyArray1::from_slice(py, self.0.gravity().as_slice()))
    }

    /// Smallest and largest value of each configuration variable, `(nq, 2)` [rad or m]; infinite where there is none.
    ///
    /// The (cos, sin) pairs of continuous joints and the pose of a floating base have none.
    #[getter]
    fn position_limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let limits = self.0.position_limits();
        Ok(read_only(PyArray1::from_slice(py, limits.as_flattened()).reshape([limits.len(), 2])?))
    }

    /// Largest effort of each velocity variable, `(nv,)` [Nm, N].
    ///
    /// It is infinite where there is no limit, and zero for a floating base, which no actuator moves.
    #[getter]
    fn effort_limits<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        read_only(PyArray1::from_vec(py, self.0.effort_limits()))
    }

    /// Largest velocity of each velocity variable, `(nv,)` [rad/s, m/s].
    ///
    /// It is infinite where there is no limit, and for a floating base.
    #[getter]
    fn velocity_limits<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        read_only(PyArray1::from_vec(py, self.0.velocity_limits()))
    }

    fn _with_payload(
        &self,
        link: &Bound<'_, PyAny>,
        mass: &Bound<'_, PyAny>,
        com: &Bound<'_, PyAny>,
        inertia: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let py = link.py();
        let com = Vector3::from(Vector::new("com", com)?.fixed::<3>(py, "com")?);
        let inertia = square("inertia", inertia)?;
        let loaded = self.0.with_payload(self.link(link)?, number("mass", mass)?, com, inertia);
        Ok(Self(Arc::new(loaded.map_err(|error| to_python(py, error))?)))
    }

    /// What was odd in the description, and what was done about it; also logged as warnings of "contactsense".
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.0.warnings())
    }

    fn __repr__(&self) -> String {
        format!(
            "Robot('{}', {} joints, {} links with surface, nq={}, nv={}{})",
            self.0.name(),
            self.0.joint_names().len(),
            self.0.touchable_links().len(),
            self.0.nq(),
            self.0.nv(),
            match self.0.warnings().len() {
                0 => String::new(),
                1 => ", 1 warning".to_owned(),
                count => format!(", {count} warnings"),
            }
        )
    }
}
