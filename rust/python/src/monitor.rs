//! `ContactMonitor` and `ContactReport`.

use std::sync::{Arc, Mutex, MutexGuard};

use contactsense::monitor::{ContactMonitor, ContactReport, MonitorOptions};
use contactsense::Sample;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple};

use crate::arguments::{pushing, robot, sole, Number};
use crate::arrays::{Readings, Vector};
use crate::errors::to_python;
use crate::isolator::{contact_count, contacts, link_names};
use crate::names::Names;
use crate::observer::scalar_or_vector;
use crate::plain::{reduced, restored, to_dict, Reduced};
use crate::returned::{from_rows, read_only, result, wrench_rows};
use crate::robot::PyRobot;
use crate::sensor::{sensor_names, sensors, wrench_thresholds};

/// What the monitor reports of one tick.
#[pyclass(frozen, name = "ContactReport", module = "contactsense")]
pub struct PyContactReport {
    names: Arc<Names>,
    report: ContactReport,
    acceleration: Vec<f64>,
    wrapped: PyOnceLock<Py<PyTuple>>,
}

/// What `to_dict` of a report holds.
const REPORT: [&str; 13] = [
    "time",
    "collision",
    "onset",
    "links",
    "external_torque",
    "collision_torque",
    "acceleration",
    "wrenches",
    "sensors_left_out",
    "joints_left_out",
    "contacts",
    "remainder_learned",
    "truncated",
];

/// A report that was pickled.
pub fn restore<'py>(py: Python<'py>, state: &[u8]) -> PyResult<Bound<'py, PyAny>> {
    let (names, report, acceleration): (Names, _, _) = restored(state)?;
    let (names, wrapped) = (Arc::new(names), PyOnceLock::new());
    Ok(Bound::new(py, PyContactReport { names, report, acceleration, wrapped })?.into_any())
}

#[pymethods]
impl PyContactReport {
    /// Time since the first accepted call [s].
    #[getter]
    fn time(&self) -> f64 {
        self.report.time
    }

    /// Whether there is a contact.
    #[getter]
    fn collision(&self) -> bool {
        self.report.collision
    }

    /// Whether the contact began with this tick.
    #[getter]
    fn onset(&self) -> bool {
        self.report.onset
    }

    /// Whether a torque that stood still became the bias in this tick, which ended the contact.
    ///
    /// It is what `hysteresis` may have left, what outlasted `bias_settle_time`, or no torque at all where the bias before
    /// was wrong.
    #[getter]
    fn remainder_learned(&self) -> bool {
        self.report.remainder_learned
    }

    /// Names of the links that detection alone leaves for a contact (Vorndamme 2017, eq. 21).
    ///
    /// On every branch they are those between the last joint or sensor over its threshold and the next.
    #[getter]
    fn links<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        link_names(py, &self.names, &self.report.links)
    }

    /// The external torque of all contacts, `(nv,)` [Nm, N], free of the tracked bias.
    #[getter]
    fn external_torque<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        result(py, &self.report.external_torque)
    }

    /// `external_torque` without wanted contacts, `(nv,)` [Nm, N]; zero at joints that are left out.
    #[getter]
    fn collision_torque<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        result(py, &self.report.collision_torque)
    }

    /// The external wrench that each sensor measures, `(n_sensors, 6)` [N, Nm].
    ///
    /// Force and moment on the robot at the sensor's origin, world axes; NaN where a sensor is left out.
    #[getter]
    fn wrenches<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        wrench_rows(py, &self.report.wrenches)
    }

    /// Names of the sensors without a reading in this tick.
    #[getter]
    fn sensors_left_out<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.report.sensors_left_out.iter().map(|sensor| &self.names.sensors[sensor.get()]))
    }

    /// Names of the joints whose torques are not used to detect a collision, since a wanted contact loads them unmeasured.
    ///
    /// They are those behind its sensor, and while that gives no reading (and a little after) those between it and the
    /// base.
    #[getter]
    fn joints_left_out<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.report.joints_left_out.iter().map(|joint| &self.names.joints[*joint]))
    }

    /// Estimated acceleration, `(nv,)` [rad/s^2, m/s^2].
    #[getter]
    fn acceleration<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        result(py, &self.acceleration)
    }

    /// The contacts; empty while there is no collision.
    #[getter]
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        contacts(py, &self.names, &self.report.isolation, &self.wrapped)
    }

    /// Whether the answer is cut short.
    ///
    /// There were more contacts than `max_contacts`, more hits of a line than are kept (the nearest are), or more
    /// explanations to try than the bounded work of a call allows.
    #[getter]
    fn truncated(&self) -> bool {
        self.report.isolation.truncated
    }

    /// As plain Python data: numbers, strings, lists and dicts, `None` for what is undetermined.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        to_dict(slf, &REPORT)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "ContactReport", &(&*self.names, &self.report, &self.acceleration))
    }

    fn __repr__(&self) -> String {
        format!(
            "ContactReport(time={:.4}, collision={}, {} contacts)",
            self.report.time,
            if self.report.collision { "True" } else { "False" },
            self.report.isolation.contacts.len()
        )
    }
}

