//! `StaticObstacleSampler`.

use std::sync::{Arc, Mutex, MutexGuard};

use contactsense::robot::LinkIndex;
use contactsense::sampler::{ContactModel, SamplerOptions, StaticObstacleSampler};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{sole, whole, Number};
use crate::arrays::Vector;
use crate::errors::{input, to_python};
use crate::estimate::PyContactEstimate;
use crate::filter_options::Choice;
use crate::names::Names;
use crate::particles::{Particles, Row};
use crate::returned::numbers;
use crate::robot::PyRobot;
use crate::robot_argument::robot;
use crate::search_arguments::SearchArguments;
use crate::sensor::names;
use crate::signals::with_signals;

/// From so many particles on an update may take a second and more, and Ctrl-C is looked for meanwhile.
const LONG: usize = 20_000;

/// Finds contacts anywhere on a robot from all joint torques that were measured of them (algorithm C3).
///
/// Where `ContactParticleFilter` forgets what earlier motions taught, each particle here is an obstacle that stays where it is
/// for good, and predicts the torques of a whole window of poses. Particles are taken from one measurement to the next by
/// tempered sequential Monte Carlo (Del Moral, Doucet and Jasra 2006). An update takes some milliseconds with 10,000 particles,
/// and up to some tenths of a second where particles are drawn anew. Noise that is greater than stated is learnt from what is
/// left over. One thread at a time may use it.
///
/// Args:
///     robot: The robot.
///     particles: How many.
///     models: What the contact may be with, one name or several: "obstacle" (round, stays where it is), "person" (the point
///         stays on the link, the force changes as it likes), "both" (the point stays on the link, and a spring ties it to
///         where it was in the world). Of several, `model_probabilities` says which explains the torques.
///     max_contacts: Contacts that there may be at the same time, 1 to 4. Of more than one, all are with obstacles, and there are
///         as many particles for each number of contacts: an update takes several times as long. `number_probabilities`
///         says how many contacts there are, `estimate.contacts` has an estimate of each. Where one comes or goes, the
///         window begins anew.
///     window: Poses whose torques are kept, 2 to 1000.
///     forgetting_time: Time after which a measurement counts for a part in e of what it did when it was new [s], so that
///         an obstacle that creeps is followed. None for obstacles that stay.
///     moves: Moves of each particle in an update at most where the window is full, 1 to 1000; more where it is not, for the
///         same work. Twice as many of particles of several contacts.
///     measurement: "normal" (frictionless) or "friction_cone": forces across the normal up to `friction` of it,
///         integrated out.
///     friction: Coefficient of friction of the cone.
///     links: Names of the links to look on; None for all that move and have a surface.
///     seed: A whole number. Same seed, same answer, for any number of `threads`.
///     force_range: Least and greatest force at the first touch [N].
///     stiffness_range: Least and greatest stiffness [N/m].
///     radius_range: Least and greatest radius of the obstacle's curvature [m].
///     threads: How many threads share an update.
///     torque_noise: Standard deviation of the torque at rest, scalar or `(nv,)` [Nm; N for sliding joints].
///     relative_noise: Standard deviation relative to the torque.
///     torque_threshold: Below it on every joint there is no contact, scalar or `(nv,)` [Nm; N for sliding joints]. By
///         default three standard deviations at rest where these are more; with `noise` always these.
///     noise: A `NoiseModel` in place of `torque_noise` and `relative_noise`.
///     calibration: A `Calibration` of this robot, whose noise takes the place of `noise`.
///
/// Raises:
///     InputError: Names the argument.
///     MemoryError: The particles do not fit into memory.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> sampler = cs.StaticObstacleSampler(robot, particles=500, models=("obstacle", "person"), seed=1)
///     >>> sampler.update(np.full(7, 0.4), [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0]).event
///     'started'
///     >>> round(sum(sampler.model_probabilities.values()), 9)
///     1.0
#[pyclass(frozen, name = "StaticObstacleSampler", module = "contactsense")]
pub struct PyStaticObstacleSampler {
    sampler: Mutex<StaticObstacleSampler>,
    robot: Py<PyRobot>,
    names: Arc<Names>,
    links: Arc<[LinkIndex]>,
    models: Vec<ContactModel>,
    /// The constructor's keyword arguments.
    options: Py<PyDict>,
}

