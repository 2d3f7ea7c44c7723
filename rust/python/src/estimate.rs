//! `ContactEstimate` and `Mode`.

use std::sync::Arc;

use contactsense::nalgebra::SMatrix;
use contactsense::particle::{ContactEstimate, FilterEstimate, Mode};
use contactsense::robot::{LinkIndex, Robot};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::errors::input;
use crate::names::Names;
use crate::once::Once;
use crate::pickle::{plain_dict, reduced, Reduced};
use crate::returned::{from_rows, numbers, read_only, vector};

type Array<'py> = Bound<'py, PyArray1<f64>>;

/// A place where the contact may be.
///
/// Frozen; can be pickled and copied.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> particle_filter = cs.ContactParticleFilter(robot, particles=500)
///     >>> estimate = particle_filter.update(np.full(7, 0.4), [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])
///     >>> 0.0 < estimate.modes[0].probability <= 1.0
///     True
#[pyclass(frozen, name = "Mode", module = "contactsense")]
pub struct PyMode {
    names: Arc<Names>,
    mode: Mode,
    vectors: Vectors,
}

#[derive(Default)]
struct Vectors {
    point: Once<PyArray1<f64>>,
    force: Once<PyArray1<f64>>,
    normal: Once<PyArray1<f64>>,
}

impl PyMode {
    fn new(names: Arc<Names>, mode: Mode) -> Self {
        Self { names, mode, vectors: Vectors::default() }
    }

    pub fn from_content((names, mode): (Names, Mode)) -> Self {
        Self::new(Arc::new(names), mode)
    }
}

#[pymethods]
impl PyMode {
    /// Name of the link.
    #[getter]
    fn link(&self) -> &str {
        self.names.link(self.mode.link)
    }

    /// Where it is on the link's surface, `(3,)`, world frame [m]; read-only.
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        self.vectors.point.get(py, || Ok(numbers(py, self.mode.point.as_slice())))
    }

    /// Force on the robot, `(3,)`, world frame [N]; read-only.
    #[getter]
    fn force<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        self.vectors.force.get(py, || Ok(numbers(py, self.mode.force.as_slice())))
    }

    /// Outward unit normal of the surface, `(3,)`, world frame; read-only.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        self.vectors.normal.get(py, || Ok(numbers(py, self.mode.normal.as_slice())))
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

    /// All attributes by name.
    ///
    /// Returns:
    ///     Plain Python values: numbers, strings, and lists in place of arrays.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        plain_dict(slf.as_any(), &["link", "point", "force", "normal", "probability", "spread"])
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

/// A tuple of modes that live on their own.
pub fn modes<'py>(py: Python<'py>, names: &Arc<Names>, modes: &[Mode]) -> PyResult<Bound<'py, PyTuple>> {
    let wrap = |mode: &Mode| Bound::new(py, PyMode::new(names.clone(), *mode));
    PyTuple::new(py, modes.iter().map(wrap).collect::<PyResult<Vec<_>>>()?)
}

/// A read-only `(3, 3)` array; NaN where there is none.
pub fn matrix<'py, const N: usize>(
    py: Python<'py>,
    matrix: Option<SMatrix<f64, N, N>>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let m = matrix.unwrap_or(SMatrix::repeat(f64::NAN));
    Ok(read_only(from_rows(py, (0..N).map(|i| std::array::from_fn::<_, N, _>(|k| m[(i, k)])))?))
}

