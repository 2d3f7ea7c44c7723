//! `Robot`.

use std::sync::Arc;

use contactsense::robot::{LinkIndex, Robot};
use nalgebra::Vector3;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arguments::{number, text, whole};
use crate::arrays::Vector;
use crate::by_name::{base_pose, by_name, pairs};
use crate::description::{description as read_description, square};
use crate::errors::{detached, input, to_python};
use crate::returned::{matrix, pose, read_only};
use crate::surface::PySurface;

/// A robot: immutable, shareable between threads.
#[pyclass(frozen, subclass, name = "Robot", module = "contactsense")]
pub struct PyRobot(pub Arc<Robot>);

impl PyRobot {
    /// Index of a link by its name.
    fn link(&self, link: &Bound<'_, PyAny>) -> PyResult<LinkIndex> {
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

    /// A configuration from joint positions by name, in any order; joints that are not named are neutral.
    ///
    /// Args:
    ///     positions: `{joint: position}` [rad; m for sliding joints]; continuous joints take their angle.
    ///     base: pose of a floating base in the world: position [m] and quaternion xyzw, `(7,)`, or a matrix, `(4, 4)`.
    ///
    /// Returns:
    ///     `(nq,)`, writable.
    ///
    /// Raises:
    ///     InputError: a name is no joint's (the message lists those that are), a value is not finite, or the base of this
    ///         robot is fixed.
    #[pyo3(signature = (positions, *, base=None))]
    fn configuration<'py>(
        &self,
        positions: &Bound<'py, PyAny>,
        base: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let py = positions.py();
        let values = by_name("positions", positions)?;
        let base = base.map(base_pose).transpose()?;
        let q = self.0.configuration(&pairs(&values), base.as_ref());
        Ok(PyArray1::from_vec(py, q.map_err(|error| to_python(py, error))?))
    }

