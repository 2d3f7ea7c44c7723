//! `Reaction`.

use std::sync::{Mutex, MutexGuard};

use contactsense::reaction::{Reaction, ReactionLimits};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arguments::{sole, Number};
use crate::arrays::{scalar_or_vector, Vector};
use crate::errors::to_python;
use crate::returned::numbers;
use crate::robot::PyRobot;
use crate::robot_argument::robot;

/// Reactions to a contact: stop, retreat and gravity compensation, within limits.
///
/// Each call is one control tick and returns the next command. Whatever the finite arguments, velocities, accelerations and
/// torques of the commands stay within the limits. It is not a safety function. One thread at a time may use it.
///
/// Args:
///     robot: The robot.
///     dt: Time between two calls [s].
///     velocity_limit: Scalar or `(nv,)` [rad/s; m/s for sliding joints]; None for a quarter of the robot's limits.
///     acceleration_limit: Scalar or `(nv,)` [rad/s^2; m/s^2]; None for what reaches the velocity limit in 0.25 s.
///     torque_limit: Scalar or `(nv,)` [Nm; N]; None for the efforts of the robot's description.
///     distance: Of a retreat: the most that a joint moves after it has come to rest [rad; m].
///     duration: Of a retreat: when the robot comes to rest [s].
///
/// Raises:
///     InputError: Names the argument.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> reaction = cs.Reaction(cs.Robot.named("iiwa14"), dt=1e-3, acceleration_limit=2.0)
///     >>> for _ in range(100):
///     ...     command = reaction.stop(np.full(7, 0.2))
///     >>> bool(abs(command).max() < 1e-9)
///     True
#[pyclass(frozen, name = "Reaction", module = "contactsense")]
pub struct PyReaction {
    reaction: Mutex<Reaction>,
    robot: Py<PyRobot>,
}

impl PyReaction {
    fn sole(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, Reaction>> {
        sole(py, "Reaction", &self.reaction)
    }
}

#[pymethods]
impl PyReaction {
    #[new]
    #[pyo3(signature = (robot, *, dt, velocity_limit=None, acceleration_limit=None, torque_limit=None, distance=None, duration=None),
        text_signature = "(robot, *, dt, velocity_limit=None, acceleration_limit=None, torque_limit=None, distance=0.1, duration=1.0)")]
    fn new(
        #[pyo3(from_py_with = robot)] robot: Bound<'_, PyRobot>,
        dt: Number<'_, '_>,
        velocity_limit: Option<&Bound<'_, PyAny>>,
        acceleration_limit: Option<&Bound<'_, PyAny>>,
        torque_limit: Option<&Bound<'_, PyAny>>,
        distance: Option<Number<'_, '_>>,
        duration: Option<Number<'_, '_>>,
    ) -> PyResult<Self> {
        let py = robot.py();
        let model = &robot.get().0;
        let mut limits = ReactionLimits::of(model);
        for (name, given, limit) in [
            ("velocity_limit", velocity_limit, &mut limits.velocity),
            ("acceleration_limit", acceleration_limit, &mut limits.acceleration),
            ("torque_limit", torque_limit, &mut limits.torque),
        ] {
            if let Some(given) = given {
                let values = scalar_or_vector(name, given)?;
                *limit = if values.len() == 1 { vec![values[0]; model.nv()] } else { values };
            }
        }
        if let Some(distance) = distance {
            limits.distance = distance.named("distance")?;
        }
        if let Some(duration) = duration {
            limits.duration = duration.named("duration")?;
        }
        let reaction = Reaction::new(model.clone(), dt.named("dt")?, limits);
        let reaction = Mutex::new(reaction.map_err(|error| to_python(py, error))?);
        Ok(Self { reaction, robot: robot.unbind() })
    }

    /// The robot.
    #[getter]
    fn robot(&self, py: Python<'_>) -> Py<PyRobot> {
        self.robot.clone_ref(py)
    }

    /// The next velocity of a stop in the direction of the motion.
    ///
    /// Args:
    ///     v: Velocity, `(nv,)` [rad/s; m/s for sliding joints]; of the first call, what is braked from.
    ///
    /// Returns:
    ///     Commanded velocity, `(nv,)` [rad/s; m/s]; read-only.
    ///
    /// Raises:
    ///     InputError: Names the argument; the state is then unchanged.
    fn stop<'py>(&self, v: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let py = v.py();
        let v = Vector::new("v", v)?;
        let mut reaction = self.sole(py)?;
        reaction.stop(v.slice()).map(|command| numbers(py, command)).map_err(|error| to_python(py, error))
    }

    /// The next velocity of a retreat along which the torque of the collision falls.
    ///
    /// Each joint comes to rest and then moves by `admittance` times its torque, until `distance` or `duration` is used up.
    ///
    /// Args:
    ///     v: Velocity, `(nv,)` [rad/s; m/s for sliding joints]; of the first call, what is braked from.
    ///     collision_torque: `ContactReport.collision_torque`, `(nv,)` [Nm; N].
    ///     admittance: Velocity over torque [rad/s/Nm; m/s/N].
    ///
    /// Returns:
    ///     Commanded velocity, `(nv,)` [rad/s; m/s]; read-only.
    ///
    /// Raises:
    ///     InputError: Names the argument; the state is then unchanged.
    #[pyo3(signature = (v, collision_torque, *, admittance=None), text_signature = "(self, v, collision_torque, *, admittance=0.02)")]
    fn retract<'py>(
        &self,
        v: &Bound<'py, PyAny>,
        collision_torque: &Bound<'py, PyAny>,
        admittance: Option<Number<'_, '_>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let py = v.py();
        let (v, torque) = (Vector::new("v", v)?, Vector::new("collision_torque", collision_torque)?);
        let admittance = admittance.map_or(Ok(0.02), |admittance| admittance.named("admittance"))?;
        let mut reaction = self.sole(py)?;
        let command = reaction.retract(v.slice(), torque.slice(), admittance);
        command.map(|command| numbers(py, command)).map_err(|error| to_python(py, error))
    }

    /// The torque that carries the robot's weight and damps its motion, clipped to the torque limits.
    ///
    /// Args:
    ///     q: Configuration, `(nq,)`.
    ///     v: Velocity, `(nv,)` [rad/s; m/s for sliding joints].
    ///     damping: [Nm s/rad; N s/m].
    ///
    /// Returns:
    ///     Motor torque, `(nv,)` [Nm; N]; read-only.
    ///
    /// Raises:
    ///     InputError: Names the argument.
    #[pyo3(signature = (q, v, *, damping=None), text_signature = "(self, q, v, *, damping=1.0)")]
    fn gravity_compensation<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        damping: Option<Number<'_, '_>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let py = q.py();
        let (q, v) = (Vector::new("q", q)?, Vector::new("v", v)?);
        let damping = damping.map_or(Ok(1.0), |damping| damping.named("damping"))?;
        let mut reaction = self.sole(py)?;
        let torque = reaction.gravity_compensation(q.slice(), v.slice(), damping);
        torque.map(|torque| numbers(py, torque)).map_err(|error| to_python(py, error))
    }

    /// The next call begins a new reaction.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        self.sole(py)?.reset();
        Ok(())
    }

    fn __repr__(&self) -> String {
        format!("Reaction('{}')", self.robot.get().0.name())
    }
}
