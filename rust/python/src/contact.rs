//! `Contact`.

use std::sync::Arc;

use contactsense::isolation::{Candidate, Contact, Isolation, LinkProbability, PathPoint};
use contactsense::nalgebra::Matrix3;
use contactsense::occupancy::PossiblePlace;
use contactsense::particle::Mode;
use contactsense::sensor::JOINT_TORQUES;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::candidate::PyCandidate;
use crate::estimate::{matrix, modes};
use crate::names::Names;
use crate::once::Once;
use crate::pickle::{plain_dict, reduced, Reduced};
use crate::returned::{from_rows, numbers, read_only, vector};

type Array<'py> = Bound<'py, PyArray1<f64>>;

/// One contact; vectors that the data do not determine are NaN.
///
/// Frozen; can be pickled and copied.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> tau_ext = [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0]
///     >>> contact = cs.ContactIsolator(robot).isolate(np.full(7, 0.4), tau_ext).contacts[0]
///     >>> contact.source
///     'joint torques'
///     >>> contact.wrench.shape
///     (6,)
#[pyclass(frozen, name = "Contact", module = "contactsense")]
pub struct PyContact {
    names: Arc<Names>,
    contact: Contact,
    found: Found,
    vectors: Vectors,
    covariance: Once<PyArray2<f64>>,
    determined_covariance: Once<PyArray2<f64>>,
    path_local: Once<PyArray2<f64>>,
    path_times: Once<PyArray1<f64>>,
    candidates: Once<PyTuple>,
    modes: Once<PyTuple>,
}

/// A contact's parts of what all contacts share.
#[derive(Default, serde::Serialize, serde::Deserialize)]
pub struct Found {
    candidates: Vec<Candidate>,
    modes: Vec<Mode>,
    link_probabilities: Vec<LinkProbability>,
    path: Vec<PathPoint>,
}

#[derive(Default)]
struct Vectors {
    point: Once<PyArray1<f64>>,
    point_local: Once<PyArray1<f64>>,
    force: Once<PyArray1<f64>>,
    normal: Once<PyArray1<f64>>,
    wrench: Once<PyArray1<f64>>,
    determined: Once<PyArray1<f64>>,
}

impl PyContact {
    fn new(names: Arc<Names>, contact: Contact, found: Found) -> Self {
        Self {
            names,
            contact,
            found,
            vectors: Vectors::default(),
            covariance: Once::default(),
            determined_covariance: Once::default(),
            path_local: Once::default(),
            path_times: Once::default(),
            candidates: Once::default(),
            modes: Once::default(),
        }
    }

    /// Places where the contact may be; none where nothing looked for several.
    pub fn modes_now(&self) -> &[Mode] {
        &self.found.modes
    }

    /// Its one place, if that is determined.
    pub fn one_place(&self) -> Option<PossiblePlace> {
        let place = self.contact.place.filter(|place| place.std.is_finite())?;
        Some(PossiblePlace {
            point: place.point,
            normal: place.normal,
            covariance: Matrix3::identity() * (place.std * place.std / 3.0),
            probability: 1.0,
        })
    }

    pub fn from_content((names, contact, found): (Names, Contact, Found)) -> Self {
        Self::new(Arc::new(names), contact, found)
    }
}

#[pymethods]
impl PyContact {
    /// Name of the link that is touched.
    #[getter]
    fn link(&self) -> &str {
        self.names.link(self.contact.link)
    }

