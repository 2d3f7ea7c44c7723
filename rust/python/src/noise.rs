//! `NoiseModel`.

use contactsense::NoiseModel;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{gain, time_step};
use crate::arrays::{scalar_or_vector, Vector};
use crate::errors::{input, to_python};
use crate::pickle::{plain_dict, reduced, Reduced};
use crate::returned::numbers;
use crate::robot::PyRobot;
use crate::robot_argument::robot;

/// Errors of the external torque of the untouched robot, each as one standard deviation.
///
/// What says how large errors are takes it as `noise`. Frozen; equal where all numbers are; can be pickled and copied.
///
/// Args:
///     torque: White noise of the torque, per sample, scalar or `(nv,)` [Nm; N for sliding joints].
///     velocity: White noise of the velocity, scalar or `(nv,)` [rad/s; m/s for sliding joints]. It acts through the gain
///         of an observer and the mass matrix; what is given an external torque leaves it out.
///     relative: Share of the contact's own torque, scalar or `(nv,)`; a tenth of it also of the largest torque.
///     model: Slow errors left over (bias, friction, masses), scalar or `(nv,)` [Nm; N for sliding joints].
///     model_time: Time over which these change, scalar or `(nv,)` [s].
///     friction: Errors of friction while a joint starts, stops or turns round, scalar or `(nv,)` [Nm; N for sliding joints].
///     bias: What the bias differs by from one start to the next, scalar or `(nv,)` [Nm; N for sliding joints].
///     position_step: Step between two positions that an encoder counts, scalar or `(nv,)` [rad; m for sliding joints]; no
///         standard deviation. A joint that starts to move within it still seems to stand.
///
/// Raises:
///     InputError: Names the argument.
///
/// Example:
///     >>> import contactsense as cs
///     >>> noise = cs.NoiseModel(model=0.2)
///     >>> noise.torque, noise.model
///     (0.05, 0.2)
#[pyclass(frozen, eq, skip_from_py_object, name = "NoiseModel", module = "contactsense")]
#[derive(PartialEq, Clone)]
pub struct PyNoiseModel(pub NoiseModel);

/// A number where one holds for all.
pub fn values<'py>(py: Python<'py>, given: &[f64]) -> PyResult<Bound<'py, PyAny>> {
    match given {
        [value] => Ok(value.into_pyobject(py)?.into_any()),
        _ => Ok(numbers(py, given).into_any()),
    }
}

