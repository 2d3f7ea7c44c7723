//! `ContactEstimate` and `Mode`.

use std::sync::Arc;

use contactsense::nalgebra::{Matrix3, Vector3};
use contactsense::particle::{FilterEstimate, Mode};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple};

use crate::isolator::once;
use crate::names::Names;
use crate::plain::{reduced, restored, to_dict, Reduced};
use crate::returned::{from_rows, read_only, result};

/// A place where the contact may be.
#[pyclass(frozen, name = "Mode", module = "contactsense")]
pub struct PyMode {
    names: Arc<Names>,
    mode: Mode,
}

#[pymethods]
impl PyMode {
    /// The link's name.
    #[getter]
    fn link(&self) -> &str {
        self.names.link(self.mode.link)
    }

    /// The place on the link's surface, `(3,)`, world frame [m].
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        result(py, self.mode.point.as_slice())
    }

    /// Force on the robot, `(3,)`, world frame [N].
    #[getter]
    fn force<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        result(py, self.mode.force.as_slice())
    }

    /// Outward normal, `(3,)`, world frame.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        result(py, self.mode.normal.as_slice())
    }

    /// Share of the particles' weight.
    #[getter]
    fn probability(&self) -> f64 {
        self.mode.probability
    }

    /// Root of the mean squared distance of the mode's particles from their mean [m].
    #[getter]
    fn spread(&self) -> f64 {
        self.mode.spread
    }

    /// As plain Python data: numbers, strings and lists.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        to_dict(slf, &["link", "point", "force", "normal", "probability", "spread"])
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "Mode", &(&*self.names, &self.mode))
    }

    fn __repr__(&self) -> String {
        let p = &self.mode.point;
        let (link, probability) = (self.link(), self.mode.probability);
        format!("Mode('{link}', point=[{:.4}, {:.4}, {:.4}], probability={probability:.3})", p.x, p.y, p.z)
    }
}

/// The contact as a filter estimates it.
#[pyclass(frozen, name = "ContactEstimate", module = "contactsense")]
pub struct PyContactEstimate {
    names: Arc<Names>,
    /// Those that are looked on.
    links: Arc<[usize]>,
    found: FilterEstimate,
    time: f64,
    wrapped: PyOnceLock<Py<PyTuple>>,
}

/// What `to_dict` of an estimate holds.
const ESTIMATE: [&str; 16] = [
    "contact",
    "event",
    "link",
    "point",
    "force",
    "normal",
    "magnitude",
    "stiffness",
    "covariance",
    "link_probabilities",
    "modes",
    "ambiguous",
    "explained",
    "residual",
    "effective_samples",
    "time",
];

/// An object that was pickled.
pub fn restore<'py>(py: Python<'py>, class: &str, state: &[u8]) -> PyResult<Bound<'py, PyAny>> {
    if class == "Mode" {
        let (names, mode) = restored(state)?;
        return Ok(Bound::new(py, PyMode { names: Arc::new(names), mode })?.into_any());
    }
    let (names, links, found, time): (Names, Vec<usize>, _, _) = restored(state)?;
    Ok(Bound::new(py, PyContactEstimate::new(Arc::new(names), links.into(), found, time))?.into_any())
}

impl PyContactEstimate {
    pub fn new(names: Arc<Names>, links: Arc<[usize]>, found: FilterEstimate, time: f64) -> Self {
        PyContactEstimate { names, links, found, time, wrapped: PyOnceLock::new() }
    }

    fn contact_mode(&self) -> Option<&Mode> {
        self.found.estimate.contact.as_ref()
    }

    fn vector<'py>(&self, py: Python<'py>, of: impl Fn(&Mode) -> Vector3<f64>) -> Bound<'py, PyArray1<f64>> {
        let vector = self.contact_mode().map_or(Vector3::repeat(f64::NAN), of);
        result(py, vector.as_slice())
    }
}

#[pymethods]
impl PyContactEstimate {
    /// Whether the torques show a contact.
    #[getter]
    fn contact(&self) -> bool {
        self.contact_mode().is_some()
    }

    /// What happened with this update.
    ///
    /// "none", "started", "continued", "lost", "changed" (the contact is elsewhere than it was estimated before) or
    /// "jumped" (the pose did, so the search began anew).
    #[getter]
    fn event(&self) -> &str {
        self.found.event.name()
    }

