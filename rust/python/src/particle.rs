//! `ContactParticleFilter` and its `Particles`.

use std::sync::atomic::Ordering;
use std::sync::mpsc::{channel, RecvTimeoutError};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use contactsense::particle::{
    ContactParticleFilter, FilterEstimate, FilterOptions, ForceModel, Likelihood, Motion, Schedule,
};
use numpy::{PyArray1, PyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyMapping, PyTuple};

use crate::arguments::{number_if_any, robot, sole, whole, Number};
use crate::arrays::Vector;
use crate::errors::{input, to_python};
use crate::estimate::PyContactEstimate;
use crate::names::Names;
use crate::noise::noise_model;
use crate::observer::scalar_or_vector;
use crate::plain::Reduced;
use crate::returned::{from_rows, read_only, result};
use crate::robot::PyRobot;
use crate::sensor::names;

/// The particles of a filter, one row each.
#[pyclass(frozen, get_all, module = "contactsense")]
pub struct Particles {
    /// Links, `(n,)`: places in `robot.link_names`.
    link: Py<PyArray1<i64>>,
    /// Contact points, `(n, 3)`, world frame [m].
    point: Py<PyArray2<f64>>,
    /// Outward normals, `(n, 3)`, world frame.
    normal: Py<PyArray2<f64>>,
    /// Forces along the inward normal, `(n,)` [N].
    force: Py<PyArray1<f64>>,
    /// Stiffnesses, `(n,)` [N/m].
    stiffness: Py<PyArray1<f64>>,
    /// Weights, `(n,)`; their sum is one.
    weight: Py<PyArray1<f64>>,
}

#[pymethods]
impl Particles {
    #[new]
    fn new(
        link: Bound<'_, PyArray1<i64>>,
        point: Bound<'_, PyArray2<f64>>,
        normal: Bound<'_, PyArray2<f64>>,
        force: Bound<'_, PyArray1<f64>>,
        stiffness: Bound<'_, PyArray1<f64>>,
        weight: Bound<'_, PyArray1<f64>>,
    ) -> Self {
        Self {
            link: read_only(link).unbind(),
            point: read_only(point).unbind(),
            normal: read_only(normal).unbind(),
            force: read_only(force).unbind(),
            stiffness: read_only(stiffness).unbind(),
            weight: read_only(weight).unbind(),
        }
    }

    fn __len__(&self, py: Python<'_>) -> usize {
        self.weight.bind(py).len()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let names = ["link", "point", "normal", "force", "stiffness", "weight"];
        let columns = names.iter().map(|name| slf.getattr(*name)).collect::<PyResult<Vec<_>>>()?;
        Ok((slf.get_type().into_any(), PyTuple::new(slf.py(), columns)?))
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        format!("Particles({} particles)", self.__len__(py))
    }
}

