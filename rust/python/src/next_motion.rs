//! `next_motion` and its `NextMotion`.

use contactsense::next_motion::{next_motion as plan, ContactHypothesis, NextMotion, NextMotionOptions};
use contactsense::robot::Robot;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{number, whole, wrong};
use crate::arrays::{scalar_or_vector, Vector};
use crate::calibration::noise_of;
use crate::errors::{detached, input, to_python};
use crate::estimate::PyContactEstimate;
use crate::motion::{PyMotion, ATTRIBUTES};
use crate::once::Once;
use crate::particles::Particles;
use crate::pickle::{plain_dict, reduced, Reduced};
use crate::returned::numbers;
use crate::robot::PyRobot;
use crate::robot_argument::robot;

/// A small motion in contact, and what it is expected to tell: a `Motion` that explains itself. Read-only.
///
/// Where nothing was found it has no rows and is false: `if motion:` asks whether there is one. `reason` then says why. Can be
/// pickled and copied.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> robot, q = cs.Robot.named("iiwa14"), np.full(7, 0.4)
///     >>> particle_filter = cs.ContactParticleFilter(robot, particles=500)
///     >>> estimate = particle_filter.update(q, [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])
///     >>> motion = cs.next_motion(robot, estimate, q, max_force=60.0, max_step=0.03)
///     >>> motion.spread_after < motion.spread_before
///     True
#[pyclass(extends = PyMotion, frozen, name = "NextMotion", module = "contactsense")]
pub struct PyNextMotion {
    found: NextMotion,
    force_range: Once<PyArray1<f64>>,
}

impl PyNextMotion {
    pub fn with_base(py: Python<'_>, found: NextMotion) -> PyResult<PyClassInitializer<Self>> {
        let base = PyMotion::new(py, found.motion.clone())?;
        Ok(PyClassInitializer::from(base).add_subclass(Self { found, force_range: Once::default() }))
    }
}

#[pymethods]
impl PyNextMotion {
    /// Expected information about the contact [nats]: by how much the entropy of the hypotheses is expected to fall.
    #[getter]
    fn information(&self) -> f64 {
        self.found.information
    }

    /// Root mean square distance of the contact point from its mean, now [m]; NaN without contact.
    #[getter]
    fn spread_before(&self) -> f64 {
        self.found.spread_before
    }

    /// The same after the motion, as expected [m].
    #[getter]
    fn spread_after(&self) -> f64 {
        self.found.spread_after
    }

    /// Least and greatest predicted force on the way, `(2,)` [N]; NaN where there is no motion; read-only.
    ///
    /// Over the hypotheses that are noticeable, each with its own stiffness. Greater than `max_force` only where a hypothesis
    /// has such a force already.
    #[getter]
    fn force_range<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.force_range.get(py, || Ok(numbers(py, &self.found.force_range)))
    }

    /// How many motions were drawn.
    #[getter]
    fn candidates(&self) -> usize {
        self.found.candidates
    }

    /// How many of them neither lose the contact nor press too hard.
    #[getter]
    fn admissible(&self) -> usize {
        self.found.admissible
    }

    /// Why there is no motion: "no contact" or "no admissible motion"; empty where there is one.
    #[getter]
    fn reason(&self) -> &'static str {
        self.found.nothing_found.map_or("", |why| why.name())
    }

    /// All attributes by name.
    ///
    /// Returns:
    ///     Plain Python values: numbers, strings, and lists in place of arrays.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let own = [
            "information",
            "spread_before",
            "spread_after",
            "force_range",
            "candidates",
            "admissible",
            "reason",
        ];
        plain_dict(slf.as_any(), &[&ATTRIBUTES[..], &own[..]].concat())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "NextMotion", &self.found)
    }

    fn __repr__(&self) -> String {
        let NextMotion { information, spread_before, spread_after, force_range, nothing_found, .. } =
            &self.found;
        let [least, most] = force_range;
        match nothing_found {
            Some(why) => format!("NextMotion({})", why.name()),
            None => format!(
                "NextMotion({information:.2} nats, spread {spread_before:.3} -> {spread_after:.3} m, \
                 {least:.1} to {most:.1} N)"
            ),
        }
    }
}

