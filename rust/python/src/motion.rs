//! `Motion`, and the search for one that calibration learns from.

use contactsense::calibration::{Excitation, ExcitationPlanner, Motion};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arguments::{number, whole};
use crate::arrays::scalar_or_vector;
use crate::errors::{detached, input, to_python};
use crate::pickle::{plain_dict, reduced, Reduced};
use crate::returned::{numbers, read_only};
use crate::robot_argument::robot;

/// A planned motion: where the robot is at each instant, `n` rows at equal distances of time. Read-only.
///
/// Velocities and accelerations are the derivatives of the positions, and zero at both ends. Can be pickled and copied.
///
/// Example:
///     >>> import contactsense as cs
///     >>> motion = cs.exciting_motion(cs.Robot.named("iiwa14"), 2.0)
///     >>> q, v, a = motion.at(0.5)
///     >>> len(motion), q.shape
///     (2001, (7,))
#[pyclass(frozen, subclass, name = "Motion", module = "contactsense")]
pub struct PyMotion {
    motion: Motion,
    time: Py<PyArray1<f64>>,
    q: Py<PyArray2<f64>>,
    v: Py<PyArray2<f64>>,
    a: Py<PyArray2<f64>>,
}

/// What `to_dict` holds.
pub const ATTRIBUTES: [&str; 6] = ["time", "q", "v", "a", "duration", "unchecked"];

impl PyMotion {
    pub fn new(py: Python<'_>, motion: Motion) -> PyResult<Self> {
        let rows = motion.len();
        let joints = motion.joints();
        let columns = |values: &[f64], width: usize| {
            PyResult::Ok(read_only(PyArray1::from_slice(py, values).reshape([rows, width])?).unbind())
        };
        let q = columns(&motion.q, joints.0)?;
        let (v, a) = (columns(&motion.v, joints.1)?, columns(&motion.a, joints.1)?);
        Ok(Self { time: numbers(py, &motion.time).unbind(), q, v, a, motion })
    }
}

#[pymethods]
impl PyMotion {
    /// Time of each row, `(n,)`, from zero [s].
    #[getter]
    fn time(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        self.time.clone_ref(py)
    }

    /// Configurations, `(n, nq)`.
    #[getter]
    fn q(&self, py: Python<'_>) -> Py<PyArray2<f64>> {
        self.q.clone_ref(py)
    }

    /// Velocities, `(n, nv)` [rad/s, m/s].
    #[getter]
    fn v(&self, py: Python<'_>) -> Py<PyArray2<f64>> {
        self.v.clone_ref(py)
    }

    /// Accelerations, `(n, nv)` [rad/s^2, m/s^2].
    #[getter]
    fn a(&self, py: Python<'_>) -> Py<PyArray2<f64>> {
        self.a.clone_ref(py)
    }

    /// Length [s].
    #[getter]
    fn duration(&self) -> f64 {
        self.motion.duration()
    }

    /// Pairs of links whose distance was not checked: neighbours, and those that cross in nearly all poses.
    #[getter]
    fn unchecked<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.motion.unchecked)
    }

    /// The motion at any time; before and after it, its ends at rest.
    ///
    /// Args:
    ///     time: [s].
    ///
    /// Returns:
    ///     `(q, v, a)`: `(nq,)`, `(nv,)` and `(nv,)`, writable.
    ///
    /// Raises:
    ///     InputError: the time is not a finite number.
    #[allow(clippy::type_complexity)]
    fn at<'py>(
        &self,
        time: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>)> {
        let (py, instant) = (time.py(), number("time", time)?);
        if !instant.is_finite() {
            return Err(input(py, format!("time: must be finite [s], not {instant}")));
        }
        let (q, v, a) = self.motion.at(instant);
        Ok((PyArray1::from_vec(py, q), PyArray1::from_vec(py, v), PyArray1::from_vec(py, a)))
    }

    /// All attributes by name.
    ///
    /// Returns:
    ///     Plain Python values: numbers, strings, and lists in place of arrays.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        plain_dict(slf.as_any(), &ATTRIBUTES)
    }

    fn __len__(&self) -> usize {
        self.motion.len()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "Motion", &self.motion)
    }

    fn __repr__(&self) -> String {
        let fastest = self.motion.v.iter().fold(0.0_f64, |fastest, v| fastest.max(v.abs()));
        format!(
            "Motion({:.3} s, {} rows, at most {fastest:.2} rad/s)",
            self.motion.duration(),
            self.motion.len()
        )
    }
}

