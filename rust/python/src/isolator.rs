//! `ContactIsolator`, `Isolation`, `Contact` and `Candidate`.

use std::sync::{Arc, Mutex};

use contactsense::isolation::{Candidate, Contact, ContactIsolator, Isolation, IsolatorOptions};
use contactsense::robot::LinkIndex;
use contactsense::sensor::JOINT_TORQUES;
use nalgebra::Vector6;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple};
use pyo3::PyTypeInfo;

use crate::arguments::{pushing, robot, sole, whole, Number};
use crate::arrays::{Readings, Vector};
use crate::errors::to_python;
use crate::names::Names;
use crate::noise::noise_model;
use crate::observer::scalar_or_vector;
use crate::plain::{reduced, restored, to_dict, Reduced};
use crate::returned::{result, vector};
use crate::robot::PyRobot;
use crate::sensor::{sensor_names, sensors, wrench_thresholds};

/// A place where the line of action of a force meets a surface.
#[pyclass(frozen, name = "Candidate", module = "contactsense")]
pub struct PyCandidate {
    names: Arc<Names>,
    candidate: Candidate,
}

#[pymethods]
impl PyCandidate {
    /// The link's name.
    #[getter]
    fn link(&self) -> &str {
        self.names.link(self.candidate.link)
    }

    /// The place, `(3,)`, world frame [m].
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        result(py, self.candidate.point.as_slice())
    }

    /// Outward surface normal, `(3,)`, world frame.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        result(py, self.candidate.normal.as_slice())
    }

    /// Whether the force enters the surface here.
    #[getter]
    fn pushing(&self) -> bool {
        self.candidate.pushing
    }

    /// As plain Python data: numbers, strings and lists.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        to_dict(slf, &["link", "point", "normal", "pushing"])
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "Candidate", &(&*self.names, &self.candidate))
    }

    fn __repr__(&self) -> String {
        let (p, kind) = (&self.candidate.point, if self.candidate.pushing { "pushing" } else { "pulling" });
        format!("Candidate('{}', point=[{:.4}, {:.4}, {:.4}], {kind})", self.link(), p.x, p.y, p.z)
    }
}

/// One contact.
///
/// Vectors that the data do not determine are NaN.
#[pyclass(frozen, name = "Contact", module = "contactsense")]
pub struct PyContact {
    names: Arc<Names>,
    contact: Contact,
    candidates: Vec<Candidate>,
    wrapped: PyOnceLock<Py<PyTuple>>,
}

#[pymethods]
impl PyContact {
    /// The contact link's name.
    #[getter]
    fn link(&self) -> &str {
        self.names.link(self.contact.link)
    }

    /// The contact point, `(3,)`, world frame [m].
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.contact.place.map(|place| place.point))
    }

    /// The contact point, `(3,)`, link frame [m].
    #[getter]
    fn point_local<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.contact.place.map(|place| place.point_local))
    }

    /// Force on the robot, `(3,)`, world frame [N].
    #[getter]
    fn force<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.contact.force())
    }

    /// Outward surface normal at the point, `(3,)`, world frame.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.contact.place.map(|place| place.normal))
    }

    /// Force and moment on the robot at the link's origin, `(6,)`, world axes [N, Nm].
    #[getter]
    fn wrench<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.contact.wrench)
    }

    /// What detected it: "joint torques", or the sensor's name.
    #[getter]
    fn source(&self) -> &str {
        self.contact.source.map_or(JOINT_TORQUES, |sensor| &self.names.sensors[sensor.get()])
    }

    /// Whether 90 % of the places that explain the torques lie within `locate_within` of the point.
    ///
    /// If not, the link may be known, but the point is not.
    #[getter]
    fn located(&self) -> bool {
        self.contact.located
    }

    /// Standard deviation of the point [m]; NaN where there is no point.
    ///
    /// The standard deviation of a torque is taken as a third of its threshold, and as more where the torques contradict
    /// one force. Other places that explain the torques about as well are included. Errors common to all torques, such
    /// as those of a wrong payload, are not.
    #[getter]
    fn point_std(&self) -> f64 {
        self.contact.place.map_or(f64::NAN, |place| place.std)
    }

    /// Whether redundant torques agree with the contacts reported.
    ///
    /// False where they do not, and where there are as many unknowns as torques: nothing then checks the assumption that
    /// each contact is one force without moment.
    #[getter]
    fn verified(&self) -> bool {
        self.contact.verified
    }

    /// Places where the contact may be, best first.
    ///
    /// They are all places where the line of action meets a surface, points on other links that explain the torques about
    /// as well, or the points of several solutions.
    #[getter]
    fn candidates<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        once(py, &self.wrapped, || {
            self.candidates
                .iter()
                .map(|candidate| Bound::new(py, PyCandidate::new(&self.names, candidate)))
                .collect()
        })
    }

    /// As plain Python data: numbers, strings, lists and dicts, `None` for what is undetermined.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        to_dict(slf, &CONTACT)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "Contact", &(&*self.names, &self.contact, &self.candidates))
    }

    fn __repr__(&self) -> String {
        let link = self.link();
        match (self.contact.place, self.contact.force()) {
            (Some(place), Some(force)) if self.contact.located => {
                let (p, f) = (place.point, force.norm());
                format!("Contact('{link}', point=[{:.4}, {:.4}, {:.4}], |force|={f:.3} N)", p.x, p.y, p.z)
            }
            _ => format!("Contact('{link}', located=False)"),
        }
    }
}

