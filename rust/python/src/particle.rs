//! `ContactParticleFilter`.

use std::sync::{Arc, Mutex, MutexGuard};

use contactsense::particle::{ContactParticleFilter, FilterOptions, Likelihood, Motion};
use contactsense::robot::LinkIndex;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{sole, whole, Number};
use crate::arrays::Vector;
use crate::errors::{input, to_python};
use crate::estimate::PyContactEstimate;
use crate::filter_options::{read_schedule, used_schedule, Choice};
use crate::names::Names;
use crate::particles::{Particles, Row};
use crate::robot::PyRobot;
use crate::robot_argument::robot;
use crate::search_arguments::SearchArguments;
use crate::signals::with_signals;

/// From so many particles on an update may take a tenth of a second and more, and Ctrl-C is looked for meanwhile.
const LONG: usize = 200_000;

/// Finds one contact or several anywhere on a robot from joint torques, by particles on its surface (Bimbo 2019).
///
/// Each particle is a hypothesis of link, point, obstacle, force and stiffness; those that predict the torques while the
/// robot makes small motions in contact survive. Obstacles are convex and stay where they are. Of several contacts, each has
/// particles of its own (Manuelli and Tedrake 2016). One thread at a time may use it.
///
/// Args:
///     robot: The robot.
///     particles: How many.
///     motion: "curvature" (eq. 8), or the baselines "fixed_on_link" and "fixed_in_world".
///     measurement: "normal" (frictionless) or "friction_cone": forces across the normal up to `friction` of it,
///         integrated out.
///     friction: Coefficient of friction of the cone.
///     links: Names of the links to look on; None for all that move and have a surface.
///     seed: A whole number. Same seed, same answer, for any number of `threads`.
///     force_range: Least and greatest force at the start [N].
///     stiffness_range: Least and greatest stiffness at the start [N/m].
///     radius_range: Least and greatest radius of the obstacle's curvature at the start [m].
///     schedule: How sharply torques are weighed and how far particles are moved at random: "adaptive" (by what the data
///         show), "paper", or a mapping of some of "sharpness" (alpha, eq. 5) [1/Nm], "point_noise" [m], "force_noise" and
///         "stiffness_noise" (relative), each a number or a pair (first, last), and "updates", after which the last is
///         reached. None is "adaptive".
///     threads: How many threads share an update.
///     likelihood: "gaussian" (force and stiffness are integrated out) or "exponential" (eq. 5, both are drawn at random).
///     torque_noise: Standard deviation of the torque at rest, scalar or `(nv,)` [Nm; N for sliding joints]. Greater noise
///         is learnt from what is left over.
///     relative_noise: Standard deviation relative to the torque.
///     torque_threshold: Below it on every joint there is no contact, scalar or `(nv,)` [Nm; N for sliding joints]. By
///         default three standard deviations at rest where these are more; with `noise` always these.
///     noise: A `NoiseModel` in place of `torque_noise` and `relative_noise`.
///     calibration: A `Calibration` of this robot, whose noise takes the place of `noise`.
///     max_contacts: Contacts that there may be at the same time, 1 to 4; several only with the Gaussian likelihood. Particles
///         of one more contact are added where the others do not explain the torques at some poses, and dropped when they
///         explain nothing. `estimate.contacts` has an estimate of each. An update takes as long for each contact.
///
/// Raises:
///     InputError: Names the argument.
///     MemoryError: The particles do not fit into memory.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> particle_filter = cs.ContactParticleFilter(robot, particles=500, seed=1)
///     >>> particle_filter.update(np.full(7, 0.4), [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0]).event
///     'started'
///     >>> again = cs.ContactParticleFilter(robot, **particle_filter.options)
#[pyclass(frozen, name = "ContactParticleFilter", module = "contactsense")]
pub struct PyContactParticleFilter {
    filter: Mutex<ContactParticleFilter>,
    robot: Py<PyRobot>,
    names: Arc<Names>,
    links: Arc<[LinkIndex]>,
    /// The constructor's keyword arguments.
    options: Py<PyDict>,
}

