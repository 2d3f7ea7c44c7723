//! `ContactClassifier` and its `ContactClass`.

use std::sync::{Mutex, MutexGuard};

use contactsense::classification::{ClassifierOptions, ContactClass, ContactClassifier, FEATURE_NAMES};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arguments::{sole, Number};
use crate::arrays::Vector;
use crate::errors::{input, to_python};
use crate::pickle::{plain_dict, reduced, Reduced};
use crate::report::PyContactReport;
use crate::robot::PyRobot;
use crate::robot_argument::robot;

const ATTRIBUTES: [&str; 11] = [
    "id",
    "running",
    "since",
    "duration",
    "kind",
    "clamped",
    "transient",
    "sustained",
    "intended",
    "features",
    "contributions",
];
const LOGITS: [&str; 4] = ["clamped", "transient", "sustained", "intended"];

/// Says of each contact that a monitor reports whether it is clamped, transient or sustained, and whether it is intended.
///
/// The probabilities follow from a few features of force and motion by logistic regression, whose weights were found on
/// simulated scenes. It is not a safety function. One thread at a time may use it.
///
/// Args:
///     robot: The robot.
///     dt: Time between two calls [s]: from how long before a contact velocities are kept. Times are those of the reports.
///     prior: Shares of contacts that are clamped, transient and sustained, `(3,)`; None for those of the simulated scenes.
///     intended_prior: Share of contacts that are intended.
///
/// Raises:
///     InputError: Names the argument.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> monitor, classifier = cs.ContactMonitor(robot, dt=1e-3), cs.ContactClassifier(robot, dt=1e-3)
///     >>> q, still = np.full(7, 0.4), np.zeros(7)
///     >>> weight = robot.inverse_dynamics(q, still, still)
///     >>> for push in np.minimum(np.arange(600) / 300, 1.0) * 5.0:
///     ...     contacts = classifier.update(q, still, monitor.update(q, still, weight - push))
///     >>> contacts[0].running, contacts[0].intended > 0.5
///     (True, True)
#[pyclass(frozen, name = "ContactClassifier", module = "contactsense")]
pub struct PyContactClassifier {
    classifier: Mutex<ContactClassifier>,
    robot: Py<PyRobot>,
}

impl PyContactClassifier {
    pub(crate) fn sole(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, ContactClassifier>> {
        sole(py, "ContactClassifier", &self.classifier)
    }
}

#[pymethods]
impl PyContactClassifier {
    #[new]
    #[pyo3(signature = (robot, *, dt, prior=None, intended_prior=None),
        text_signature = "(robot, *, dt, prior=None, intended_prior=0.26)")]
    fn new(
        #[pyo3(from_py_with = robot)] robot: Bound<'_, PyRobot>,
        dt: Number<'_, '_>,
        prior: Option<&Bound<'_, PyAny>>,
        intended_prior: Option<Number<'_, '_>>,
    ) -> PyResult<Self> {
        let py = robot.py();
        let mut options = ClassifierOptions { dt: dt.named("dt")?, ..ClassifierOptions::default() };
        if let Some(prior) = Vector::optional("prior", prior)? {
            let [clamped, transient, sustained] = prior.slice() else {
                return Err(input(py, format!("prior: expected 3 numbers, got {}", prior.slice().len())));
            };
            options = ClassifierOptions {
                clamped: *clamped,
                transient: *transient,
                sustained: *sustained,
                ..options
            };
        }
        if let Some(intended) = intended_prior {
            options.intended = intended.named("intended_prior")?;
        }
        let classifier = ContactClassifier::new(robot.get().0.clone(), &options);
        let classifier = Mutex::new(classifier.map_err(|error| to_python(py, error))?);
        Ok(Self { classifier, robot: robot.unbind() })
    }

    /// The robot.
    #[getter]
    fn robot(&self, py: Python<'_>) -> Py<PyRobot> {
        self.robot.clone_ref(py)
    }

    /// Takes in one tick.
    ///
    /// Args:
    ///     q: Configuration, `(nq,)`, as the monitor got it.
    ///     v: Velocity, `(nv,)` [rad/s; m/s for sliding joints], as the monitor got it.
    ///     report: What the monitor said of this tick.
    ///
    /// Returns:
    ///     The contacts that run, and those that have ended: once each, 0.1 s after their last tick.
    ///
    /// Raises:
    ///     InputError: Names the argument; the state is then unchanged.
    fn update<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        report: &Bound<'py, PyContactReport>,
    ) -> PyResult<Bound<'py, PyTuple>> {
        let py = q.py();
        let (q, v) = (Vector::new("q", q)?, Vector::new("v", v)?);
        let mut classifier = self.sole(py)?;
        let report = report.get().report();
        let classes =
            classifier.update(q.slice(), v.slice(), report).map_err(|error| to_python(py, error))?;
        let classes: Vec<_> =
            classes.iter().map(|class| Bound::new(py, PyContactClass(*class))).collect::<PyResult<_>>()?;
        PyTuple::new(py, classes)
    }

    /// Forgets all contacts.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        self.sole(py)?.reset();
        Ok(())
    }

    fn __repr__(&self) -> String {
        format!("ContactClassifier('{}')", self.robot.get().0.name())
    }
}

