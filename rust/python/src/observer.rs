//! `MomentumObserver`.

use std::sync::{Mutex, MutexGuard};

use contactsense::observer::MomentumObserver;
use contactsense::Sample;
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arguments::{number_if_any, robot, sole, Number};
use crate::arrays::Vector;
use crate::errors::to_python;
use crate::returned::result;
use crate::robot::PyRobot;

/// A scalar, or one number per velocity variable.
pub fn scalar_or_vector(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    match number_if_any(object)? {
        Some(number) => Ok(vec![number]),
        None => Ok(Vector::new(name, object)?.into_vec()),
    }
}

/// The generalised momentum observer (Vorndamme 2017, eqs. 4-6) with its acceleration (eq. 9).
///
/// It estimates the external torque from positions, velocities and motor torques. Each component is the true one behind
/// a first-order low-pass with time constant `1 / gain`, for any `gain * dt`.
///
/// Args:
///     robot: the robot that is observed.
///     dt: time between two calls [s].
///     gain: scalar or `(nv,)` [1/s].
///
/// Raises:
///     InputError: an argument cannot be used; names it.
///
/// Example:
///     >>> import contactsense as cs
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> observer = cs.MomentumObserver(robot, dt=1e-3)
///     >>> q, v = robot.neutral(), robot.velocity({})
///     >>> observer.update(q, v, robot.inverse_dynamics(q, v, v)).shape
///     (7,)
#[pyclass(frozen, name = "MomentumObserver", module = "contactsense")]
pub struct PyMomentumObserver {
    robot: Py<PyRobot>,
    observer: Mutex<MomentumObserver>,
}

impl PyMomentumObserver {
    fn sole(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, MomentumObserver>> {
        sole(py, "MomentumObserver", &self.observer)
    }
}

#[pymethods]
impl PyMomentumObserver {
    #[new]
    #[pyo3(signature = (robot, *, dt, gain=None), text_signature = "(robot, *, dt, gain=50.0)")]
    fn new(
        #[pyo3(from_py_with = robot)] robot: Bound<'_, PyRobot>,
        dt: Number<'_, '_>,
        gain: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let py = robot.py();
        let gain = gain.map_or(Ok(vec![50.0]), |gain| scalar_or_vector("gain", gain))?;
        let observer = MomentumObserver::new(robot.get().0.clone(), dt.named("dt")?, &gain);
        let observer = Mutex::new(observer.map_err(|error| to_python(py, error))?);
        Ok(Self { robot: robot.unbind(), observer })
    }

    /// One tick. The first call sets the initial momentum and returns zeros.
    ///
    /// Args:
    ///     q: configuration, `(nq,)`.
    ///     v: velocity, `(nv,)` [rad/s, m/s], measured at the same instant.
    ///     tau: motor torque, `(nv,)`, or `(nv - 6,)` for a floating base [Nm, N]; of a torque that is held over the steps
    ///         before and after, their mean.
    ///     dt: length of this step [s], where it differs from the constructor's.
    ///     friction: torque of friction, shaped as `tau`, which is subtracted from it [Nm, N].
    ///
    /// Returns:
    ///     The external torque, `(nv,)` [Nm, N].
    ///
    /// Raises:
    ///     InputError: an argument cannot be used; names it. The state is then unchanged.
    #[pyo3(signature = (q, v, tau, *, dt=None, friction=None))]
    fn update<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        tau: &Bound<'py, PyAny>,
        dt: Option<Number<'_, '_>>,
        friction: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let py = q.py();
        let (q, v, tau) = (Vector::new("q", q)?, Vector::new("v", v)?, Vector::new("tau", tau)?);
        let friction = Vector::optional("friction", friction)?;
        let dt = dt.map(|dt| dt.named("dt")).transpose()?;
        let mut observer = self.sole(py)?;
        let mut sample = Sample::new(q.slice(), v.slice(), tau.slice());
        if let Some(friction) = &friction {
            sample = sample.friction(friction.slice());
        }
        if let Some(dt) = dt {
            sample = sample.dt(dt);
        }
        match observer.update(&sample) {
            Ok(torque) => Ok(result(py, torque)),
            Err(error) => Err(to_python(py, error)),
        }
    }

    /// The robot observed.
    #[getter]
    fn robot(&self, py: Python<'_>) -> Py<PyRobot> {
        self.robot.clone_ref(py)
    }

    /// Time between two calls that is assumed where `update` is given none [s].
    #[getter]
    fn dt(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.sole(py)?.dt())
    }

    /// The gain, `(nv,)` [1/s].
    #[getter]
    fn gain<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(result(py, self.sole(py)?.gain()))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let observer = self.sole(py)?;
        Ok(format!("MomentumObserver('{}', dt={})", observer.robot().name(), observer.dt()))
    }

    /// Forgets all ticks; the next call is a first call.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        self.sole(py)?.reset();
        Ok(())
    }

    /// The external torque of the last tick, `(nv,)` [Nm, N].
    #[getter]
    fn external_torque<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(result(py, self.sole(py)?.external_torque()))
    }

    /// The acceleration estimated at the last tick, `(nv,)` [rad/s^2, m/s^2]: forward dynamics with the external torque.
    #[getter]
    fn acceleration<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(result(py, self.sole(py)?.acceleration()))
    }
}