/// Finds one contact anywhere on a robot from joint torques, by particles on its surface (Bimbo 2019).
///
/// Each particle is a hypothesis of link, point, obstacle, force and stiffness. Those that predict the torques while the
/// robot makes small motions in contact survive. It assumes one frictionless contact with a convex obstacle that stays
/// where it is.
///
/// Args:
///     robot: the robot.
///     particles: number of particles.
///     motion: model of how a contact moves: "curvature" (Bimbo 2019, eq. 8), or the baselines "fixed_on_link" and
///         "fixed_in_world".
///     measurement: "normal" (frictionless) or "friction_cone" (forces across the normal up to `friction` times the normal
///         force, integrated out).
///     friction: coefficient of friction of the "friction_cone".
///     links: names of the links to look on; by default all that move and have a surface.
///     seed: the same seed gives the same answer, for any number of `threads`.
///     force_range: least and greatest force at the start [N].
///     stiffness_range: least and greatest stiffness at the start [N/m].
///     radius_range: least and greatest radius of the obstacle's curvature at the start [m].
///     schedule: "adaptive" (or None; by what the data show), "paper", or a mapping of some of "sharpness" (alpha [1/Nm]),
///         "point_noise" [m], "force_noise" and "stiffness_noise" (relative), each a number or a pair (first, last), and
///         "updates", the number after which the last is reached.
///     threads: number of threads.
///     likelihood: "gaussian" (force and stiffness are integrated out) or "exponential" (Bimbo 2019, eq. 5; both are drawn
///         at random).
///     torque_noise: standard deviation of the torques at rest, scalar or `(nv,)` [Nm, N]. Greater noise is learnt.
///     relative_noise: standard deviation relative to the torque.
///     torque_threshold: external torque below which on every joint there is no contact, scalar or `(nv,)` [Nm, N]. The
///         default is more where three standard deviations at rest are; with `noise` it is these.
///     noise: a `NoiseModel` in place of `torque_noise` and `relative_noise`.
///
/// Raises:
///     InputError: an argument cannot be used; names it.
///     MemoryError: the particles do not fit into memory.
///
/// Example:
///     >>> import contactsense as cs
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> particle_filter = cs.ContactParticleFilter(robot, particles=100)
///     >>> particle_filter.update(robot.neutral(), robot.torque({})).contact
///     False
#[pyclass(frozen, name = "ContactParticleFilter", module = "contactsense")]
pub struct PyContactParticleFilter {
    filter: Mutex<ContactParticleFilter>,
    robot: Py<PyRobot>,
    names: Arc<Names>,
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
        likelihood=Choice::of("gaussian"), torque_noise=None, relative_noise=None, torque_threshold=None, noise=None),
        text_signature = "(robot, *, particles=10_000, motion='curvature', measurement='normal', friction=0.5, links=None, seed=0, \
            force_range=(1.0, 100.0), stiffness_range=(3e2, 3e4), radius_range=(5e-3, 1.0), schedule='adaptive', threads=1, \
            likelihood='gaussian', torque_noise=0.02, relative_noise=0.03, torque_threshold=0.2, noise=None)")]
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
    ) -> PyResult<Self> {
        let py = robot.py();
        let cone = ForceModel::FrictionCone(friction.map_or(0.5, |friction| friction.0));
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
        if noise.is_some() && (torque_noise.is_some() || relative_noise.is_some()) {
            return Err(input(py, "noise: give it or torque_noise and relative_noise, not both".into()));
        }
        options.noise = noise.map(noise_model).transpose()?;
        if let Some(torque_noise) = torque_noise {
            options.torque_noise = scalar_or_vector("torque_noise", torque_noise)?;
        }
        if let Some(share) = relative_noise {
            options.relative_noise = share.0;
        }
        if noise.is_some() {
            // The threshold follows from it, too.
            options.torque_threshold = None;
        }
        if let Some(threshold) = torque_threshold {
            options.torque_threshold = Some(scalar_or_vector("torque_threshold", threshold)?);
        }
        options.schedule = read_schedule(py, schedule)?;
        let shared = robot.get().0.clone();
        let names = Names::new(&shared, &[]);
        let filter = ContactParticleFilter::new(shared, options).map_err(|error| to_python(py, error))?;
        Ok(Self { filter: Mutex::new(filter), robot: robot.unbind(), names })
    }

    /// Takes in a configuration and the external torque measured there.
    ///
    /// The first call with a contact spreads the particles over the surface. Other Python threads run meanwhile. With many
    /// particles Ctrl-C stops the call, and the filter has then forgotten all updates.
    ///
    /// Args:
    ///     q: configuration, `(nq,)`.
    ///     tau_ext: external torque, `(nv,)` [Nm, N]: what `MomentumObserver` gives, or `g(q) - tau` where the robot holds still.
    ///     time: time of the measurement [s], which is handed on to the estimate.
    ///
    /// Returns:
    ///     A `ContactEstimate`.
    ///
    /// Raises:
    ///     InputError: an argument cannot be used; names it. The filter is then unchanged.
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
        Ok(PyContactEstimate::new(self.names.clone(), sole.links().into(), found, time))
    }

    /// The robot that contacts are looked for on.
    #[getter]
    fn robot(&self, py: Python<'_>) -> Py<PyRobot> {
        self.robot.clone_ref(py)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let (name, count) = (self.robot.get().0.name(), self.sole(py)?.particles().len());
        Ok(format!("ContactParticleFilter('{name}', {count} particles)"))
    }

    /// Forgets all updates.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        self.sole(py)?.reset();
        Ok(())
    }

    /// The particles after the last update.
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
            stiffness: result(py, &columns.stiffness).unbind(),
            weight: result(py, filter.weights()).unbind(),
        })
    }
}

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