impl PyContactParticleFilter {
    fn sole(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, ContactParticleFilter>> {
        sole(py, "ContactParticleFilter", &self.filter)
    }
}

#[pymethods]
impl PyContactParticleFilter {
    #[new]
    #[pyo3(signature = (robot, *, particles=None, motion=Choice::of("curvature"), measurement=Choice::of("normal"), friction=None, links=None, seed=None,
        force_range=None, stiffness_range=None, radius_range=None, schedule=None, threads=None,
        likelihood=Choice::of("gaussian"), torque_noise=None, relative_noise=None, torque_threshold=None, noise=None, calibration=None,
        max_contacts=None),
        text_signature = "(robot, *, particles=10_000, motion='curvature', measurement='normal', friction=0.5, links=None, \
            seed=0, force_range=(1, 100), stiffness_range=(3e2, 3e4), radius_range=(5e-3, 1.0), schedule='adaptive', \
            threads=1, likelihood='gaussian', torque_noise=0.02, relative_noise=0.03, torque_threshold=0.2, noise=None, calibration=None, max_contacts=1)")]
    #[allow(clippy::too_many_arguments)] // named in Python
    fn new(
        #[pyo3(from_py_with = robot)] robot: Bound<'_, PyRobot>,
        particles: Option<&Bound<'_, PyAny>>,
        motion: Choice,
        measurement: Choice,
        friction: Option<Number>,
        links: Option<&Bound<'_, PyAny>>,
        seed: Option<&Bound<'_, PyAny>>,
        force_range: Option<&Bound<'_, PyAny>>,
        stiffness_range: Option<&Bound<'_, PyAny>>,
        radius_range: Option<&Bound<'_, PyAny>>,
        schedule: Option<&Bound<'_, PyAny>>,
        threads: Option<&Bound<'_, PyAny>>,
        likelihood: Choice,
        torque_noise: Option<&Bound<'_, PyAny>>,
        relative_noise: Option<Number>,
        torque_threshold: Option<&Bound<'_, PyAny>>,
        noise: Option<&Bound<'_, PyAny>>,
        calibration: Option<&Bound<'_, PyAny>>,
        max_contacts: Option<&Bound<'_, PyAny>>,
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
        let options = FilterOptions {
            motion: motion.among(
                py,
                "motion",
                &[
                    ("curvature", Motion::Curvature),
                    ("fixed_on_link", Motion::FixedOnLink),
                    ("fixed_in_world", Motion::FixedInWorld),
                ],
            )?,
            likelihood: likelihood.among(
                py,
                "likelihood",
                &[("gaussian", Likelihood::Gaussian), ("exponential", Likelihood::Exponential)],
            )?,
            schedule: read_schedule(py, schedule)?,
            max_contacts: match max_contacts {
                Some(given) => whole("max_contacts", given, 1000)? as usize,
                None => FilterOptions::default().max_contacts,
            },
            ..given.options(&robot)?
        };
        let kept = given.used(py, &options)?;
        kept.set_item("schedule", used_schedule(py, &options.schedule)?)?;
        kept.set_item("max_contacts", options.max_contacts)?;
        kept.set_item("motion", &motion.given)?;
        kept.set_item("likelihood", &likelihood.given)?;
        let filter = ContactParticleFilter::new(robot.get().0.clone(), options);
        let filter = filter.map_err(|error| to_python(py, error))?;
        Ok(Self {
            names: Names::new(&robot.get().0, &[]),
            links: filter.links().iter().copied().map(LinkIndex::new).collect(),
            filter: Mutex::new(filter),
            robot: robot.unbind(),
            options: kept.unbind(),
        })
    }

    /// The robot.
    #[getter]
    fn robot(&self, py: Python<'_>) -> Py<PyRobot> {
        self.robot.clone_ref(py)
    }

    /// The keyword arguments in use, by name; `ContactParticleFilter(robot, **options)` makes an equal filter.
    ///
    /// A new dict at every access. `noise` stands in it where it was given, otherwise `torque_noise` and
    /// `relative_noise` do. Vectors are `(nv,)` or one number for all, as given.
    #[getter]
    fn options<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.options.bind(py).copy()
    }

    /// Takes in a configuration and the external torque measured there.
    ///
    /// The first call that feels a contact spreads the particles over the surface. Other Python threads run meanwhile.
    /// With many particles Ctrl-C stops the call, and the filter has then forgotten all updates.
    ///
    /// Args:
    ///     q: Configuration, `(nq,)`.
    ///     tau_ext: External torque, `(nv,)` [Nm; N for sliding joints and a base's linear part]: what `MomentumObserver`
    ///         gives, or `g(q) - tau` where the robot holds still.
    ///     time: Handed on to the estimate [s]; None for the number of updates.
    ///
    /// Returns:
    ///     What the particles say.
    ///
    /// Raises:
    ///     InputError: Names the argument; the filter is then unchanged.
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
        if time.is_some_and(|time| !time.0.is_finite()) {
            return Err(input(py, "time: expected a finite number".into()));
        }
        let mut sole = self.sole(py)?;
        let filter = &mut *sole;
        let estimate = if filter.particles().len() < LONG {
            py.detach(|| filter.update(&q, &tau_ext).cloned())
        } else {
            let stop = filter.stop();
            with_signals(py, &stop, || filter.update(&q, &tau_ext).cloned())?
        };
        let found = estimate.map_err(|error| to_python(py, error))?;
        let time = time.map_or(found.updates as f64, |time| time.0);
        Ok(PyContactEstimate::new(self.names.clone(), self.links.clone(), found, time))
    }

    /// Forgets all updates.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        self.sole(py)?.reset();
        Ok(())
    }

    /// The particles after the last update, one row each; a read-only copy.
    #[getter]
    fn particles(&self, py: Python<'_>) -> PyResult<Particles> {
        let filter = self.sole(py)?;
        let rows = filter.contacts().enumerate().flat_map(|(contact, own)| {
            let columns = own.columns();
            (0..columns.len()).map(move |k| Row {
                contact,
                link: columns.link[k] as usize,
                point: own.point(k).into(),
                normal: own.normal(k).into(),
                force: columns.force[k].max(0.0),
                stiffness: columns.stiffness[k],
                weight: own.weights()[k],
            })
        });
        Particles::of(py, self.robot.get(), rows)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let (robot, options) = (self.robot.get().0.name(), self.options.bind(py));
        let particles = options.get_item("particles")?;
        Ok(format!(
            "ContactParticleFilter('{robot}', particles={})",
            particles.map_or(0, |n| n.extract().unwrap_or(0))
        ))
    }
}