const ATTRIBUTES: [&str; 16] = [
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

/// The contact as a filter or a sampler sees it, and others beside it.
///
/// Frozen; can be pickled and copied.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> particle_filter = cs.ContactParticleFilter(robot, particles=500)
///     >>> particle_filter.update(np.full(7, 0.4), np.zeros(7))
///     ContactEstimate(no contact, event='none')
///     >>> particle_filter.update(np.full(7, 0.4), [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0]).ambiguous
///     True
#[pyclass(frozen, subclass, name = "ContactEstimate", module = "contactsense")]
pub struct PyContactEstimate {
    names: Arc<Names>,
    /// Those that are looked on.
    links: Arc<[LinkIndex]>,
    found: FilterEstimate,
    time: f64,
    vectors: Vectors,
    covariance: Once<PyArray2<f64>>,
    modes: Once<PyTuple>,
}

impl PyContactEstimate {
    pub fn new(names: Arc<Names>, links: Arc<[LinkIndex]>, found: FilterEstimate, time: f64) -> Self {
        let (vectors, covariance, modes) = (Vectors::default(), Once::default(), Once::default());
        Self { names, links, found, time, vectors, covariance, modes }
    }

    pub fn from_content(content: (Names, Vec<LinkIndex>, FilterEstimate, f64)) -> Self {
        let (names, links, found, time) = content;
        Self::new(Arc::new(names), links.into(), found, time)
    }

    /// All attributes by name, with those of a subclass; of each contact those that all estimates have.
    pub fn plain<'py>(slf: &Bound<'py, Self>, own: &[&str]) -> PyResult<Bound<'py, PyDict>> {
        let dict = plain_dict(slf.as_any(), &[&ATTRIBUTES[..], own].concat())?;
        let each = Self::contacts(slf)?.iter().map(|contact| plain_dict(&contact, &ATTRIBUTES));
        dict.set_item("contacts", each.collect::<PyResult<Vec<_>>>()?)?;
        Ok(dict)
    }

    fn contact_mode(&self) -> Option<&Mode> {
        self.found.estimate.contact.as_ref()
    }

    /// Places where the contact may be.
    pub fn modes_now(&self) -> &[Mode] {
        &self.found.estimate.modes
    }

    /// What it says of the contact, and the torque that it is from if that is known; of this robot.
    pub fn of_robot(&self, py: Python<'_>, robot: &Robot) -> PyResult<(&ContactEstimate, Option<&[f64]>)> {
        let same = robot.links().iter().map(|link| &link.name).eq(&self.names.links);
        if !same {
            return Err(input(py, "estimate: it is of a robot with other links".into()));
        }
        let torque = (self.found.torque.len() == robot.nv()).then_some(&self.found.torque[..]);
        Ok((&self.found.estimate, torque))
    }
}

#[pymethods]
impl PyContactEstimate {
    /// Whether the torques show a contact.
    #[getter]
    fn contact(&self) -> bool {
        self.contact_mode().is_some()
    }

    /// What happened at this update.
    ///
    /// "none", "started", "continued", "lost", "changed" (the contact is elsewhere than it was held to be, or there is one more or
    /// one less of several) or "jumped" (the pose did, so the search began anew).
    #[getter]
    fn event(&self) -> &str {
        self.found.event.name()
    }

    /// Name of the most probable link; empty without contact.
    #[getter]
    fn link(&self) -> &str {
        self.contact_mode().map_or("", |mode| self.names.link(mode.link))
    }

