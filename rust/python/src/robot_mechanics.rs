//! Kinematics and dynamics of a `Robot`.

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arrays::Vector;
use crate::errors::to_python;
use crate::returned::{matrix, pose};
use crate::robot::PyRobot;

#[pymethods]
impl PyRobot {
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
}
