//! `Identifiability`.

use contactsense::map::Identifiability;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::names::Names;
use crate::once::Once;
use crate::pickle::{plain_dict, reduced, Reduced};
use crate::returned::{from_rows, numbers, read_only};

#[derive(serde::Serialize, serde::Deserialize)]
pub struct Content {
    names: Names,
    found: Identifiability,
}

/// What the joint torques would tell of a contact at each of a map's samples, at one pose.
///
/// The torque of a contact is linearised in five unknowns: the three components of its force, and two coordinates of its point
/// in the tangent plane of the surface. Noise of the torques, force and point are Gaussian. The noise has the standard
/// deviations of the `NoiseModel` at the contact's own torque, the force those of the map's prior: tangentially `friction *
/// force / 2` in each direction, along the normal 1.45 times `force`, which is that of a logarithm uniform from 2 to 300 N. The
/// point has the covariance of the link's whole surface: where the torques say nothing of it, its standard deviation is that
/// of a point anywhere on the link. Confusion with other links, or with the other side of the same one, is not in it.
///
/// Frozen; can be pickled and copied; arrays are read-only. `n` is the number of samples.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> contact_map = cs.ContactMap(cs.Robot.named("iiwa14"), samples=1000)
///     >>> told = contact_map.identifiability(np.full(7, 0.4), force=20.0)
///     >>> bool(told.point_std[-1] < told.point_std[0]), int(told.rank[-1])
///     (True, 5)
#[pyclass(frozen, name = "Identifiability", module = "contactsense")]
pub struct PyIdentifiability {
    content: Content,
    links: Once<PyTuple>,
    points: Once<PyArray2<f64>>,
    point_std: Once<PyArray1<f64>>,
    rank: Once<PyArray1<i64>>,
    significance: Once<PyArray1<f64>>,
    detectable: Once<PyArray1<bool>>,
}

impl PyIdentifiability {
    pub fn new(names: Names, found: Identifiability) -> Self {
        Self::from_content(Content { names, found })
    }

    pub fn from_content(content: Content) -> Self {
        Self {
            content,
            links: Once::default(),
            points: Once::default(),
            point_std: Once::default(),
            rank: Once::default(),
            significance: Once::default(),
            detectable: Once::default(),
        }
    }
}

#[pymethods]
impl PyIdentifiability {
    /// Normal force of the contacts [N].
    #[getter]
    fn force(&self) -> f64 {
        self.content.found.force
    }

    /// Each sample's link, `n` names.
    #[getter]
    fn links<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        self.links.get(py, || self.content.names.of_links(py, &self.content.found.links))
    }

    /// The samples' points, `(n, 3)`, world frame [m], in the order of `MapEstimate.points`.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = || self.content.found.points.iter().map(|point| <[f64; 3]>::from(*point));
        self.points.get(py, || Ok(read_only(from_rows(py, rows())?)))
    }

    /// Standard deviation of the point of a contact there, `(n,)` [m]: the root of the trace of its covariance.
    #[getter]
    fn point_std<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.point_std.get(py, || Ok(numbers(py, &self.content.found.point_std)))
    }

    /// How many of the five unknowns torques without noise determine, `(n,)`, from 0 to 5.
    ///
    /// It is the rank of the derivatives of the torque. The prior plays no part in it.
    #[getter]
    fn rank<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let ranks = || self.content.found.rank.iter().map(|rank| i64::from(*rank));
        self.rank.get(py, || Ok(read_only(PyArray1::from_iter(py, ranks()))))
    }

    /// Norm of the torque of the normal force over its noise without contact, `(n,)` [standard deviations].
    #[getter]
    fn significance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.significance.get(py, || Ok(numbers(py, &self.content.found.significance)))
    }

    /// Whether this norm is greater than that of the noise without contact is in 99 % of cases, `(n,)`.
    #[getter]
    fn detectable<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        self.detectable.get(py, || Ok(read_only(PyArray1::from_slice(py, &self.content.found.detectable))))
    }

    /// All attributes by name.
    ///
    /// Returns:
    ///     Plain Python values: numbers, strings, and lists in place of arrays and tuples.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let attributes = ["force", "links", "points", "point_std", "rank", "significance", "detectable"];
        plain_dict(slf.as_any(), &attributes)
    }

    fn __len__(&self) -> usize {
        self.content.found.points.len()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "Identifiability", &self.content)
    }

    fn __repr__(&self) -> String {
        let found = &self.content.found;
        let mut deviations = found.point_std.clone();
        deviations.sort_by(f64::total_cmp);
        let [tenth, half, most] =
            [0.1, 0.5, 0.9].map(|share| 100.0 * deviations[(share * deviations.len() as f64) as usize]);
        format!(
            "Identifiability({} samples, force={} N, point_std: {half:.1} cm, from {tenth:.1} to {most:.1} cm for 80 %)",
            deviations.len(),
            found.force,
        )
    }
}