/// A contact-free motion that calibration learns from: rest to rest, within limits, clear of the robot itself.
///
/// It is a chain of moves from rest to rest, in which each joint goes far and fast, with sines added, slowly, or not at all.
/// Of several random moves, each time the one is taken and improved that tells most per second about inertial parameters,
/// bias, Coulomb and viscous friction and rotor inertia.
///
/// Links with a surface stay 1 cm away from each other and from a plane under the base, or 2 mm from links that are
/// nearer by design; neighbours and links that cross in nearly all poses are not checked (`Motion.unchecked`).
/// Nothing else around the robot is known: look at the motion before running it, and run it slowly first.
///
/// Args:
///     robot: with a fixed base.
///     seconds: length, 1 to 600 [s]; 30 to 60 s suit an arm.
///     max_velocity: largest speed of each joint, scalar or `(nv,)` [rad/s; m/s for sliding joints]; where the robot's own
///         velocity limit is smaller, that one counts. By default half of the robot's velocity limits, and 1 rad/s or
///         0.25 m/s where there are none. A joint comes to its largest speed in 0.25 s or more.
///     seed: of the random numbers; the same seed gives the same motion.
///     dt: time between rows [s].
///     joints: names of the joints that move; the others are held in a pose in which weights load those that move. All by
///         default.
///
/// Returns:
///     A `Motion`.
///
/// Raises:
///     InputError: An argument cannot be used; the base of the robot is free to move; no pose without collision was found.
///
/// Example:
///     >>> import contactsense as cs
///     >>> motion = cs.exciting_motion(cs.Robot.named("iiwa14"), 5.0)
///     >>> motion.q.shape
///     (5001, 7)
#[pyfunction]
#[pyo3(signature = (robot, seconds, *, max_velocity=None, seed=None, dt=None, joints=None),
       text_signature = "(robot, seconds, *, max_velocity=None, seed=0, dt=0.001, joints=None)")]
pub fn exciting_motion(
    robot: &Bound<'_, PyAny>,
    seconds: &Bound<'_, PyAny>,
    max_velocity: Option<&Bound<'_, PyAny>>,
    seed: Option<&Bound<'_, PyAny>>,
    dt: Option<&Bound<'_, PyAny>>,
    joints: Option<&Bound<'_, PyAny>>,
) -> PyResult<PyMotion> {
    let py = robot.py();
    let robot = self::robot(robot)?.get().0.clone();
    let mut wanted = Excitation::new(number("seconds", seconds)?);
    if let Some(max_velocity) = max_velocity {
        wanted.max_velocity = scalar_or_vector("max_velocity", max_velocity)?;
        if wanted.max_velocity.is_empty() {
            return Err(input(
                py,
                "max_velocity: expected one number or one a velocity variable, got none".into(),
            ));
        }
    }
    if let Some(seed) = seed {
        wanted.seed = whole("seed", seed, u64::MAX)?;
    }
    if let Some(dt) = dt {
        wanted.dt = number("dt", dt)?;
    }
    if let Some(joints) = joints {
        wanted.joints = joint_indices(joints, robot.joint_names())?;
    }
    let refused = |error| to_python(py, error);
    let mut planner = detached(py, || ExcitationPlanner::new(&robot, &wanted))?.map_err(refused)?;
    while detached(py, || planner.advance())? {
        py.check_signals()?;
    }
    PyMotion::new(py, detached(py, || planner.finish())?)
}

/// Velocity variables of joints by name, of a robot with a fixed base.
fn joint_indices(joints: &Bound<'_, PyAny>, names: &[String]) -> PyResult<Vec<usize>> {
    let py = joints.py();
    let wrong = |what: String| {
        input(py, format!("joints: expected names of joints; {what}; the joints are {}", names.join(", ")))
    };
    let given: Vec<String> = match joints.extract() {
        Ok(given) => given,
        Err(_) => return Err(wrong(format!("got {}", crate::arguments::shown(joints)))),
    };
    if given.is_empty() {
        return Err(wrong("got none".into()));
    }
    let index = |name: &String| {
        let found = names.iter().position(|known| known == name);
        found.ok_or_else(|| wrong(format!("there is no '{name}'")))
    };
    given.iter().map(index).collect()
}
