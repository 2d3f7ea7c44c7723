//! `ContactMonitor`.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use contactsense::monitor::{ContactMonitor, MonitorOptions};
use contactsense::Sample;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arguments::{number, pushing, sole, whole, Number};
use crate::arrays::{scalar_or_vector, Readings, Vector};
use crate::calibration::calibration_of;
use crate::errors::to_python;
use crate::isolator::contact_count;
use crate::names::Names;
use crate::report::PyContactReport;
use crate::returned::{numbers, read_only, wrench_rows};
use crate::robot::PyRobot;
use crate::robot_argument::robot;
use crate::sensor::{sensor_tuple, sensors, wanted_places, wrench_thresholds};

/// The sense of touch of one robot, called once a control tick: observer, compensation, bias, detection, isolation.
///
/// The pipeline of Vorndamme 2017 on one pass over the robot's kinematics. One thread at a time may use it.
///
/// Args:
///     robot: The robot.
///     dt: Time between two calls [s].
///     sensors: Of `ForceTorqueSensor`, in the order of the readings.
///     wanted_contacts: Names of the sensors whose contacts are meant (feet, hands): what touches behind them is no
///         collision (eq. 20). Or pairs `(link, point_local)` without a sensor: any force at that point of the link
///         [m] is meant, and what it cannot explain of the torques is tested.
///     observer_gain: Of the momentum observer, scalar or `(nv,)` [1/s].
///     torque_threshold: Scalar or `(nv,)` [Nm; N for sliding joints]. With a calibration and without a threshold, all
///         joints are tested at once, at three gains, against a level for the calibration's rate of false alarms.
///     wrench_threshold: On external wrenches: scalar, `(6,)` or `(n_sensors, 6)` [N, Nm].
///     wrench_gain: Of the low-pass on external wrenches, whose readings and velocities are noisy [1/s]; infinite for
///         none. None: the smallest of `observer_gain`, and no low-pass where that is at least `0.5 / dt`.
///     bias_time_constant: Tracks the torque that errors of the model cause while nothing touches [s]; None for no
///         tracking, or 3 s where all joints are tested at once. With thresholds, nothing is detected in the first time
///         constant, and what touches in less than half of it is not learnt.
///     bias_limit: Greatest bias of each joint, in thresholds.
///     bias_settle_time: A torque that stands still for so long becomes the bias [s]; None: a contact may last for ever.
///     hysteresis: Share of its greatest torque in a contact that a joint's gear or sensor may keep after it, scalar or
///         `(nv,)`; such a remainder becomes the bias up to two thresholds.
///     hold_time: A signal stays on so long after it was last over its threshold [s].
///     max_contacts: Contacts reported at most.
///     pushing: Whether forces push on the surface. If False the point of a contact cannot be determined.
///     calibration: A `Calibration` of this robot: velocities and torques are corrected, inertias are those that its motion
///         showed, and the noise left over sets thresholds and says how well a contact is located.
///     locate_within: A contact is located if 90 % of the places that explain the torques are within this distance of
///         its point [m].
///     samples: Samples of the surface from which the posterior of a single contact is worked out, as `ContactMap` does,
///         spread over ticks; 0 for closed forms only. Wrenches of sensors count as the torques do. Not with wanted points.
///
/// Raises:
///     InputError: Names the argument.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> q, v = np.full(7, 0.4), np.zeros(7)
///     >>> tau = robot.inverse_dynamics(q, v, v)
///     >>> monitor = cs.ContactMonitor(robot, dt=1e-3)
///     >>> monitor.update(q, v, tau).collision
///     False
///     >>> for _ in range(100):
///     ...     report = monitor.update(q, v, tau - 3.0)
///     >>> report.collision
///     True
///     >>> monitor.torque_threshold = 5.0
#[pyclass(frozen, name = "ContactMonitor", module = "contactsense")]
pub struct PyContactMonitor {
    pub(crate) unloaded: Py<PyRobot>,
    /// The same with its payload.
    robot: Mutex<Py<PyRobot>>,
    monitor: Mutex<ContactMonitor>,
    pub(crate) names: Arc<Names>,
}

