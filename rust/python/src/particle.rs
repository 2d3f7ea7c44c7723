//! `ContactParticleFilter` and its `Particles`.

use std::sync::atomic::Ordering;
use std::sync::mpsc::{channel, RecvTimeoutError};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use contactsense::particle::{
    ContactParticleFilter, FilterEstimate, FilterOptions, ForceModel, Likelihood, Motion,
};
use contactsense::robot::LinkIndex;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{sole, whole, Number};
use crate::arrays::{scalar_or_vector, Vector};
use crate::calibration::noise_of;
use crate::errors::{input, to_python};
use crate::estimate::PyContactEstimate;
use crate::filter_options::{read_schedule, used_options, Choice};
use crate::names::Names;
use crate::pickle::arrays_alone;
use crate::returned::{from_rows, numbers, read_only};
use crate::robot::PyRobot;
use crate::robot_argument::robot;
use crate::sensor::names;

/// A copy of the particles, one row each; all arrays are read-only.
///
/// Frozen; can be pickled and copied.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> particle_filter = cs.ContactParticleFilter(cs.Robot.named("iiwa14"), particles=500)
///     >>> estimate = particle_filter.update(np.full(7, 0.4), [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])
///     >>> particle_filter.particles.point.shape
///     (500, 3)
#[pyclass(frozen, get_all, module = "contactsense")]
pub struct Particles {
    /// Index into `robot.link_names`, `(n,)`.
    pub link: Py<PyArray1<i64>>,
    /// Points on the surface, `(n, 3)`, world frame [m].
    pub point: Py<PyArray2<f64>>,
    /// Outward unit normals there, `(n, 3)`, world frame.
    pub normal: Py<PyArray2<f64>>,
    /// Force along the inward normal, `(n,)` [N].
    pub force: Py<PyArray1<f64>>,
    /// Stiffness of the contact, `(n,)` [N/m].
    pub stiffness: Py<PyArray1<f64>>,
    /// Weights, `(n,)`, which sum to one.
    pub weight: Py<PyArray1<f64>>,
}