impl PyStaticObstacleSampler {
    fn sole(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, StaticObstacleSampler>> {
        sole(py, "StaticObstacleSampler", &self.sampler)
    }
}

#[pymethods]
impl PyStaticObstacleSampler {
    #[new]
    #[pyo3(signature = (robot, *, particles=None, models=None, max_contacts=None, window=None, forgetting_time=None, moves=None,
        measurement=Choice::of("normal"), friction=None, links=None, seed=None, force_range=None, stiffness_range=None,
        radius_range=None, threads=None, torque_noise=None, relative_noise=None, torque_threshold=None, noise=None,
        calibration=None),
        text_signature = "(robot, *, particles=10_000, models='obstacle', max_contacts=1, window=40, forgetting_time=None, moves=1, \
            measurement='normal', friction=0.5, links=None, seed=0, force_range=(1, 100), stiffness_range=(3e2, 3e4), \
            radius_range=(5e-3, 1.0), threads=1, torque_noise=0.02, relative_noise=0.03, torque_threshold=0.2, noise=None, \
            calibration=None)")]
    #[allow(clippy::too_many_arguments)] // named in Python
    fn new(
        #[pyo3(from_py_with = robot)] robot: Bound<'_, PyRobot>,
        particles: Option<&Bound<'_, PyAny>>,
        models: Option<&Bound<'_, PyAny>>,
        max_contacts: Option<&Bound<'_, PyAny>>,
        window: Option<&Bound<'_, PyAny>>,
        forgetting_time: Option<Number>,
        moves: Option<&Bound<'_, PyAny>>,
        measurement: Choice,
        friction: Option<Number>,
        links: Option<&Bound<'_, PyAny>>,
        seed: Option<&Bound<'_, PyAny>>,
        force_range: Option<&Bound<'_, PyAny>>,
        stiffness_range: Option<&Bound<'_, PyAny>>,
        radius_range: Option<&Bound<'_, PyAny>>,
        threads: Option<&Bound<'_, PyAny>>,
        torque_noise: Option<&Bound<'_, PyAny>>,
        relative_noise: Option<Number>,
        torque_threshold: Option<&Bound<'_, PyAny>>,
        noise: Option<&Bound<'_, PyAny>>,
        calibration: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let py = robot.py();
        let given = SearchArguments {
            particles,
            measurement: &measurement,
            friction: friction.map(|friction| friction.0),
            links,
            seed,
            force_range,
            stiffness_range,
            radius_range,
            threads,
            torque_noise,
            relative_noise: relative_noise.map(|noise| noise.0),
            torque_threshold,
            noise,
            calibration,
        };
        let common = given.options(&robot)?;
        let mut options = SamplerOptions::like(&common);
        if let Some(models) = models {
            options.models = read_models(py, models)?;
        }
        for (name, object, number) in [
            ("max_contacts", max_contacts, &mut options.max_contacts),
            ("window", window, &mut options.window),
            ("moves", moves, &mut options.moves),
        ] {
            if let Some(object) = object {
                *number = whole(name, object, 1000)? as usize;
            }
        }
        options.forgetting_time = forgetting_time.map(|time| time.0);
        let kept = given.used(py, &common)?;
        let said: Vec<&str> = options.models.iter().map(|model| model.name()).collect();
        kept.set_item("models", pyo3::types::PyTuple::new(py, said)?)?;
        kept.set_item("max_contacts", options.max_contacts)?;
        kept.set_item("window", options.window)?;
        kept.set_item("forgetting_time", options.forgetting_time)?;
        kept.set_item("moves", options.moves)?;
        let sampler = StaticObstacleSampler::new(robot.get().0.clone(), &options);
        let sampler = sampler.map_err(|error| to_python(py, error))?;
        Ok(Self {
            names: Names::new(&robot.get().0, &[]),
            links: sampler.links().iter().copied().map(LinkIndex::new).collect(),
            sampler: Mutex::new(sampler),
            robot: robot.unbind(),
            models: options.models,
            options: kept.unbind(),
        })
    }

    /// The robot.
    #[getter]
    fn robot(&self, py: Python<'_>) -> Py<PyRobot> {
        self.robot.clone_ref(py)
    }

    /// The keyword arguments in use, by name; `StaticObstacleSampler(robot, **options)` makes an equal sampler.
    ///
    /// A new dict at every access. `noise` stands in it where it was given, otherwise `torque_noise` and
    /// `relative_noise` do. Vectors are `(nv,)` or one number for all, as given.
    #[getter]
    fn options<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.options.bind(py).copy()
    }

    /// Takes in a configuration and the external torque measured there.
    ///
    /// The first call that feels a contact spreads the particles over the surface. A pose that hardly differs from the last
    /// one takes its place in the window. Other Python threads run meanwhile. With many
    /// particles Ctrl-C ends the call early; `estimate` then has what was found, and later calls go on from there.
    ///
    /// Args:
    ///     q: Configuration, `(nq,)`.
    ///     tau_ext: External torque, `(nv,)` [Nm; N for sliding joints and a base's linear part]: what `MomentumObserver`
    ///         gives, or `g(q) - tau` where the robot holds still.
    ///     time: Of the measurement [s], which must be given where there is a `forgetting_time`, and never less than at the
    ///         last update. The estimate hands it on; None for the number of updates.
    ///
    /// Returns:
    ///     What the particles say.
    ///
    /// Raises:
    ///     InputError: Names the argument; the sampler is then unchanged.
    #[pyo3(signature = (q, tau_ext, *, time=None))]
    fn update(
        &self,
        q: &Bound<'_, PyAny>,
        tau_ext: &Bound<'_, PyAny>,
        time: Option<Number>,
    ) -> PyResult<PyContactEstimate> {
        let py = q.py();
        let q = Vector::new("q", q)?.into_vec();
        let tau_ext = Vector::new("tau_ext", tau_ext)?.into_vec();
        let time = time.map(|time| time.0);
        let mut sole = self.sole(py)?;
        let sampler = &mut *sole;
        let updated = if sampler.weights().len() < LONG {
            py.detach(|| sampler.update(&q, &tau_ext, time).map(|_| ()))
        } else {
            let stop = sampler.stop();
            with_signals(py, &stop, || sampler.update(&q, &tau_ext, time).map(|_| ()))?
        };
        updated.map_err(|error| to_python(py, error))?;
        Ok(self.said(sampler))
    }

    /// What the particles said at the last update; no contact before the first one.
    #[getter]
    fn estimate(&self, py: Python<'_>) -> PyResult<PyContactEstimate> {
        Ok(self.said(&*self.sole(py)?))
    }

    /// Forgets all updates.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        self.sole(py)?.reset();
        Ok(())
    }

    /// Probability of each of `models`, by name; all zero without a contact. A new dict at every access.
    #[getter]
    fn model_probabilities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let sampler = self.sole(py)?;
        let dict = PyDict::new(py);
        for model in &self.models {
            dict.set_item(model.name(), sampler.probability_of(*model))?;
        }
        Ok(dict)
    }

    /// How many times as likely all torques are under one of the models as without a contact, its natural logarithm.
    ///
    /// Two samplers that were given the same measurements are compared by it.
    #[getter]
    fn log_evidence(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.sole(py)?.total_log_evidence())
    }

    /// Probability that there are one, two, ... contacts, `(max_contacts,)`; all zero without a contact. A new array at every access.
    ///
    /// Beforehand, each further contact is a million times less probable than none: small errors of the model feign none.
    #[getter]
    fn number_probabilities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(numbers(py, self.sole(py)?.number_probabilities()))
    }

    /// The particles after the last update, one row a contact of each, of the most probable number of contacts; a read-only copy.
    #[getter]
    fn particles(&self, py: Python<'_>) -> PyResult<Particles> {
        let sampler = self.sole(py)?;
        let count = sampler.weights().len();
        let all = (0..sampler.contacts()).flat_map(|contact| (0..count).map(move |k| (k, contact)));
        let found = all.filter_map(|(k, contact)| sampler.particle(k, contact).map(|found| (contact, found)));
        let rows = found.map(|(contact, particle)| Row {
            contact,
            link: particle.link.get(),
            point: particle.point.into(),
            normal: particle.normal.into(),
            force: -particle.force.dot(&particle.normal),
            stiffness: particle.stiffness,
            weight: particle.weight,
        });
        Particles::of(py, self.robot.get(), rows)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let (robot, sampler) = (self.robot.get().0.name(), self.sole(py)?);
        Ok(format!("StaticObstacleSampler('{robot}', particles={})", sampler.weights().len()))
    }
}

impl PyStaticObstacleSampler {
    fn said(&self, sampler: &StaticObstacleSampler) -> PyContactEstimate {
        let found = sampler.estimate().clone();
        let time = sampler.time().unwrap_or(found.updates as f64);
        PyContactEstimate::new(self.names.clone(), self.links.clone(), found, time)
    }
}

/// One name or several.
fn read_models(py: Python<'_>, given: &Bound<'_, PyAny>) -> PyResult<Vec<ContactModel>> {
    let given = match given.extract::<String>() {
        Ok(name) => vec![name],
        Err(_) => names("models", "models", given)?,
    };
    let choices = ContactModel::ALL.map(|model| (model.name(), model));
    let mut models = Vec::with_capacity(given.len());
    for name in given {
        let model = Choice::of(&name).among(py, "models", &choices)?;
        if models.contains(&model) {
            return Err(input(py, format!("models: '{name}' is given twice")));
        }
        models.push(model);
    }
    Ok(models)
}