impl PyContactMonitor {
    pub(crate) fn sole(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, ContactMonitor>> {
        sole(py, "ContactMonitor", &self.monitor)
    }

    /// What `robot` returns from now on.
    pub(crate) fn set_robot(&self, robot: Py<PyRobot>) {
        *self.robot.lock().unwrap_or_else(PoisonError::into_inner) = robot;
    }
}

#[pymethods]
impl PyContactMonitor {
    #[new]
    #[pyo3(signature = (robot, *, dt, sensors=None, wanted_contacts=None, observer_gain=None, torque_threshold=None,
                        wrench_threshold=None, wrench_gain=None, bias_time_constant=None, bias_limit=None, bias_settle_time=None, hysteresis=None, hold_time=None,
                        max_contacts=None, pushing=true, calibration=None, locate_within=None, samples=None),
           text_signature = "(robot, *, dt, sensors=(), wanted_contacts=(), observer_gain=50.0, torque_threshold=0.5, \
                             wrench_threshold=2.0, wrench_gain=None, bias_time_constant=None, bias_limit=30.0, \
                             bias_settle_time=None, hysteresis=0.2, hold_time=0.02, max_contacts=5, pushing=True, \
                             calibration=None, locate_within=0.05, samples=1000)")]
    #[allow(clippy::too_many_arguments)] // the keywords of the Python class
    fn new(
        #[pyo3(from_py_with = robot)] robot: Bound<'_, PyRobot>,
        dt: Number<'_, '_>,
        sensors: Option<&Bound<'_, PyAny>>,
        wanted_contacts: Option<&Bound<'_, PyAny>>,
        observer_gain: Option<&Bound<'_, PyAny>>,
        torque_threshold: Option<&Bound<'_, PyAny>>,
        wrench_threshold: Option<&Bound<'_, PyAny>>,
        wrench_gain: Option<Number<'_, '_>>,
        bias_time_constant: Option<Number<'_, '_>>,
        bias_limit: Option<Number<'_, '_>>,
        bias_settle_time: Option<Number<'_, '_>>,
        hysteresis: Option<&Bound<'_, PyAny>>,
        hold_time: Option<Number<'_, '_>>,
        max_contacts: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = pushing)] pushing: bool,
        calibration: Option<&Bound<'_, PyAny>>,
        locate_within: Option<Number<'_, '_>>,
        samples: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let mut options = MonitorOptions::new(dt.named("dt")?);
        if let Some(gain) = observer_gain {
            options.observer_gain = scalar_or_vector("observer_gain", gain)?;
        }
        options.calibration = calibration.map(calibration_of).transpose()?;
        if options.calibration.is_some() {
            options.isolation.torque_threshold = None;
        }
        if let Some(threshold) = torque_threshold {
            options.isolation.torque_threshold = Some(scalar_or_vector("torque_threshold", threshold)?);
        }
        if let Some(threshold) = wrench_threshold {
            options.isolation.wrench_threshold = wrench_thresholds(threshold)?;
        }
        options.isolation.max_contacts = contact_count(max_contacts)?;
        options.isolation.pushing = pushing;
        if let Some(distance) = locate_within {
            options.isolation.locate_within = distance.named("locate_within")?;
        }
        if let Some(samples) = samples {
            options.samples = whole("samples", samples, 1_000_000)? as usize;
        }
        if let Some(hold_time) = hold_time {
            options.hold_time = hold_time.named("hold_time")?;
        }
        options.bias_time_constant =
            bias_time_constant.map(|number| number.named("bias_time_constant")).transpose()?;
        options.wrench_gain = wrench_gain.map(|number| number.named("wrench_gain")).transpose()?;
        options.bias_settle_time =
            bias_settle_time.map(|number| number.named("bias_settle_time")).transpose()?;
        if let Some(limit) = bias_limit {
            options.bias_limit = limit.named("bias_limit")?;
        }
        if let Some(hysteresis) = hysteresis {
            options.hysteresis = scalar_or_vector("hysteresis", hysteresis)?;
        }
        if let Some(sensors) = sensors {
            options.isolation.sensors = self::sensors(sensors)?;
        }
        if let Some(wanted) = wanted_contacts {
            (options.isolation.wanted_contacts, options.wanted_points) = wanted_places(wanted)?;
        }
        let monitor = ContactMonitor::new(robot.get().0.clone(), &options);
        let monitor = monitor.map_err(|error| to_python(robot.py(), error))?;
        let names = Names::new(&robot.get().0, monitor.sensor_names());
        let loaded = Mutex::new(robot.clone().unbind());
        Ok(Self { unloaded: robot.unbind(), robot: loaded, names, monitor: Mutex::new(monitor) })
    }

    /// Takes in one tick.
    ///
    /// Args:
    ///     q: Configuration, `(nq,)`.
    ///     v: Velocity, `(nv,)` [rad/s; m/s for sliding joints], measured when `q` was.
    ///     tau: Motor torque, `(nv,)`, or `(nv - 6,)` for a floating base [Nm; N for sliding joints]: at that instant, or
    ///         better the mean of the torques held before and after it.
    ///     wrenches: The sensors' readings, `(n_sensors, 6)` [N, Nm], sensor axes. A NaN in a row leaves its sensor out
    ///         for this tick. Needed where there are sensors.
    ///     dt: Time since the last accepted sample [s], for clocks that jitter and samples that were lost. None: the
    ///         constructor's, and as much again for every sample refused in between. Over a longer step than 50 ms (or
    ///         five times the constructor's) the external torque is kept as it was.
    ///     friction: Torque of friction, shaped as `tau` [Nm, N], which is subtracted from it; None for no friction.
    ///
    /// Returns:
    ///     What the monitor says of this tick.
    ///
    /// Raises:
    ///     InputError: Names the argument; the state is then unchanged but for the time that passed.
    #[pyo3(signature = (q, v, tau, wrenches=None, *, dt=None, friction=None))]
    #[allow(clippy::too_many_arguments)] // the arguments of the Python method
    fn update(
        &self,
        py: Python<'_>,
        q: &Bound<'_, PyAny>,
        v: &Bound<'_, PyAny>,
        tau: &Bound<'_, PyAny>,
        wrenches: Option<&Bound<'_, PyAny>>,
        dt: Option<Number<'_, '_>>,
        friction: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PyContactReport> {
        let step = dt.and_then(|dt| (!dt.0.is_nan()).then_some(dt.0));
        let converted = (|| {
            let dt = dt.map(|dt| dt.named("dt")).transpose()?;
            let (q, v, tau) = (Vector::new("q", q)?, Vector::new("v", v)?, Vector::new("tau", tau)?);
            let friction = Vector::optional("friction", friction)?;
            Ok((q, v, tau, friction, wrenches.map(Readings::new).transpose()?, dt))
        })();
        // An array that cannot be read is a sample refused, too.
        let (q, v, tau, friction, wrenches, dt) = match converted {
            Ok(converted) => converted,
            Err(error) => {
                let error: PyErr = error;
                self.sole(py)?.miss(step);
                return Err(error);
            }
        };
        let mut sample = Sample::new(q.slice(), v.slice(), tau.slice());
        if let Some(friction) = &friction {
            sample = sample.friction(friction.slice());
        }
        if let Some(wrenches) = &wrenches {
            sample = sample.wrenches(wrenches.rows());
        }
        if let Some(dt) = dt {
            sample = sample.dt(dt);
        }
        let mut monitor = self.sole(py)?;
        let report = monitor.update(&sample).map_err(|error| to_python(py, error))?.clone();
        let acceleration = monitor.acceleration().to_vec();
        Ok(PyContactReport::new(self.names.clone(), report, acceleration))
    }

    /// The robot that is monitored, with the payload that was set.
    #[getter]
    fn robot(&self, py: Python<'_>) -> Py<PyRobot> {
        self.robot.lock().unwrap_or_else(PoisonError::into_inner).clone_ref(py)
    }

    /// Time between two calls that is assumed where `update` is given none [s].
    #[getter]
    fn dt(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.sole(py)?.dt())
    }

    /// The sensors, of `ForceTorqueSensor`, in the order of the readings, with the offsets that are subtracted now.
    #[getter]
    fn sensors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        sensor_tuple(py, self.sole(py)?.sensors())
    }

    /// The bias that is subtracted, `(nv,)` [Nm; N for sliding joints]; zeros without `bias_time_constant` and `tare()`; read-only.
    #[getter]
    fn bias<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let monitor = self.sole(py)?;
        Ok(match monitor.bias() {
            Some(bias) => numbers(py, bias),
            None => read_only(PyArray1::zeros(py, monitor.robot().nv(), false)),
        })
    }

    /// Thresholds on the torques, `(nv,)` [Nm; N for sliding joints]; a read-only copy.
    ///
    /// A scalar or `(nv,)` may be set; bias, observer and signals stay as they are.
    #[getter]
    fn torque_threshold<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(numbers(py, self.sole(py)?.torque_threshold()))
    }

    #[setter]
    fn set_torque_threshold(&self, threshold: &Bound<'_, PyAny>) -> PyResult<()> {
        let (py, threshold) = (threshold.py(), scalar_or_vector("torque_threshold", threshold)?);
        self.sole(py)?.set_torque_threshold(&threshold).map_err(|error| to_python(py, error))
    }

    /// Thresholds on the external wrenches, `(n_sensors, 6)` [N, Nm]; a read-only copy.
    ///
    /// A scalar, `(6,)` or `(n_sensors, 6)` may be set; bias, observers and signals stay as they are.
    #[getter]
    fn wrench_threshold<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows: Vec<_> = self.sole(py)?.wrench_threshold().iter().copied().map(Some).collect();
        wrench_rows(py, &rows)
    }

    #[setter]
    fn set_wrench_threshold(&self, threshold: &Bound<'_, PyAny>) -> PyResult<()> {
        let (py, threshold) = (threshold.py(), wrench_thresholds(threshold)?);
        self.sole(py)?.set_wrench_threshold(&threshold).map_err(|error| to_python(py, error))
    }

    /// Gain of the momentum observer, `(nv,)` [1/s]; a read-only copy.
    ///
    /// A scalar or `(nv,)` may be set; the external torque goes on from where it is, and `wrench_gain` follows where the
    /// constructor was not given one.
    #[getter]
    fn observer_gain<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(numbers(py, self.sole(py)?.observer_gain()))
    }

    #[setter]
    fn set_observer_gain(&self, gain: &Bound<'_, PyAny>) -> PyResult<()> {
        let (py, gain) = (gain.py(), scalar_or_vector("observer_gain", gain)?);
        self.sole(py)?.set_observer_gain(&gain).map_err(|error| to_python(py, error))
    }

    /// Gain of the low-pass on the external wrenches [1/s]; infinite for no low-pass, None without sensors.
    ///
    /// A number may be set, or None for what follows from `observer_gain`; the wrenches go on from where they are.
    #[getter]
    fn wrench_gain(&self, py: Python<'_>) -> PyResult<Option<f64>> {
        Ok(self.sole(py)?.wrench_gain())
    }

    #[setter]
    fn set_wrench_gain(&self, gain: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = gain.py();
        let gain = (!gain.is_none()).then(|| number("wrench_gain", gain)).transpose()?;
        self.sole(py)?.set_wrench_gain(gain).map_err(|error| to_python(py, error))
    }

    /// Forgets all ticks, the bias too; torques may then come from another source. A payload and offsets of sensors stay.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        self.sole(py)?.reset();
        Ok(())
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let monitor = self.sole(py)?;
        let (name, dt, sensors) = (monitor.robot().name(), monitor.dt(), monitor.sensors().len());
        Ok(format!("ContactMonitor('{name}', dt={dt:?}, {sensors} sensors)"))
    }
}