/// All contacts of one instant.
#[pyclass(frozen, name = "Isolation", module = "contactsense")]
pub struct PyIsolation {
    names: Arc<Names>,
    isolation: Isolation,
    wrapped: PyOnceLock<Py<PyTuple>>,
}

/// The contacts that live on their own, made once.
pub fn contacts<'py>(
    py: Python<'py>,
    names: &Arc<Names>,
    isolation: &Isolation,
    wrapped: &PyOnceLock<Py<PyTuple>>,
) -> PyResult<Bound<'py, PyTuple>> {
    let wrap = |contact: &Contact| {
        let candidates = &isolation.candidates[contact.candidates.clone()];
        Bound::new(py, PyContact::new(names.clone(), contact.clone(), candidates.to_vec()))
    };
    once(py, wrapped, || isolation.contacts.iter().map(wrap).collect())
}

/// A tuple that is made at the first use.
pub fn once<'py, T: PyTypeInfo>(
    py: Python<'py>,
    wrapped: &PyOnceLock<Py<PyTuple>>,
    items: impl FnOnce() -> PyResult<Vec<Bound<'py, T>>>,
) -> PyResult<Bound<'py, PyTuple>> {
    let tuple = wrapped.get_or_try_init(py, || PyResult::Ok(PyTuple::new(py, items()?)?.unbind()))?;
    Ok(tuple.bind(py).clone())
}

/// What `to_dict` of a contact holds.
const CONTACT: [&str; 11] = [
    "link",
    "point",
    "point_local",
    "force",
    "normal",
    "wrench",
    "source",
    "located",
    "point_std",
    "verified",
    "candidates",
];

impl PyCandidate {
    fn new(names: &Arc<Names>, candidate: &Candidate) -> Self {
        PyCandidate { names: names.clone(), candidate: *candidate }
    }
}

impl PyContact {
    pub fn new(names: Arc<Names>, contact: Contact, candidates: Vec<Candidate>) -> Self {
        PyContact { names, contact, candidates, wrapped: PyOnceLock::new() }
    }
}

/// An object that was pickled.
pub fn restore<'py>(py: Python<'py>, class: &str, state: &[u8]) -> PyResult<Bound<'py, PyAny>> {
    match class {
        "Candidate" => {
            let (names, candidate) = restored(state)?;
            Ok(Bound::new(py, PyCandidate { names: Arc::new(names), candidate })?.into_any())
        }
        "Contact" => {
            let (names, contact, candidates): (Names, _, _) = restored(state)?;
            Ok(Bound::new(py, PyContact::new(Arc::new(names), contact, candidates))?.into_any())
        }
        _ => {
            let (names, isolation) = restored(state)?;
            let wrapped = PyOnceLock::new();
            Ok(Bound::new(py, PyIsolation { names: Arc::new(names), isolation, wrapped })?.into_any())
        }
    }
}

