//! `ContactMap` and its `MapEstimate`.

use std::sync::{Arc, Mutex, MutexGuard};

use contactsense::map::{ContactMap, MapEstimate, MapOptions};
use contactsense::particle::{Event, FilterEstimate};
use contactsense::robot::LinkIndex;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{sole, whole, Number};
use crate::arrays::Vector;
use crate::calibration::noise_of;
use crate::errors::to_python;
use crate::estimate::PyContactEstimate;
use crate::identifiability::PyIdentifiability;
use crate::names::Names;
use crate::once::Once;
use crate::pickle::{reduced, Reduced};
use crate::returned::{from_rows, numbers, read_only};
use crate::robot::PyRobot;
use crate::robot_argument::robot;
use crate::sensor::names;

/// Of a contact whose identifiability is asked for, by default: a firm touch [N].
const FORCE: f64 = 10.0;

/// Says where on a robot a contact is, and how certain that is: the posterior over samples of all surface.
///
/// Beforehand, every link is equally likely, and on a link every place of the same area. Every sample of the surface is a
/// contact of unknown force: along the inward normal with a logarithm that is uniform from 2 to 300 N, across it by friction.
/// Where the posterior is narrower than the samples are apart, they are divided on the true surface. One contact; one thread
/// at a time may use it.
///
/// Args:
///     robot: The robot.
///     samples: Samples of the surface, over all links: in proportion to the root of a link's area, so that small ones have
///         enough.
///     friction: Coefficient of friction; the force across the normal has half of it, times the normal force, as its standard
///         deviation in each direction.
///     noise: A `NoiseModel`; None for the default one.
///     links: Names of the links to look on; None for all that move and have a surface.
///     pull_probability: Probability that a contact pulls on the surface.
///     calibration: A `Calibration` of this robot, whose noise takes the place of `noise`.
///
/// Raises:
///     InputError: Names the argument.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> contact_map = cs.ContactMap(cs.Robot.named("iiwa14"), samples=1000)
///     >>> estimate = contact_map.evaluate(np.full(7, 0.4), [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])
///     >>> estimate.log_evidence > 0.0
///     True
#[pyclass(frozen, name = "ContactMap", module = "contactsense")]
pub struct PyContactMap {
    map: Mutex<ContactMap>,
    robot: Py<PyRobot>,
    names: Arc<Names>,
    links: Arc<[LinkIndex]>,
}

impl PyContactMap {
    fn sole(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, ContactMap>> {
        sole(py, "ContactMap", &self.map)
    }
}

#[pymethods]
impl PyContactMap {
    #[new]
    #[pyo3(signature = (robot, *, samples=None, friction=None, noise=None, links=None, pull_probability=None, calibration=None),
        text_signature = "(robot, *, samples=5_000, friction=0.5, noise=None, links=None, pull_probability=0.05, calibration=None)")]
    fn new(
        #[pyo3(from_py_with = robot)] robot: Bound<'_, PyRobot>,
        samples: Option<&Bound<'_, PyAny>>,
        friction: Option<Number>,
        noise: Option<&Bound<'_, PyAny>>,
        links: Option<&Bound<'_, PyAny>>,
        pull_probability: Option<Number>,
        calibration: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let py = robot.py();
        let mut options = MapOptions {
            links: links.map(|links| names("links", "links", links)).transpose()?,
            ..MapOptions::default()
        };
        if let Some(samples) = samples {
            options.samples = whole("samples", samples, 1_000_000)? as usize;
        }
        if let Some(friction) = friction {
            options.friction = friction.0;
        }
        if let Some(probability) = pull_probability {
            options.pull_probability = probability.0;
        }
        if let Some(noise) = noise_of(&robot, noise, calibration)? {
            options.noise = noise;
        }
        let map = ContactMap::new(robot.get().0.clone(), &options).map_err(|error| to_python(py, error))?;
        Ok(Self {
            names: Names::new(&robot.get().0, &[]),
            links: map.links().iter().copied().map(LinkIndex::new).collect(),
            map: Mutex::new(map),
            robot: robot.unbind(),
        })
    }

    /// The robot.
    #[getter]
    fn robot(&self, py: Python<'_>) -> Py<PyRobot> {
        self.robot.clone_ref(py)
    }

    /// The posterior of one contact from an external torque.
    ///
    /// Args:
    ///     q: Configuration, `(nq,)`.
    ///     tau_ext: External torque, `(nv,)` [Nm; N for sliding joints and a base's linear part]: what `MomentumObserver`
    ///         gives, or `g(q) - tau` where the robot holds still.
    ///
    /// Returns:
    ///     The posterior.
    ///
    /// Raises:
    ///     InputError: Names the argument.
    fn evaluate(&self, q: &Bound<'_, PyAny>, tau_ext: &Bound<'_, PyAny>) -> PyResult<Py<PyMapEstimate>> {
        let py = q.py();
        let q = Vector::new("q", q)?.into_vec();
        let tau_ext = Vector::new("tau_ext", tau_ext)?.into_vec();
        let mut map = self.sole(py)?;
        let found = map.evaluate(&q, &tau_ext).map_err(|error| to_python(py, error))?.clone();
        let (points, log_posterior): (Vec<[f64; 3]>, Vec<f64>) =
            map.log_posterior().map(|(point, log)| (<[f64; 3]>::from(point), log)).unzip();
        Py::new(
            py,
            PyMapEstimate::with_base(Content {
                names: (*self.names).clone(),
                links: self.links.to_vec(),
                found,
                points,
                log_posterior,
            }),
        )
    }

    /// What the joint torques would tell of a contact at each sample: how exactly its point would be known.
    ///
    /// Args:
    ///     q: Configuration, `(nq,)`.
    ///     force: Normal force of the contacts [N].
    ///
    /// Returns:
    ///     By sample: standard deviation of the point, rank, and whether the contact can be detected.
    ///
    /// Raises:
    ///     InputError: Names the argument.
    #[pyo3(signature = (q, *, force=None), text_signature = "(self, q, *, force=10.0)")]
    fn identifiability(&self, q: &Bound<'_, PyAny>, force: Option<Number>) -> PyResult<PyIdentifiability> {
        let py = q.py();
        let q = Vector::new("q", q)?.into_vec();
        let force = force.map(|force| force.named("force")).transpose()?.unwrap_or(FORCE);
        let found = self.sole(py)?.identifiability(&q, force).map_err(|error| to_python(py, error))?;
        Ok(PyIdentifiability::new((*self.names).clone(), found))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let samples = self.sole(py)?.samples();
        Ok(format!("ContactMap('{}', samples={samples})", self.robot.get().0.name()))
    }
}