    /// The most probable place on that link, `(3,)`, world frame [m]; NaN without contact; read-only.
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        self.vectors.point.get(py, || Ok(vector(py, self.contact_mode().map(|mode| mode.point))))
    }

    /// Force on the robot, `(3,)`, world frame [N]; NaN without contact; read-only.
    #[getter]
    fn force<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        self.vectors.force.get(py, || Ok(vector(py, self.contact_mode().map(|mode| mode.force))))
    }

    /// Outward unit normal of the contact, `(3,)`, world frame; NaN without contact; read-only.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        self.vectors.normal.get(py, || Ok(vector(py, self.contact_mode().map(|mode| mode.normal))))
    }

    /// Magnitude of the force [N]; NaN without contact.
    #[getter]
    fn magnitude(&self) -> f64 {
        self.contact_mode().map_or(f64::NAN, |mode| mode.force.norm())
    }

    /// Stiffness of the contact [N/m]; None without contact, and where the motion model has none.
    #[getter]
    fn stiffness(&self) -> Option<f64> {
        self.contact_mode()?.stiffness
    }

    /// Covariance of the point, `(3, 3)`, world frame [m^2]; NaN without contact; read-only.
    ///
    /// The second moment of all particles about `point`, other modes included.
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.covariance.get(py, || matrix(py, self.found.estimate.covariance))
    }

    /// Share of the particles' weight on each link that is looked on, by the link's name; a new dict at every access.
    #[getter]
    fn link_probabilities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (&link, probability) in self.links.iter().zip(&self.found.estimate.link_probabilities) {
            dict.set_item(self.names.link(link), probability)?;
        }
        Ok(dict)
    }

    /// Clusters of particles, best first; at most eight. The same tuple at every access.
    #[getter]
    fn modes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        self.modes.get(py, || modes(py, &self.names, &self.found.estimate.modes))
    }

    /// One estimate for each contact, of which this is the first; empty without contact.
    ///
    /// More than one only where several contacts are looked for (`max_contacts`). From update to update they stay in the same order
    /// as long as there are as many.
    #[getter]
    fn contacts<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let (py, own) = (slf.py(), slf.get());
        let mut all: Vec<Bound<'py, Self>> = own.contact().then(|| slf.clone()).into_iter().collect();
        for other in own.found.others.iter().filter(|other| other.contact.is_some()) {
            let found = FilterEstimate { estimate: other.clone(), others: vec![], ..own.found.clone() };
            all.push(Bound::new(py, Self::new(own.names.clone(), own.links.clone(), found, own.time))?);
        }
        PyTuple::new(py, all)
    }

    /// Whether the data do not say which link, or where on it, or motion has not confirmed yet that it is a single push.
    ///
    /// Confirmed: one obstacle that stays explains the torques at the last poses, touches the link near `point`, and its
    /// force follows the motion.
    #[getter]
    fn ambiguous(&self) -> bool {
        self.found.estimate.ambiguous
    }

    /// Whether a push by one obstacle that stays explains the torques at the last poses.
    ///
    /// These are 24 at most, each 5 mm from the one before. What is left over is within three times the stated noise (a
    /// chi-square test at 99 %), and the force follows the motion no less than on the softest obstacle of
    /// `stiffness_range` (another one at 99 %). Where not, the estimate is ambiguous, too: two contacts, a moment, a
    /// payload, a pull, or biased torques.
    #[getter]
    fn explained(&self) -> bool {
        self.found.explained
    }

    /// What the best push leaves over at this update: root mean square over the joints, in standard deviations.
    ///
    /// The standard deviations are those of the stated noise (`noise`, or `torque_noise` and `relative_noise`).
    #[getter]
    fn residual(&self) -> f64 {
        self.found.residual
    }

    /// Effective number of particles, before resampling.
    #[getter]
    fn effective_samples(&self) -> f64 {
        self.found.effective_samples
    }

    /// Time as given to `update` [s]; otherwise the number of updates since the start.
    #[getter]
    fn time(&self) -> f64 {
        self.time
    }

    /// All attributes by name.
    ///
    /// Returns:
    ///     Plain Python values: numbers, strings, lists in place of arrays and tuples, and dicts in place of modes and of
    ///     `contacts`.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        Self::plain(slf, &[])
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "ContactEstimate", &(&*self.names, &self.links[..], &self.found, self.time))
    }

    fn __repr__(&self) -> String {
        self.text("ContactEstimate")
    }
}

impl PyContactEstimate {
    /// What a class of this name says of itself.
    pub fn text(&self, class: &str) -> String {
        let Some(mode) = self.contact_mode() else {
            return format!("{class}(no contact, event='{}')", self.event());
        };
        let (p, force) = (&mode.point, mode.force.norm());
        let ambiguous = if self.found.estimate.ambiguous { ", ambiguous" } else { "" };
        let link = self.link();
        format!(
            "{class}('{link}', point=[{:.4}, {:.4}, {:.4}], magnitude={force:.2} N{ambiguous})",
            p.x, p.y, p.z
        )
    }
}