    /// Point of contact, `(3,)`, world frame [m]; read-only.
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        self.vectors.point.get(py, || Ok(vector(py, self.contact.place.map(|place| place.point))))
    }

    /// Point of contact, `(3,)`, link frame [m]; read-only.
    #[getter]
    fn point_local<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        self.vectors.point_local.get(py, || Ok(vector(py, self.contact.place.map(|place| place.point_local))))
    }

    /// Force on the robot, `(3,)`, world frame [N]; read-only.
    #[getter]
    fn force<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        self.vectors.force.get(py, || Ok(vector(py, self.contact.force())))
    }

    /// Outward unit normal of the surface at the point, `(3,)`, world frame; read-only.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        self.vectors.normal.get(py, || Ok(vector(py, self.contact.place.map(|place| place.normal))))
    }

    /// Force and moment on the robot at the link's origin, `(6,)`, world axes [N, Nm]; read-only.
    #[getter]
    fn wrench<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        self.vectors.wrench.get(py, || Ok(vector(py, self.contact.wrench)))
    }

    /// What saw it: "joint torques", or the name of a sensor.
    #[getter]
    fn source(&self) -> &str {
        self.contact.source.map_or(JOINT_TORQUES, |sensor| &self.names.sensors[sensor.get()])
    }

    /// Whether 90 % of the places that explain the torques lie within `locate_within` of the point.
    ///
    /// If not, the link may be known, the point is not.
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

    /// Where it may be, best first.
    ///
    /// Every intersection of the line of action with a surface, points on other links that explain the torques about as
    /// well, or the points of several solutions. The same tuple at every access.
    #[getter]
    fn candidates<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        self.candidates.get(py, || {
            let wrap = |candidate: &Candidate| PyCandidate::new(self.names.clone(), *candidate);
            let list: Vec<_> = self
                .found
                .candidates
                .iter()
                .map(|found| Bound::new(py, wrap(found)))
                .collect::<PyResult<_>>()?;
            PyTuple::new(py, list)
        })
    }

    /// Probability that the contact is on `link`; NaN where no posterior was worked out.
    ///
    /// A monitor works out the posterior of a single contact over all surface (`ContactMap`), from the wrenches of sensors as well as
    /// the torques, where `samples` is not zero and there are no wanted points. It takes some ticks from the onset on.
    #[getter]
    fn probability(&self) -> f64 {
        self.contact.posterior.as_ref().map_or(f64::NAN, |posterior| posterior.probability)
    }

    /// Probability that the contact is on each link, by the link's name; a new dict at every access, empty without posterior.
    #[getter]
    fn link_probabilities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for LinkProbability { link, probability } in &self.found.link_probabilities {
            dict.set_item(self.names.link(*link), probability)?;
        }
        Ok(dict)
    }

    /// Covariance of the point, `(3, 3)`, world frame [m^2]; NaN without posterior; read-only.
    ///
    /// The second moment of the posterior about `point`, other modes included.
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let known = self.contact.posterior.as_ref().map(|posterior| posterior.covariance);
        self.covariance.get(py, || matrix(py, known))
    }

    /// What is known of the wrench where the point cannot be determined, `(6,)`; read-only.
    ///
    /// Force and moment on the robot at the link's origin, world axes [N, Nm]. NaN for a contact that is located, and where there are several contacts. `determined_wrench_covariance` says which
    /// components, or combinations of them, are determined.
    #[getter]
    fn determined_wrench<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        let known = self.contact.determined.map(|determined| determined.wrench);
        self.vectors.determined.get(py, || Ok(vector(py, known)))
    }

    /// Covariance of `determined_wrench`, `(6, 6)` [N^2, N^2 m, N^2 m^2]; NaN where that is NaN; read-only.
    ///
    /// Before anything is measured, the standard deviation of each component is 100 N for the force, and 100 N times the distance of
    /// the link's farthest point from its origin for the moment. What the torques do not determine keeps it.
    #[getter]
    fn determined_wrench_covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let known = self.contact.determined.map(|determined| determined.covariance);
        self.determined_covariance.get(py, || matrix(py, known))
    }

    /// Radius of the ball about `point` that holds 90 % of the posterior [m]; NaN without posterior.
    #[getter]
    fn region_radius(&self) -> f64 {
        self.contact.posterior.as_ref().map_or(f64::NAN, |posterior| posterior.region_radius)
    }

    /// Places where the contact may be, most probable first; at most eight, empty without posterior.
    ///
    /// The same tuple at every access.
    #[getter]
    fn modes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        self.modes.get(py, || modes(py, &self.names, &self.found.modes))
    }

    /// Which contact it is over time: the same number in all ticks of one contact; None where contacts are not followed.
    #[getter]
    fn id(&self) -> Option<u64> {
        self.contact.track.as_ref().map(|track| track.id)
    }

    /// Time of the contact's first tick, as `ContactReport.time` [s]; NaN where contacts are not followed.
    #[getter]
    fn since(&self) -> f64 {
        self.contact.track.as_ref().map_or(f64::NAN, |track| track.since)
    }

    /// Greatest force so far [N]; NaN where contacts are not followed.
    #[getter]
    fn peak_force(&self) -> f64 {
        self.contact.track.as_ref().map_or(f64::NAN, |track| track.peak_force)
    }

    /// Where the contact has been, oldest first, `(n, 3)`, each point in the frame of its link in `path_links` [m]; read-only.
    ///
    /// A point is added where the torques show that the contact has moved to another place on the robot; until then, the last
    /// point becomes more exact. At most 32: of a longer path, every second point is left out. Empty where contacts are not
    /// followed, and where neither a posterior nor a located point has been found yet.
    #[getter]
    fn path_local<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = self.found.path.iter().map(|point| point.point_local.into());
        self.path_local.get(py, || Ok(read_only(from_rows(py, rows)?)))
    }

    /// From when on the contact has been at each point of `path_local`, `(n,)`, as `ContactReport.time` [s]; read-only.
    #[getter]
    fn path_times<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        let times: Vec<f64> = self.found.path.iter().map(|point| point.time).collect();
        self.path_times.get(py, || Ok(numbers(py, &times)))
    }

    /// Names of the links of the points of `path_local`.
    #[getter]
    fn path_links<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let links: Vec<_> = self.found.path.iter().map(|point| point.link).collect();
        self.names.of_links(py, &links)
    }

    /// All attributes by name.
    ///
    /// Returns:
    ///     Plain Python values: numbers, strings, lists in place of arrays and tuples, and dicts in place of candidates.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let vectors = ["link", "point", "point_local", "force", "normal", "wrench", "source"];
        let determined = ["determined_wrench", "determined_wrench_covariance"];
        let others = ["located", "point_std", "verified", "candidates"];
        let posterior = ["probability", "link_probabilities", "covariance", "region_radius", "modes"];
        let track = ["id", "since", "peak_force", "path_local", "path_times", "path_links"];
        plain_dict(
            slf.as_any(),
            &[&vectors[..], &determined[..], &others[..], &posterior[..], &track[..]].concat(),
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "Contact", &(&*self.names, &self.contact, &self.found))
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

/// A tuple of contacts that live on their own.
pub fn contacts<'py>(
    py: Python<'py>,
    names: &Arc<Names>,
    isolation: &Isolation,
) -> PyResult<Bound<'py, PyTuple>> {
    let wrap = |contact: &Contact| {
        // One that was unpickled from a damaged file may say anything.
        let mut found = Found {
            candidates: isolation.candidates.get(contact.candidates.clone()).unwrap_or_default().to_vec(),
            ..Found::default()
        };
        if let Some(posterior) = &contact.posterior {
            found.modes = isolation.modes.get(posterior.modes.clone()).unwrap_or_default().to_vec();
            let links = isolation.link_probabilities.get(posterior.link_probabilities.clone());
            found.link_probabilities = links.unwrap_or_default().to_vec();
        }
        if let Some(track) = &contact.track {
            found.path = isolation.paths.get(track.path.clone()).unwrap_or_default().to_vec();
        }
        PyContact::new(names.clone(), contact.clone(), found)
    };
    let list: Vec<Bound<'py, PyContact>> =
        isolation.contacts.iter().map(|contact| Bound::new(py, wrap(contact))).collect::<PyResult<_>>()?;
    PyTuple::new(py, list)
}