/// What one contact is.
///
/// Frozen; can be pickled and copied. `clamped`, `transient` and `sustained` sum to one.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> monitor, classifier = cs.ContactMonitor(robot, dt=1e-3), cs.ContactClassifier(robot, dt=1e-3)
///     >>> q, still = np.full(7, 0.4), np.zeros(7)
///     >>> tau = robot.inverse_dynamics(q, still, still)
///     >>> for _ in range(50):
///     ...     contacts = classifier.update(q, still, monitor.update(q, still, tau))
///     ...     tau = tau - 0.1
///     >>> contacts[0].running, sorted(contacts[0].features)[:2]
///     (True, ['advance', 'approach_speed'])
#[pyclass(frozen, name = "ContactClass", module = "contactsense")]
pub struct PyContactClass(pub ContactClass);

#[pymethods]
impl PyContactClass {
    /// Number of the contact, as `Contact.id`; None where contacts are not followed.
    #[getter]
    fn id(&self) -> Option<u64> {
        self.0.id
    }

    /// Whether the contact goes on; False once, when it has ended.
    #[getter]
    fn running(&self) -> bool {
        self.0.running
    }

    /// Time of its first tick, as `ContactReport.time` [s].
    #[getter]
    fn since(&self) -> f64 {
        self.0.since
    }

    /// From its first tick to its last so far [s].
    #[getter]
    fn duration(&self) -> f64 {
        self.0.duration
    }

    /// The likeliest of "clamped", "transient" and "sustained".
    #[getter]
    fn kind(&self) -> &'static str {
        self.0.kind().name()
    }

    /// Probability that it is held between the robot and something fixed.
    #[getter]
    fn clamped(&self) -> f64 {
        self.0.clamped
    }

    /// Probability that it ends by itself shortly.
    #[getter]
    fn transient(&self) -> f64 {
        self.0.transient
    }

    /// Probability that it lasts with something that follows or yields.
    #[getter]
    fn sustained(&self) -> f64 {
        self.0.sustained
    }

    /// Probability that it is intended.
    #[getter]
    fn intended(&self) -> f64 {
        self.0.intended
    }

    /// What was measured of it, by name; a new dict at every access.
    ///
    /// `rise_time` [s], `width` [s], `remaining`, `approach_speed` [m/s], `onset_work`, `advance` [m], `retreat` [m],
    /// `net_work` [m] and `peak` [N]; forces and ways are equivalents of torques and their power.
    #[getter]
    fn features<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (dict, features) = (PyDict::new(py), &self.0.features);
        for (name, value) in [
            ("rise_time", features.rise_time),
            ("width", features.width),
            ("remaining", features.remaining),
            ("approach_speed", features.approach_speed),
            ("onset_work", features.onset_work),
            ("advance", features.advance),
            ("retreat", features.retreat),
            ("net_work", features.net_work),
            ("peak", features.peak),
        ] {
            dict.set_item(name, value)?;
        }
        Ok(dict)
    }

    /// What each feature adds to each logit: a dict by "clamped", "transient", "sustained" and "intended" of dicts by feature.
    #[getter]
    fn contributions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (logit, parts) in LOGITS.iter().zip(&self.0.contributions) {
            let by_feature = PyDict::new(py);
            for (name, part) in FEATURE_NAMES.iter().zip(parts) {
                by_feature.set_item(name, part)?;
            }
            dict.set_item(logit, by_feature)?;
        }
        Ok(dict)
    }

    /// The features as the weights take them, in the order of `contributions`.
    #[getter]
    fn _scaled(&self) -> Vec<f64> {
        self.0.features.scaled().to_vec()
    }

    /// All attributes by name.
    ///
    /// Returns:
    ///     Plain Python values: numbers and dicts.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        plain_dict(slf.as_any(), &ATTRIBUTES)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "ContactClass", &self.0)
    }

    fn __repr__(&self) -> String {
        let ContactClass { clamped, transient, sustained, intended, .. } = self.0;
        format!(
            "ContactClass(clamped={clamped:.2}, transient={transient:.2}, sustained={sustained:.2}, intended={intended:.2})"
        )
    }
}