/// The small motion in contact that is expected to tell most about where the contact is.
///
/// `count` motions are drawn at random. Each hypothesis about the contact is an obstacle that stays where it is, and predicts
/// how force and torque change with a motion. A motion is admissible where, under all hypotheses but those that are less
/// probable than 4 % together, the force stays between a quarter of what it is and `max_force`; stiffnesses are taken as a
/// fifth greater. Forces that are greater than `max_force` already are held to be impossible, or, where a quarter of the
/// probability has such, must not rise. Of the admissible ones the one is taken after which the
/// expected spread of the contact point is least: each hypothesis in turn is held to be true, torques are drawn with their
/// noise, and what they leave of the others is averaged.
///
/// Collisions of the robot with itself and its surroundings are not looked at. Nothing is known of friction. After the
/// motion give the filter the torques at its end, better also those on the way, and plan the next one.
///
/// Args:
///     robot: With a fixed base.
///     estimate: The contact: a `ContactEstimate` of `ContactParticleFilter.update`, or a `MapEstimate`.
///     q: Configuration that it was made at, `(nq,)`: the start of the motion.
///     max_force: Greatest normal force that is allowed [N].
///     max_step: How far each joint moves at most, scalar or `(nv,)` [rad; m for sliding joints].
///     count: How many motions are drawn, from 1 to 10,000.
///     seed: Of the random numbers: the same seed gives the same motion.
///     particles: `ContactParticleFilter.particles`, after the same update. They say more than `estimate.modes` with their
///         spreads, which are the hypotheses where this is None.
///     noise: A `NoiseModel`, the errors of the torques; None for the default of the filter.
///     calibration: A `Calibration` of this robot, whose noise takes the place of `noise`.
///     duration: Length of the motion, at least `dt` [s].
///     dt: Time between its rows [s].
///
/// Returns:
///     A `NextMotion`, from `q` along a straight line of joint positions, at rest at both ends. Without rows, and false, where
///     the estimate shows no contact or no motion that was drawn is admissible.
///
/// Raises:
///     InputError: Names the argument; the base of the robot is free to move.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> robot, q = cs.Robot.named("iiwa14"), np.full(7, 0.4)
///     >>> particle_filter = cs.ContactParticleFilter(robot, particles=500)
///     >>> estimate = particle_filter.update(q, [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])
///     >>> motion = cs.next_motion(
///     ...     robot, estimate, q, max_force=60.0, max_step=0.03, particles=particle_filter.particles
///     ... )
///     >>> bool(motion), bool(np.abs(motion.q[-1] - q).max() <= 0.03)
///     (True, True)
#[pyfunction]
#[pyo3(signature = (robot, estimate, q, *, max_force, max_step, count=None, seed=None, particles=None, noise=None,
                    calibration=None, duration=None, dt=None),
       text_signature = "(robot, estimate, q, *, max_force, max_step, count=64, seed=0, particles=None, noise=None, calibration=None, duration=0.5, dt=0.001)")]
#[allow(clippy::too_many_arguments)] // named in Python
pub fn next_motion(
    #[pyo3(from_py_with = robot)] robot: Bound<'_, PyRobot>,
    estimate: &Bound<'_, PyAny>,
    q: &Bound<'_, PyAny>,
    max_force: &Bound<'_, PyAny>,
    max_step: &Bound<'_, PyAny>,
    count: Option<&Bound<'_, PyAny>>,
    seed: Option<&Bound<'_, PyAny>>,
    particles: Option<&Bound<'_, PyAny>>,
    noise: Option<&Bound<'_, PyAny>>,
    calibration: Option<&Bound<'_, PyAny>>,
    duration: Option<&Bound<'_, PyAny>>,
    dt: Option<&Bound<'_, PyAny>>,
) -> PyResult<Py<PyNextMotion>> {
    let py = robot.py();
    let estimate = estimate
        .cast::<PyContactEstimate>()
        .map_err(|error| wrong("estimate", "a contactsense.ContactEstimate", estimate, error.into()))?;
    let q = Vector::new("q", q)?.into_vec();
    let mut options = NextMotionOptions::new(number("max_force", max_force)?, 0.0);
    options.max_step = scalar_or_vector("max_step", max_step)?;
    if let Some(count) = count {
        options.count = whole("count", count, u64::from(u32::MAX))? as usize;
    }
    if let Some(seed) = seed {
        options.seed = whole("seed", seed, u64::MAX)?;
    }
    if let Some(duration) = duration {
        options.duration = number("duration", duration)?;
    }
    if let Some(dt) = dt {
        options.dt = number("dt", dt)?;
    }
    options.noise = noise_of(&robot, noise, calibration)?;
    let shared = robot.get().0.clone();
    if shared.floating_base() {
        return Err(input(
            py,
            "robot: its base must be fixed: a motion of the joints alone moves another one".into(),
        ));
    }
    let (estimate, torque) = estimate.get().of_robot(py, &shared)?;
    let particles = match particles {
        Some(particles) => {
            let given = particles.cast::<Particles>();
            let given = given
                .map_err(|error| wrong("particles", "a contactsense.Particles", particles, error.into()))?;
            hypotheses(&shared, given.get(), py)?
        }
        None => vec![],
    };
    let found = detached(py, || plan(&shared, estimate, torque, &particles, &q, &options))?;
    let found = found.map_err(|error| to_python(py, error))?;
    Py::new(py, PyNextMotion::with_base(py, found)?)
}

/// Rows of particles; their links are indices into those with a surface.
fn hypotheses(robot: &Robot, particles: &Particles, py: Python<'_>) -> PyResult<Vec<ContactHypothesis>> {
    let links = particles.link.bind(py).to_vec()?;
    let (points, normals) = (particles.point.bind(py).to_vec()?, particles.normal.bind(py).to_vec()?);
    let [forces, stiffnesses, weights] =
        [&particles.force, &particles.stiffness, &particles.weight].map(|column| column.bind(py).to_vec());
    let (forces, stiffnesses, weights) = (forces?, stiffnesses?, weights?);
    let of_other = || input(py, "particles: they are of another robot".to_string());
    let (points, normals) = (points.as_chunks::<3>().0, normals.as_chunks::<3>().0);
    let mut rows = Vec::with_capacity(links.len());
    for (k, link) in links.iter().enumerate() {
        let link = usize::try_from(*link).ok().and_then(|link| robot.touchable_links().get(link));
        rows.push(ContactHypothesis {
            link: *link.ok_or_else(of_other)?,
            point: points[k].into(),
            normal: normals[k].into(),
            force: forces[k],
            stiffness: stiffnesses[k],
            weight: weights[k],
        });
    }
    Ok(rows)
}