/// Names of links.
pub fn link_names<'py>(py: Python<'py>, names: &Names, links: &[LinkIndex]) -> PyResult<Bound<'py, PyTuple>> {
    PyTuple::new(py, links.iter().map(|link| names.link(*link)))
}

#[pymethods]
impl PyIsolation {
    /// The contacts, farthest from the base first.
    #[getter]
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        contacts(py, &self.names, &self.isolation, &self.wrapped)
    }

    /// Number of components of the contacts' wrenches that the torques do not determine (Vorndamme 2017, eq. 31).
    #[getter]
    fn rank_deficit(&self) -> usize {
        self.isolation.rank_deficit
    }

    /// Norm of the external torque that the contacts do not explain [Nm, N].
    #[getter]
    fn residual(&self) -> f64 {
        self.isolation.residual
    }

    /// Links that may carry a contact, likeliest first.
    #[getter]
    fn link_candidates<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        link_names(py, &self.names, &self.isolation.link_candidates)
    }

    /// Whether the answer is cut short.
    ///
    /// There were more contacts than `max_contacts`, more hits of a line than are kept (the nearest are), or more
    /// explanations to try than the bounded work of a call allows.
    #[getter]
    fn truncated(&self) -> bool {
        self.isolation.truncated
    }

    /// As plain Python data: numbers, strings, lists and dicts, `None` for what is undetermined.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        to_dict(slf, &["contacts", "rank_deficit", "residual", "link_candidates", "truncated"])
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "Isolation", &(&*self.names, &self.isolation))
    }

    fn __repr__(&self) -> String {
        format!(
            "Isolation({} contacts, rank_deficit={}, residual={:.3e})",
            self.isolation.contacts.len(),
            self.isolation.rank_deficit,
            self.isolation.residual
        )
    }
}

/// Contacts reported at most: an argument, or the default.
pub fn contact_count(object: Option<&Bound<'_, PyAny>>) -> PyResult<usize> {
    let count = object.map_or(Ok(5), |object| whole("max_contacts", object, 1000))?;
    Ok(count as usize)
}

/// Finds the contacts that explain an external torque and the wrenches of sensors: links, points and forces.
///
/// One contact is isolated by Vorndamme 2017, eqs. 22-26; several with sensors by eq. 27, without by eqs. 28-31. Where
/// torques do not determine two wrenches, it is used that the force of a contact has no moment, acts on the surface and
/// pushes; several solutions are candidates.
///
/// Args:
///     robot: the robot.
///     sensors: `ForceTorqueSensor`s, in the order of the wrenches.
///     torque_threshold: scalar or `(nv,)` [Nm, N]. A joint takes part in a contact above it, and a third of it is the
///         standard deviation of the torques' errors. With `noise` the default is three standard deviations at rest.
///     wrench_threshold: the same for wrenches: scalar, `(6,)` or `(n_sensors, 6)` [N, Nm].
///     wanted_contacts: names of sensors whose contacts are meant and not reported (Vorndamme 2017, eq. 20).
///     max_contacts: number of contacts that are reported at most.
///     pushing: whether forces push on the surface. If not, the point cannot be determined, and `located` is False.
///     noise: a `NoiseModel` of the external torque, in place of the third of a threshold.
///     locate_within: a contact is located if 90 % of the places that explain the torques are within this distance of its
///         point [m].
///
/// Raises:
///     InputError: an argument cannot be used; names it.
///
/// Example:
///     >>> import contactsense as cs
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> isolator = cs.ContactIsolator(robot)
///     >>> isolator.isolate(robot.neutral(), robot.torque({})).contacts
///     ()
#[pyclass(frozen, name = "ContactIsolator", module = "contactsense")]
pub struct PyContactIsolator {
    robot: Py<PyRobot>,
    names: Arc<Names>,
    state: Mutex<State>,
}

struct State {
    isolator: ContactIsolator,
    wrenches: Vec<Option<Vector6<f64>>>,
}