    /// The most probable link's name; empty without contact.
    #[getter]
    fn link(&self) -> &str {
        self.contact_mode().map_or("", |mode| self.names.link(mode.link))
    }

    /// The most probable place on that link, `(3,)`, world frame [m]; NaN without contact.
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.vector(py, |mode| mode.point)
    }

    /// Force on the robot, `(3,)`, world frame [N]; NaN without contact.
    #[getter]
    fn force<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.vector(py, |mode| mode.force)
    }

    /// Outward normal of the contact, `(3,)`, world frame; NaN without contact.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.vector(py, |mode| mode.normal)
    }

    /// Magnitude of the force [N]; NaN without contact.
    #[getter]
    fn magnitude(&self) -> f64 {
        self.contact_mode().map_or(f64::NAN, |mode| mode.force.norm())
    }

    /// Stiffness of the contact [N/m]; `None` without contact, and where the motion model has none.
    #[getter]
    fn stiffness(&self) -> Option<f64> {
        self.contact_mode()?.stiffness
    }

    /// Covariance of the point, `(3, 3)`, world frame [m^2]: second moment of all particles about `point`, other modes
    /// included.
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let c = self.found.estimate.covariance.unwrap_or(Matrix3::repeat(f64::NAN));
        from_rows(py, (0..3).map(|i| [c[(i, 0)], c[(i, 1)], c[(i, 2)]])).map(read_only)
    }

    /// Share of the particles' weight on each link that is looked on.
    #[getter]
    fn link_probabilities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (&link, probability) in self.links.iter().zip(&self.found.estimate.link_probabilities) {
            dict.set_item(&self.names.links[link], probability)?;
        }
        Ok(dict)
    }

    /// Clusters of particles, best first; at most eight.
    #[getter]
    fn modes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let wrap = |mode: &Mode| Bound::new(py, PyMode { names: self.names.clone(), mode: *mode });
        once(py, &self.wrapped, || self.found.estimate.modes.iter().map(wrap).collect())
    }

    /// Whether the contact is not determined.
    ///
    /// The data do not determine which link, or where on it, or motion has not confirmed yet that it is a single push: that
    /// one obstacle that stays explains the torques at the last poses, is in contact with the link near `point`, and its
    /// force follows the motion.
    #[getter]
    fn ambiguous(&self) -> bool {
        self.found.estimate.ambiguous
    }

    /// Whether a push by one obstacle that stays explains the torques at the last poses.
    ///
    /// These are 24 at most, each 5 mm from the one before. What is left over is within three times the stated noise (a chi-square test at 99 %), and the force follows the
    /// motion no less than on the softest obstacle of `stiffness_range` (another one at 99 %). Where not, the estimate is
    /// ambiguous, too: two contacts, a moment, a payload, a pull, or biased torques.
    #[getter]
    fn explained(&self) -> bool {
        self.found.explained
    }

    /// Torque that the best push does not explain at this update, in standard deviations of the stated noise.
    ///
    /// It is the root mean square over all joints; the noise is `torque_noise` and `relative_noise`.
    #[getter]
    fn residual(&self) -> f64 {
        self.found.residual
    }

    /// Effective number of particles before resampling.
    #[getter]
    fn effective_samples(&self) -> f64 {
        self.found.effective_samples
    }

    /// Time as given to `update` [s]; otherwise the number of updates since the start.
    #[getter]
    fn time(&self) -> f64 {
        self.time
    }

    /// As plain Python data: numbers, strings, lists and dicts, `None` for what is undetermined.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        to_dict(slf, &ESTIMATE)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "ContactEstimate", &(&*self.names, &self.links[..], &self.found, self.time))
    }

    fn __repr__(&self) -> String {
        let Some(mode) = self.contact_mode() else {
            return format!("ContactEstimate(no contact, event='{}')", self.event());
        };
        let (p, force) = (&mode.point, mode.force.norm());
        let ambiguous = if self.found.estimate.ambiguous { ", ambiguous" } else { "" };
        let link = self.link();
        format!(
            "ContactEstimate('{link}', point=[{:.4}, {:.4}, {:.4}], magnitude={force:.2} N{ambiguous})",
            p.x, p.y, p.z
        )
    }
}