    /// A velocity from joint velocities by name, in any order; joints that are not named stand still.
    ///
    /// Args:
    ///     velocities: `{joint: velocity}` [rad/s; m/s for sliding joints].
    ///     base: linear [m/s] and angular [rad/s] velocity of a floating base in its own frame, `(6,)`.
    ///
    /// Returns:
    ///     `(nv,)`, writable.
    ///
    /// Raises:
    ///     InputError: as for `configuration`.
    #[pyo3(signature = (velocities, *, base=None))]
    fn velocity<'py>(
        &self,
        velocities: &Bound<'py, PyAny>,
        base: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let py = velocities.py();
        let values = by_name("velocities", velocities)?;
        let base = Vector::optional("base", base)?.map(|base| base.fixed::<6>(py, "base")).transpose()?;
        let v = self.0.velocity(&pairs(&values), base.as_ref());
        Ok(PyArray1::from_vec(py, v.map_err(|error| to_python(py, error))?))
    }

    /// Torques from joint torques by name, in any order; the others, and a floating base's, are zero.
    ///
    /// Args:
    ///     torques: `{joint: torque}` [Nm; N for sliding joints].
    ///
    /// Returns:
    ///     `(nv,)`, writable.
    ///
    /// Raises:
    ///     InputError: as for `configuration`.
    fn torque<'py>(&self, torques: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let py = torques.py();
        let values = by_name("torques", torques)?;
        let tau = self.0.torque(&pairs(&values)).map_err(|error| to_python(py, error))?;
        Ok(PyArray1::from_vec(py, tau))
    }

    /// The configuration that a second of motion at constant velocity leads to, as `pinocchio.integrate`.
    ///
    /// A floating base moves along its twist, which is given in its own frame; (cos, sin) pairs turn. For a step of `dt` pass
    /// `dt * v`.
    ///
    /// Args:
    ///     q: configuration, `(nq,)`.
    ///     v: velocity, `(nv,)` [rad/s, m/s].
    ///
    /// Returns:
    ///     `(nq,)`, writable.
    ///
    /// Raises:
    ///     InputError: an argument cannot be used; names it.
    fn integrate<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let py = q.py();
        let (q, v) = (Vector::new("q", q)?, Vector::new("v", v)?);
        let next = self.0.integrate(q.slice(), v.slice()).map_err(|error| to_python(py, error))?;
        Ok(PyArray1::from_vec(py, next))
    }

    /// A random configuration; the same for the same seed.
    ///
    /// Joints are uniform within their limits, within half a turn either way where they have none (sliding joints within 1 m).
    /// A floating base is within 1 m of the origin along each axis, and its orientation is uniform.
    ///
    /// Args:
    ///     seed: a whole number, not negative.
    ///
    /// Returns:
    ///     `(nq,)`, writable.
    ///
    /// Raises:
    ///     InputError: the seed is no such number.
    fn random_configuration<'py>(
        &self,
        py: Python<'py>,
        seed: &Bound<'_, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(PyArray1::from_vec(py, self.0.random_configuration(whole("seed", seed, u64::MAX)?)))
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

    /// The neutral configuration, `(nq,)`.
    fn neutral<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.0.neutral())
    }

    /// The joint-space mass matrix `M(q)`.
    ///
    /// Args:
    ///     q: configuration, `(nq,)`.
    ///
    /// Returns:
    ///     `(nv, nv)` [kg m^2; kg for sliding joints and a base's linear part].
    ///
    /// Raises:
    ///     InputError: `q` is not finite, or without unit quaternions and (cos, sin) pairs.
    fn mass_matrix<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let py = q.py();
        let q = Vector::new("q", q)?;
        matrix(py, &self.0.mass_matrix(q.slice()).map_err(|error| to_python(py, error))?)
    }

    /// The torque of a motion, `M(q) a + C(q, v) v + g(q)`.
    ///
    /// Args:
    ///     q: configuration, `(nq,)`.
    ///     v: velocity, `(nv,)` [rad/s, m/s].
    ///     a: acceleration, `(nv,)` [rad/s^2, m/s^2].
    ///
    /// Returns:
    ///     `(nv,)` [Nm; N for sliding joints and a base's linear part].
    ///
    /// Raises:
    ///     InputError: an argument cannot be used; names it.
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

    /// The acceleration of torques, `M(q)^-1 (tau + tau_ext - C(q, v) v - g(q))`.
    ///
    /// A joint that moves no inertia gets acceleration 0.
    ///
    /// Args:
    ///     q: configuration, `(nq,)`.
    ///     v: velocity, `(nv,)` [rad/s, m/s].
    ///     tau: motor torque, `(nv,)`, or `(nv - 6,)` for a floating base [Nm, N].
    ///     tau_ext: external torque, `(nv,)` [Nm, N]; none by default.
    ///
    /// Returns:
    ///     `(nv,)` [rad/s^2, m/s^2].
    ///
    /// Raises:
    ///     InputError: an argument cannot be used; names it.
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

    /// Pose of a link in the world.
    ///
    /// Args:
    ///     q: configuration, `(nq,)`.
    ///     link: name of any link, also one without surface.
    ///
    /// Returns:
    ///     `(4, 4)`, homogeneous [m].
    ///
    /// Raises:
    ///     InputError: an argument cannot be used; an unknown link's message lists the links.
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

    /// Geometric Jacobian of a link, linear rows first, world axes.
    ///
    /// Args:
    ///     q: configuration, `(nq,)`.
    ///     link: name of any link.
    ///     point: a point fixed to the link, `(3,)`, world frame [m]; the link's origin by default.
    ///
    /// Returns:
    ///     `(6, nv)`.
    ///
    /// Raises:
    ///     InputError: an argument cannot be used; names it.
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
    /// Args:
    ///     link: name of a link that has a surface.
    ///
    /// Returns:
    ///     A `Surface`.
    ///
    /// Raises:
    ///     InputError: the link is unknown or has no surface; the message lists those that have one.
    fn surface(slf: &Bound<'_, Self>, link: &Bound<'_, PyAny>) -> PyResult<PySurface> {
        let (py, this) = (slf.py(), slf.get());
        let index = this.link(link)?;
        if this.0[index].surface.is_none() {
            let names: Vec<&str> =
                this.0.touchable_links().iter().map(|i| this.0[*i].name.as_str()).collect();
            return Err(input(
                py,
                format!(
                    "link: '{}' has no surface; links that have one: {}",
                    text("link", link)?,
                    names.join(", ")
                ),
            ));
        }
        Ok(PySurface::new(slf.clone().unbind(), index))
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
