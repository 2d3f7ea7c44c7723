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
/// Estimates the external torque `(nv,)` from positions, velocities and motor torques; each component is the true
/// one behind a first-order low-pass with time constant `1 / gain`. Stable for any `gain * dt`.
///
/// `dt`: time between two calls [s]; `gain`: scalar or `(nv,)` [1/s], default 50. Raises `InputError` that names the
/// argument.
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
    #[pyo3(signature = (robot, *, dt, gain=None))]
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

    /// One tick; the external torque `(nv,)`, a fresh array. The first call sets the initial momentum, returns zeros.
    ///
    /// `q` `(nq,)`, `v` `(nv,)`, `tau` `(nv,)` or `(nv - 6,)` for a floating base: measured at one instant (a torque held
    /// over the steps before and after: its mean). `dt` replaces the constructor's for this step; `friction`, shaped as
    /// `tau`, is subtracted from it. Raises `InputError` that names the argument; the state is then unchanged.
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

    /// Of the last tick, `(nv,)`; a copy.
    #[getter]
    fn external_torque<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(result(py, self.sole(py)?.external_torque()))
    }

    /// Estimated acceleration at the last tick, `(nv,)`: forward dynamics with the external torque.
    #[getter]
    fn acceleration<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(result(py, self.sole(py)?.acceleration()))
    }
}