/// Detects, locates and measures the contacts of one robot, called once a control tick.
///
/// It joins the momentum observer, the compensation of sensors, the tracking of the bias, detection and isolation.
///
/// Args:
///     robot: the robot.
///     dt: time between two calls [s].
///     sensors: `ForceTorqueSensor`s, in the order of the readings.
///     wanted_contacts: names of sensors whose contacts are meant (feet, hands): a contact behind them is no collision.
///     observer_gain: gain of the momentum observer, scalar or `(nv,)` [1/s].
///     torque_threshold: threshold on the external torque, scalar or `(nv,)` [Nm, N].
///     wrench_threshold: threshold on the sensors' external wrenches: scalar, `(6,)` or `(n_sensors, 6)` [N, Nm].
///     wrench_gain: gain of the low-pass on external wrenches [1/s], infinite for none. By default the smallest of
///         `observer_gain`, and none where that is at least `0.5 / dt`.
///     bias_time_constant: time constant of the tracking of the external torque that model errors cause without contact
///         [s]; no tracking by default. Nothing is detected in the first time constant, and a contact that lasts less than
///         half of it is not learnt.
///     bias_limit: greatest bias of each joint, in thresholds.
///     bias_settle_time: an external torque that stands still for so long becomes the bias [s]; never by default.
///     hysteresis: share of its greatest torque in a contact that a joint's gear or sensor may keep after it, scalar or
///         `(nv,)`. Such a remainder becomes the bias, up to two thresholds.
///     hold_time: a signal stays on for so long after it was last over its threshold [s].
///     max_contacts: number of contacts that are reported at most.
///     pushing: whether forces push on the surface, as in `ContactIsolator`.
///     locate_within: distance within which a contact counts as located [m], as in `ContactIsolator`.
///
/// Raises:
///     InputError: an argument cannot be used; names it.
///
/// Example:
///     >>> import contactsense as cs
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> monitor = cs.ContactMonitor(robot, dt=1e-3, torque_threshold=1.0)
///     >>> q, v = robot.neutral(), robot.velocity({})
///     >>> monitor.update(q, v, robot.inverse_dynamics(q, v, v)).collision
///     False
#[pyclass(frozen, name = "ContactMonitor", module = "contactsense")]
pub struct PyContactMonitor {
    robot: Py<PyRobot>,
    monitor: Mutex<ContactMonitor>,
    names: Arc<Names>,
}