#[derive(serde::Serialize, serde::Deserialize)]
pub struct Content {
    names: Names,
    links: Vec<LinkIndex>,
    found: MapEstimate,
    points: Vec<[f64; 3]>,
    log_posterior: Vec<f64>,
}

/// The posterior of one contact as a map sees it: a `ContactEstimate` with what it says of every sample.
///
/// Frozen; can be pickled and copied. It assumes that there is a contact, so `contact` is True; `log_evidence` says whether
/// there is one. `modes` are clusters of the posterior, `stiffness` is None, `effective_samples` the
/// effective number of pieces of surface that the posterior is spread over; `residual` is what the best contact leaves over,
/// and `explained` says whether the noise explains that (a chi-square test at 99 %).
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> contact_map = cs.ContactMap(cs.Robot.named("iiwa14"), samples=1000)
///     >>> estimate = contact_map.evaluate(np.full(7, 0.4), [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])
///     >>> estimate.points.shape == (len(estimate.log_posterior), 3)
///     True
#[pyclass(extends = PyContactEstimate, frozen, name = "MapEstimate", module = "contactsense")]
pub struct PyMapEstimate {
    content: Content,
    points: Once<PyArray2<f64>>,
    log_posterior: Once<PyArray1<f64>>,
}

impl PyMapEstimate {
    pub fn with_base(content: Content) -> PyClassInitializer<Self> {
        let MapEstimate { estimate, residual, effective_samples, log_evidence, explained, .. } =
            &content.found;
        let event = if estimate.contact.is_some() { Event::Started } else { Event::None };
        let base = FilterEstimate {
            others: vec![],
            estimate: estimate.clone(),
            event,
            explained: *explained,
            residual: *residual,
            effective_samples: *effective_samples,
            log_evidence: *log_evidence,
            updates: 1,
            torque: vec![],
        };
        let base =
            PyContactEstimate::new(Arc::new(content.names.clone()), content.links.clone().into(), base, 0.0);
        let own = PyMapEstimate { content, points: Once::default(), log_posterior: Once::default() };
        PyClassInitializer::from(base).add_subclass(own)
    }
}

#[pymethods]
impl PyMapEstimate {
    /// The samples' points, `(n, 3)`, world frame [m]; read-only.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.points.get(py, || Ok(read_only(from_rows(py, self.content.points.iter().copied())?)))
    }

    /// Logarithm of each sample's share of the posterior, `(n,)`; the shares sum to one; read-only.
    #[getter]
    fn log_posterior<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.log_posterior.get(py, || Ok(numbers(py, &self.content.log_posterior)))
    }

    /// Logarithm of how many times as likely the torque is with a contact as without.
    #[getter]
    fn log_evidence(&self) -> f64 {
        self.content.found.log_evidence
    }

    /// Radius of the ball about `point` that holds 90 % of the posterior [m]; NaN without contact.
    #[getter]
    fn region_radius(&self) -> f64 {
        self.content.found.region_radius.unwrap_or(f64::NAN)
    }

    /// All attributes by name.
    ///
    /// Returns:
    ///     Plain Python values: numbers, strings, lists in place of arrays and tuples, and dicts in place of modes and of
    ///     `contacts`.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        PyContactEstimate::plain(
            slf.as_super(),
            &["points", "log_posterior", "log_evidence", "region_radius"],
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "MapEstimate", &self.content)
    }

    fn __repr__(slf: PyRef<'_, Self>) -> String {
        slf.as_super().text("MapEstimate")
    }
}