/// Finds one contact anywhere on a robot from joint torques, by particles on its surface (Bimbo 2019).
///
/// Each particle is a hypothesis of link, point, obstacle, force and stiffness; those that predict the torques while the
/// robot makes small motions in contact survive. Frictionless, one contact, a convex obstacle that stays where it is. One
/// thread at a time may use it.
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
        likelihood=Choice::of("gaussian"), torque_noise=None, relative_noise=None, torque_threshold=None, noise=None, calibration=None),
        text_signature = "(robot, *, particles=10_000, motion='curvature', measurement='normal', friction=0.5, links=None, \
            seed=0, force_range=(1, 100), stiffness_range=(3e2, 3e4), radius_range=(5e-3, 1.0), schedule='adaptive', \
            threads=1, likelihood='gaussian', torque_noise=0.02, relative_noise=0.03, torque_threshold=0.2, noise=None, calibration=None)")]
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
    ) -> PyResult<Self> {
        let py = robot.py();
        let cone = ForceModel::FrictionCone(friction.map_or(FRICTION, |friction| friction.0));
        cone.check().map_err(|error| to_python(py, error))?;
        let mut options = FilterOptions {
            motion: motion.among(
                py,
                "motion",
                &[
                    ("curvature", Motion::Curvature),
                    ("fixed_on_link", Motion::FixedOnLink),
                    ("fixed_in_world", Motion::FixedInWorld),
                ],
            )?,
            force_model: measurement.among(
                py,
                "measurement",
                &[("normal", ForceModel::Normal), ("friction_cone", cone)],
            )?,
            likelihood: likelihood.among(
                py,
                "likelihood",
                &[("gaussian", Likelihood::Gaussian), ("exponential", Likelihood::Exponential)],
            )?,
            links: links.map(|links| names("links", "links", links)).transpose()?,
            ..FilterOptions::default()
        };
        if let Some(particles) = particles {
            options.particles = whole("particles", particles, 10_000_000)? as usize;
        }
        if let Some(seed) = seed {
            options.seed = whole("seed", seed, u64::MAX)?;
        }
        if let Some(threads) = threads {
            options.threads = whole("threads", threads, 256)? as usize;
        }
        for (name, object, range) in [
            ("force_range", force_range, &mut options.force_range),
            ("stiffness_range", stiffness_range, &mut options.stiffness_range),
            ("radius_range", radius_range, &mut options.radius_range),
        ] {
            if let Some(object) = object {
                *range = Vector::new(name, object)?.fixed::<2>(py, name)?;
            }
        }
        if (noise.is_some() || calibration.is_some()) && (torque_noise.is_some() || relative_noise.is_some())
        {
            return Err(input(
                py,
                "noise: give it (or calibration) or torque_noise and relative_noise, not both".into(),
            ));
        }
        options.noise = noise_of(&robot, noise, calibration)?;
        if let Some(noise) = torque_noise {
            options.torque_noise = scalar_or_vector("torque_noise", noise)?;
        }
        if let Some(noise) = relative_noise {
            options.relative_noise = noise.0;
        }
        if let Some(threshold) = torque_threshold {
            options.torque_threshold = Some(scalar_or_vector("torque_threshold", threshold)?);
        }
        options.schedule = read_schedule(py, schedule)?;
        let kept = used_options(py, &options)?;
        for (name, choice) in
            [("motion", &motion), ("measurement", &measurement), ("likelihood", &likelihood)]
        {
            kept.set_item(name, &choice.given)?;
        }
        kept.set_item("friction", friction.map_or(FRICTION, |friction| friction.0))?;
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
            update_with_signals(py, filter, &q, &tau_ext)?
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
        let columns = filter.particles();
        let touchable = self.robot.get().0.touchable_links();
        let number =
            |link: u32| touchable.iter().position(|l| l.get() == link as usize).map_or(-1, |k| k as i64);
        let count = columns.len();
        let points = (0..count).map(|k| filter.point(k).into());
        let normals = (0..count).map(|k| filter.normal(k).into());
        Ok(Particles {
            link: read_only(PyArray1::from_iter(py, columns.link.iter().map(|&link| number(link)))).unbind(),
            point: read_only(from_rows::<3>(py, points)?).unbind(),
            normal: read_only(from_rows::<3>(py, normals)?).unbind(),
            force: read_only(PyArray1::from_iter(py, columns.force.iter().map(|force| force.max(0.0))))
                .unbind(),
            stiffness: numbers(py, &columns.stiffness).unbind(),
            weight: numbers(py, filter.weights()).unbind(),
        })
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

/// Default of the friction cone's coefficient.
const FRICTION: f64 = 0.5;
/// From so many particles on an update may take a tenth of a second and more, and Ctrl-C is looked for meanwhile.
const LONG: usize = 200_000;
/// Time from one look to the next.
const LOOK: Duration = Duration::from_millis(50);

/// An update on another thread, while this one looks for signals; what a signal's handler raises stops it.
fn update_with_signals(
    py: Python<'_>,
    filter: &mut ContactParticleFilter,
    q: &[f64],
    tau_ext: &[f64],
) -> PyResult<contactsense::Result<FilterEstimate>> {
    let stop = filter.stop();
    let (updated, raised) = py.detach(|| {
        let (done, waiting) = channel();
        std::thread::scope(|scope| {
            let work = scope.spawn(move || {
                let updated = filter.update(q, tau_ext).cloned();
                // Nobody waits any more only where this thread's parent has panicked.
                let _ = done.send(());
                updated
            });
            let mut raised = None;
            while matches!(waiting.recv_timeout(LOOK), Err(RecvTimeoutError::Timeout)) {
                if let Err(error) = Python::attach(|py| py.check_signals()) {
                    stop.store(true, Ordering::Relaxed);
                    raised.get_or_insert(error);
                }
            }
            (work.join(), raised)
        })
    });
    // The update may have ended just before it was to be stopped.
    stop.store(false, Ordering::Relaxed);
    match raised {
        Some(error) => Err(error),
        None => Ok(updated.unwrap_or_else(|panic| std::panic::resume_unwind(panic))),
    }
}

arrays_alone!(Particles, "Particles", link, point, normal, force, stiffness, weight);