/// The name of a choice; of another object what Python prints of it, which is no choice either.
struct Choice {
    given: String,
    text: bool,
}

impl Choice {
    fn of(name: &str) -> Self {
        Choice { given: name.into(), text: true }
    }

    /// The value of that name.
    fn among<T: Copy>(&self, py: Python<'_>, argument: &str, choices: &[(&str, T)]) -> PyResult<T> {
        match choices.iter().find(|(name, _)| self.text && *name == self.given) {
            Some((_, value)) => Ok(*value),
            None => {
                let names: Vec<String> = choices.iter().map(|(name, _)| format!("'{name}'")).collect();
                let quote = if self.text { "'" } else { "" };
                let given = &self.given;
                Err(input(
                    py,
                    format!("{argument}: must be one of {}, not {quote}{given}{quote}", names.join(", ")),
                ))
            }
        }
    }
}

impl<'a, 'py> FromPyObject<'a, 'py> for Choice {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        match object.extract::<String>() {
            Ok(name) => Ok(Choice::of(&name)),
            Err(_) => Ok(Choice { given: object.repr()?.to_string(), text: false }),
        }
    }
}

fn unknown(py: Python<'_>, name: &str, given: &str, choices: &str) -> PyErr {
    input(py, format!("{name}: there is no '{given}'; there are {choices}"))
}

/// `None`, "paper", or a mapping of pairs.
fn read_schedule(py: Python<'_>, object: Option<&Bound<'_, PyAny>>) -> PyResult<Schedule> {
    let Some(object) = object else { return Ok(Schedule::Adaptive) };
    if let Ok(name) = object.extract::<String>() {
        return match name.as_str() {
            "adaptive" => Ok(Schedule::Adaptive),
            "paper" => Ok(Schedule::paper()),
            _ => Err(unknown(py, "schedule", &name, "'adaptive', 'paper', or a dict")),
        };
    }
    let Ok(given) = object.cast::<PyMapping>() else {
        let given = object.repr()?;
        return Err(input(
            py,
            format!("schedule: must be None, 'adaptive', 'paper' or a mapping, not {given}"),
        ));
    };
    let mut schedule = Schedule::paper();
    let Schedule::Explicit { sharpness, point_noise, force_noise, stiffness_noise, updates } = &mut schedule
    else {
        return Ok(schedule);
    };
    for item in given.items()? {
        let (key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item.extract()?;
        let key: String = key.str()?.extract()?;
        let pair = match key.as_str() {
            "sharpness" => &mut *sharpness,
            "point_noise" => &mut *point_noise,
            "force_noise" => &mut *force_noise,
            "stiffness_noise" => &mut *stiffness_noise,
            "updates" => {
                *updates = whole("schedule: updates", &value, 1_000_000_000)? as usize;
                continue;
            }
            _ => {
                let choices = "'sharpness', 'point_noise', 'force_noise', 'stiffness_noise', 'updates'";
                return Err(unknown(py, "schedule", &key, choices));
            }
        };
        let name = format!("schedule: {key}");
        *pair = match number_if_any(&value)? {
            Some(both) => [both, both],
            None => Vector::new(&name, &value)?.fixed::<2>(py, &name)?,
        };
    }
    Ok(schedule)
}
