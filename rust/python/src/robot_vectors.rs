//! Vectors of a `Robot`: from names, at random, and after a motion.

use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arguments::whole;
use crate::arrays::Vector;
use crate::by_name::{base_pose, by_name, pairs};
use crate::errors::to_python;
use crate::robot::PyRobot;

#[pymethods]
impl PyRobot {
    /// The neutral configuration, `(nq,)`.
    fn neutral<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.0.neutral())
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
}
