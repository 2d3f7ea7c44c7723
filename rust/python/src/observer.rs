//! `MomentumObserver`.

use std::sync::{Mutex, MutexGuard};

use contactsense::observer::MomentumObserver;
use contactsense::Sample;
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arguments::{sole, Number};
use crate::arrays::{scalar_or_vector, Vector};
use crate::calibration::calibration_of;
use crate::errors::to_python;
use crate::returned::numbers;
use crate::robot::PyRobot;
use crate::robot_argument::robot;

/// The generalised momentum observer (Vorndamme 2017, eqs. 4-6) with its acceleration (eq. 9).
///
/// Estimates the external torque from positions, velocities and motor torques; each component is the true one behind a
/// first-order low-pass with time constant `1 / gain`. Stable for any `gain * dt`. One thread at a time may use it.
///
/// Args:
///     robot: The robot.
///     dt: Time between two calls [s].
///     gain: Scalar or `(nv,)` [1/s].
///     calibration: A `Calibration` of this robot: velocities and torques are corrected, and inertias are those that its
///         motion showed. Torques, velocities and the pose are those of one time, when the latest of the measured signals
///         was what it is (`velocity_delay`, `torque_delay`).
///
/// Raises:
///     InputError: Names the argument.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> q, v = np.full(7, 0.4), np.zeros(7)
///     >>> tau = robot.inverse_dynamics(q, v, v)
///     >>> tau[1] -= 2.0
///     >>> observer = cs.MomentumObserver(robot, dt=1e-3)
///     >>> for _ in range(500):
///     ...     external_torque = observer.update(q, v, tau)
///     >>> round(float(external_torque[1]), 6)
///     2.0
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
    #[pyo3(signature = (robot, *, dt, gain=None, calibration=None),
           text_signature = "(robot, *, dt, gain=50.0, calibration=None)")]
    fn new(
        #[pyo3(from_py_with = robot)] robot: Bound<'_, PyRobot>,
        dt: Number<'_, '_>,
        gain: Option<&Bound<'_, PyAny>>,
        calibration: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let py = robot.py();
        let gain = gain.map_or(Ok(vec![50.0]), |gain| scalar_or_vector("gain", gain))?;
        let (dt, model) = (dt.named("dt")?, &robot.get().0);
        let observer = match calibration.map(calibration_of).transpose()? {
            Some(calibration) => MomentumObserver::calibrated(model, dt, &gain, &calibration),
            None => MomentumObserver::new(model.clone(), dt, &gain),
        };
        let observer = Mutex::new(observer.map_err(|error| to_python(py, error))?);
        Ok(Self { robot: robot.unbind(), observer })
    }

    /// Takes in one tick. The first call sets the initial momentum and returns zeros.
    ///
    /// Args:
    ///     q: Configuration, `(nq,)`.
    ///     v: Velocity, `(nv,)` [rad/s; m/s for sliding joints], measured when `q` was.
    ///     tau: Motor torque, `(nv,)`, or `(nv - 6,)` for a floating base [Nm; N for sliding joints]: at that instant, or
    ///         better the mean of the torques held before and after it.
    ///     dt: Time since the last call [s]; None for the constructor's.
    ///     friction: Torque of friction, shaped as `tau` [Nm, N], which is subtracted from it; None for no friction.
    ///
    /// Returns:
    ///     The external torque, `(nv,)` [Nm; N for sliding joints and a base's linear part]; read-only.
    ///
    /// Raises:
    ///     InputError: Names the argument; the state is then unchanged.
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
            Ok(torque) => Ok(numbers(py, torque)),
            Err(error) => Err(to_python(py, error)),
        }
    }

    /// Forgets all ticks; the next call is a first call.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        self.sole(py)?.reset();
        Ok(())
    }

    /// External torque of the last tick, `(nv,)` [Nm; N for sliding joints]; a read-only copy.
    #[getter]
    fn external_torque<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(numbers(py, self.sole(py)?.external_torque()))
    }

    /// Acceleration estimated at the last tick, `(nv,)` [rad/s^2; m/s^2 for sliding joints]; a read-only copy.
    ///
    /// Forward dynamics with the external torque (Vorndamme 2017, eq. 9).
    #[getter]
    fn acceleration<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(numbers(py, self.sole(py)?.acceleration()))
    }

    /// The robot.
    #[getter]
    fn robot(&self, py: Python<'_>) -> Py<PyRobot> {
        self.robot.clone_ref(py)
    }

    /// Time between two calls that is assumed where `update` is given none [s].
    #[getter]
    fn dt(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.sole(py)?.dt())
    }

    /// The gain, `(nv,)` [1/s]; a read-only copy.
    ///
    /// A scalar or `(nv,)` may be set; the external torque goes on from where it is.
    #[getter]
    fn gain<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(numbers(py, self.sole(py)?.gain()))
    }

    #[setter]
    fn set_gain(&self, gain: &Bound<'_, PyAny>) -> PyResult<()> {
        let (py, gain) = (gain.py(), scalar_or_vector("gain", gain)?);
        self.sole(py)?.set_gain(&gain).map_err(|error| to_python(py, error))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let observer = self.sole(py)?;
        Ok(format!("MomentumObserver('{}', dt={:?})", observer.robot().name(), observer.dt()))
    }
}