impl PyContactMonitor {
    fn sole(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, ContactMonitor>> {
        sole(py, "ContactMonitor", &self.monitor)
    }
}

#[pymethods]
impl PyContactMonitor {
    #[new]
    #[pyo3(signature = (robot, *, dt, sensors=None, wanted_contacts=None, observer_gain=None, torque_threshold=None,
                        wrench_threshold=None, wrench_gain=None, bias_time_constant=None, bias_limit=None, bias_settle_time=None, hysteresis=None, hold_time=None,
                        max_contacts=None, pushing=true, locate_within=None),
           text_signature = "(robot, *, dt, sensors=(), wanted_contacts=(), observer_gain=50.0, torque_threshold=0.5, \
            wrench_threshold=2.0, wrench_gain=None, bias_time_constant=None, bias_limit=30.0, bias_settle_time=None, \
            hysteresis=0.2, hold_time=0.02, max_contacts=5, pushing=True, locate_within=0.05)")]
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
        locate_within: Option<Number<'_, '_>>,
    ) -> PyResult<Self> {
        let mut options = MonitorOptions::new(dt.named("dt")?);
        if let Some(gain) = observer_gain {
            options.observer_gain = scalar_or_vector("observer_gain", gain)?;
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
            options.isolation.wanted_contacts = sensor_names(wanted)?;
        }
        let monitor = ContactMonitor::new(robot.get().0.clone(), &options);
        let monitor = monitor.map_err(|error| to_python(robot.py(), error))?;
        let names = Names::new(monitor.robot(), monitor.sensor_names());
        Ok(Self { robot: robot.unbind(), names, monitor: Mutex::new(monitor) })
    }

    /// One tick.
    ///
    /// Over a step longer than 50 ms (or five times the constructor's `dt`) the external torque is kept as it was.
    ///
    /// Args:
    ///     q: configuration, `(nq,)`.
    ///     v: velocity, `(nv,)` [rad/s, m/s].
    ///     tau: motor torque, `(nv,)`, or `(nv - 6,)` for a floating base [Nm, N].
    ///     wrenches: readings of the sensors, `(n_sensors, 6)`, sensor axes [N, Nm]. A NaN in a reading leaves its sensor out
    ///         for this tick.
    ///     dt: time since the last accepted sample [s], for clocks that jitter and samples that were lost. By default the
    ///         constructor's, and as much again for every sample refused in between.
    ///     friction: torque of friction, shaped as `tau`, which is subtracted from it [Nm, N].
    ///
    /// Returns:
    ///     A `ContactReport`.
    ///
    /// Raises:
    ///     InputError: an argument cannot be used; names it. The state is then unchanged but for the time that passed.
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
        let (names, wrapped) = (self.names.clone(), PyOnceLock::new());
        Ok(PyContactReport { names, report, acceleration, wrapped })
    }

    /// The robot that is monitored.
    #[getter]
    fn robot(&self, py: Python<'_>) -> Py<PyRobot> {
        self.robot.clone_ref(py)
    }

    /// Time between two calls that is assumed where `update` is given none [s].
    #[getter]
    fn dt(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.sole(py)?.dt())
    }

    /// The bias that is subtracted, `(nv,)` [Nm, N]; zeros without `bias_time_constant`.
    #[getter]
    fn bias<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let monitor = self.sole(py)?;
        Ok(match monitor.bias() {
            Some(bias) => result(py, bias),
            None => read_only(PyArray1::zeros(py, monitor.robot().nv(), false)),
        })
    }

    /// Thresholds on the external torque, `(nv,)` [Nm, N]; settable between two ticks, to a scalar or `(nv,)`.
    ///
    /// Bias and external torque stay as they are; a contact stays on for the hold time. The greatest bias follows, as it
    /// is counted in thresholds.
    #[getter]
    fn torque_threshold<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(result(py, self.sole(py)?.torque_threshold()))
    }

    #[setter]
    fn set_torque_threshold(&self, threshold: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = threshold.py();
        let threshold = scalar_or_vector("torque_threshold", threshold)?;
        self.sole(py)?.set_torque_threshold(&threshold).map_err(|error| to_python(py, error))
    }

    /// Thresholds on the sensors' external wrenches, `(n_sensors, 6)` [N, Nm]; settable to a scalar, `(6,)` or
    /// `(n_sensors, 6)`.
    #[getter]
    fn wrench_threshold<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let monitor = self.sole(py)?;
        let given = &monitor.options().isolation.wrench_threshold;
        let row = |sensor: usize| match given.as_slice() {
            [one] => [*one; 6],
            [a, b, c, d, e, f] => [*a, *b, *c, *d, *e, *f],
            all => std::array::from_fn(|k| all[6 * sensor + k]),
        };
        from_rows(py, (0..self.names.sensors.len()).map(row)).map(read_only)
    }

    #[setter]
    fn set_wrench_threshold(&self, threshold: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = threshold.py();
        let threshold = wrench_thresholds(threshold)?;
        self.sole(py)?.set_wrench_threshold(&threshold).map_err(|error| to_python(py, error))
    }

    /// The observer's gain, `(nv,)` [1/s]; settable to a scalar or `(nv,)`: the external torque goes on from where it is.
    #[getter]
    fn observer_gain<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(result(py, self.sole(py)?.observer_gain()))
    }

    #[setter]
    fn set_observer_gain(&self, gain: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = gain.py();
        let gain = scalar_or_vector("observer_gain", gain)?;
        self.sole(py)?.set_observer_gain(&gain).map_err(|error| to_python(py, error))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let monitor = self.sole(py)?;
        let (name, dt, sensors) = (monitor.robot().name(), monitor.dt(), self.names.sensors.len());
        Ok(format!("ContactMonitor('{name}', dt={dt}, {sensors} sensors, time={:.4})", monitor.time()))
    }

    /// Forgets all ticks, the bias too.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        self.sole(py)?.reset();
        Ok(())
    }
}