#[pymethods]
impl PyNoiseModel {
    #[new]
    #[pyo3(signature = (*, torque=None, velocity=None, relative=None, model=None, model_time=None,
                        friction=None, bias=None, position_step=None),
           text_signature = "(*, torque=0.05, velocity=0.0, relative=0.03, model=0.1, model_time=1.0, friction=0.0, bias=0.0, position_step=0.0)")]
    #[allow(clippy::too_many_arguments)] // the keywords of the Python class
    fn new(
        py: Python<'_>,
        torque: Option<&Bound<'_, PyAny>>,
        velocity: Option<&Bound<'_, PyAny>>,
        relative: Option<&Bound<'_, PyAny>>,
        model: Option<&Bound<'_, PyAny>>,
        model_time: Option<&Bound<'_, PyAny>>,
        friction: Option<&Bound<'_, PyAny>>,
        bias: Option<&Bound<'_, PyAny>>,
        position_step: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let mut noise = NoiseModel::default();
        for (name, object, values) in [
            ("torque", torque, &mut noise.torque),
            ("velocity", velocity, &mut noise.velocity),
            ("relative", relative, &mut noise.relative),
            ("model", model, &mut noise.model),
            ("model_time", model_time, &mut noise.model_time),
            ("friction", friction, &mut noise.friction),
            ("bias", bias, &mut noise.bias),
            ("position_step", position_step, &mut noise.position_step),
        ] {
            if let Some(object) = object {
                *values = scalar_or_vector(name, object)?;
            }
        }
        noise.check().map_err(|error| to_python(py, error))?;
        Ok(Self(noise))
    }

    /// White noise of the torque [Nm; N for sliding joints]: a number or `(nv,)`; a read-only copy.
    #[getter]
    fn torque<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        values(py, &self.0.torque)
    }

    /// White noise of the velocity [rad/s, m/s]: a number or `(nv,)`; a read-only copy.
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        values(py, &self.0.velocity)
    }

    /// Share of the contact's own torque: a number or `(nv,)`; a read-only copy.
    #[getter]
    fn relative<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        values(py, &self.0.relative)
    }

    /// Slow errors left over [Nm; N for sliding joints]: a number or `(nv,)`; a read-only copy.
    #[getter]
    fn model<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        values(py, &self.0.model)
    }

    /// Time over which slow errors change [s]: a number or `(nv,)`; a read-only copy.
    #[getter]
    fn model_time<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        values(py, &self.0.model_time)
    }

    /// Errors of friction at starts and stops [Nm; N for sliding joints]: a number or `(nv,)`; a read-only copy.
    #[getter]
    fn friction<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        values(py, &self.0.friction)
    }

    /// What the bias differs by from one start to the next [Nm; N for sliding joints]: a number or `(nv,)`; a read-only copy.
    #[getter]
    fn bias<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        values(py, &self.0.bias)
    }

    /// Step between two positions that an encoder counts [rad; m for sliding joints]: a number or `(nv,)`; a read-only copy.
    #[getter]
    fn position_step<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        values(py, &self.0.position_step)
    }

    /// All attributes by name.
    ///
    /// Returns:
    ///     Plain Python values: numbers, and lists in place of arrays.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let names =
            ["torque", "velocity", "relative", "model", "model_time", "friction", "bias", "position_step"];
        plain_dict(slf.as_any(), &names)
    }

    /// Covariance of the external torque of the untouched robot behind an observer.
    ///
    /// White noise of the torque is averaged, white noise of the velocity passes through gain and mass matrix, and slow errors
    /// pass as far as the observer follows them.
    ///
    /// Args:
    ///     robot: The robot.
    ///     q: Configuration, `(nq,)`.
    ///     gain: Of the observer [1/s].
    ///     dt: Time between two calls [s].
    ///
    /// Returns:
    ///     `(nv, nv)` [Nm^2].
    ///
    /// Raises:
    ///     InputError: Names the argument.
    #[pyo3(signature = (robot, q, *, gain=50.0, dt=0.001))]
    fn covariance<'py>(
        &self,
        #[pyo3(from_py_with = robot)] robot: Bound<'py, PyRobot>,
        q: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = gain)] gain: f64,
        #[pyo3(from_py_with = time_step)] dt: f64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let py = robot.py();
        let found = self.0.covariance(&robot.get().0, Vector::new("q", q)?.slice(), gain, dt);
        let found = found.map_err(|error| to_python(py, error))?;
        let rows: Vec<Vec<f64>> = found.row_iter().map(|row| row.iter().copied().collect()).collect();
        Ok(PyArray2::from_vec2(py, &rows)?)
    }

    /// Over which time errors of the external torque behind an observer stay alike: samples so far apart are independent.
    ///
    /// Args:
    ///     robot: The robot.
    ///     q: Configuration, `(nq,)`.
    ///     gain: Of the observer [1/s].
    ///     dt: Time between two calls [s].
    ///
    /// Returns:
    ///     `(nv,)` [s].
    ///
    /// Raises:
    ///     InputError: Names the argument.
    #[pyo3(signature = (robot, q, *, gain=50.0, dt=0.001))]
    fn correlation_time<'py>(
        &self,
        #[pyo3(from_py_with = robot)] robot: Bound<'py, PyRobot>,
        q: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = gain)] gain: f64,
        #[pyo3(from_py_with = time_step)] dt: f64,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let py = robot.py();
        let found = self.0.correlation_time(&robot.get().0, Vector::new("q", q)?.slice(), gain, dt);
        Ok(PyArray1::from_vec(py, found.map_err(|error| to_python(py, error))?))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "NoiseModel", &self.0)
    }

    fn __repr__(&self) -> String {
        let shown = |values: &[f64]| match values {
            [value] => format!("{value:?}"),
            _ => format!("{values:?}"),
        };
        let NoiseModel { torque, velocity, relative, model, model_time, friction, bias, position_step } =
            &self.0;
        let [torque, velocity, relative] = [torque, velocity, relative].map(|x| shown(x));
        let [model, model_time] = [model, model_time].map(|x| shown(x));
        let [friction, bias, position_step] = [friction, bias, position_step].map(|x| shown(x));
        format!(
            "NoiseModel(torque={torque}, velocity={velocity}, relative={relative}, model={model}, \
             model_time={model_time}, friction={friction}, bias={bias}, position_step={position_step})"
        )
    }
}

/// The argument `noise`.
pub fn noise_model(object: &Bound<'_, PyAny>) -> PyResult<NoiseModel> {
    match object.cast::<PyNoiseModel>() {
        Ok(noise) => Ok(noise.get().0.clone()),
        Err(_) => Err(input(
            object.py(),
            format!("noise: expected a NoiseModel, got {}", object.get_type().name()?),
        )),
    }
}