#[pymethods]
impl PyContactIsolator {
    #[new]
    #[pyo3(signature = (robot, *, sensors=None, torque_threshold=None, wrench_threshold=None, wanted_contacts=None,
                        max_contacts=None, pushing=true, noise=None, locate_within=None),
           text_signature = "(robot, *, sensors=(), torque_threshold=1e-3, wrench_threshold=1e-3, wanted_contacts=(), \
            max_contacts=5, pushing=True, noise=None, locate_within=0.05)")]
    #[allow(clippy::too_many_arguments)] // the keywords of the Python class
    fn new(
        #[pyo3(from_py_with = robot)] robot: Bound<'_, PyRobot>,
        sensors: Option<&Bound<'_, PyAny>>,
        torque_threshold: Option<&Bound<'_, PyAny>>,
        wrench_threshold: Option<&Bound<'_, PyAny>>,
        wanted_contacts: Option<&Bound<'_, PyAny>>,
        max_contacts: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = pushing)] pushing: bool,
        noise: Option<&Bound<'_, PyAny>>,
        locate_within: Option<Number<'_, '_>>,
    ) -> PyResult<Self> {
        let mut options =
            IsolatorOptions { max_contacts: contact_count(max_contacts)?, pushing, ..Default::default() };
        if let Some(distance) = locate_within {
            options.locate_within = distance.named("locate_within")?;
        }
        if let Some(sensors) = sensors {
            options.sensors = self::sensors(sensors)?;
        }
        if let Some(noise) = noise {
            // The thresholds follow from it, too.
            (options.noise, options.torque_threshold) = (Some(noise_model(noise)?), None);
        }
        if let Some(threshold) = torque_threshold {
            options.torque_threshold = Some(scalar_or_vector("torque_threshold", threshold)?);
        }
        if let Some(threshold) = wrench_threshold {
            options.wrench_threshold = wrench_thresholds(threshold)?;
        }
        if let Some(wanted) = wanted_contacts {
            options.wanted_contacts = sensor_names(wanted)?;
        }
        let shared = robot.get().0.clone();
        let isolator = ContactIsolator::new(shared.clone(), &options);
        let isolator = isolator.map_err(|error| to_python(robot.py(), error))?;
        let names = Names::new(&shared, isolator.sensor_names());
        Ok(Self { robot: robot.unbind(), names, state: Mutex::new(State { isolator, wrenches: vec![] }) })
    }

    /// The robot whose contacts are isolated.
    #[getter]
    fn robot(&self, py: Python<'_>) -> Py<PyRobot> {
        self.robot.clone_ref(py)
    }

    fn __repr__(&self) -> String {
        let (name, sensors) = (self.robot.get().0.name(), self.names.sensors.len());
        format!("ContactIsolator('{name}', {sensors} sensors)")
    }

    /// The contacts that explain an external torque.
    ///
    /// Args:
    ///     q: configuration, `(nq,)`.
    ///     tau_ext: external torque, `(nv,)` [Nm, N].
    ///     wrenches: the external wrench that each sensor measures, `(n_sensors, 6)` [N, Nm], as `LoadCompensator` gives it: force
    ///         and moment at the sensor's origin, world axes. A NaN in a row leaves its sensor out.
    ///
    /// Returns:
    ///     An `Isolation`.
    ///
    /// Raises:
    ///     InputError: an argument cannot be used; names it.
    #[pyo3(signature = (q, tau_ext, wrenches=None))]
    fn isolate(
        &self,
        py: Python<'_>,
        q: &Bound<'_, PyAny>,
        tau_ext: &Bound<'_, PyAny>,
        wrenches: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PyIsolation> {
        let (q, tau_ext) = (Vector::new("q", q)?, Vector::new("tau_ext", tau_ext)?);
        let given = wrenches.map(Readings::new).transpose()?;
        let given = given.as_ref().map_or(&[][..], |given| given.rows());
        let mut state = sole(py, "ContactIsolator", &self.state)?;
        let State { isolator, wrenches } = &mut *state;
        wrenches.clear();
        wrenches.extend(given.iter().map(|row| row.map(Vector6::from)));
        let isolation = isolator.isolate_sensed(q.slice(), tau_ext.slice(), wrenches);
        let isolation = isolation.map_err(|error| to_python(py, error))?.clone();
        Ok(PyIsolation { names: self.names.clone(), isolation, wrapped: PyOnceLock::new() })
    }
}
