//! `ContactMemory`; its files are written and read by Python.

use std::sync::{Arc, Mutex, MutexGuard};

use contactsense::nalgebra::{Matrix3, Vector3};
use contactsense::occupancy::{ContactMemory, MemoryOptions, PossiblePlace};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arguments::{number, sole, whole, wrong, Number};
use crate::arrays::{rows, Table, Vector};
use crate::contact::PyContact;
use crate::errors::{detached, input, to_python};
use crate::estimate::PyContactEstimate;
use crate::returned::{from_rows, numbers, read_only};
use crate::robot::PyRobot;
use crate::robot_argument::robot;

/// Where obstacles are and where none are, fused from contacts and from the space that the robot's body has been in.
///
/// Space is divided into voxels in the world frame; of those of which something is known, the logarithm of the odds that they
/// are occupied is kept. A planner that has no camera asks it where the robot may go. The world is held to stand still.
///
/// A voxel whose centre the body has been in is free, but for `free_error`. A contact is in one of the voxels of the distribution
/// of its point, half a voxel outward of the surface, the likelier the likelier that voxel was occupied before, or, with
/// `contact_error`, elsewhere: a voxel is occupied if the contact is there, else as likely as before. One thread at a time may
/// use it.
///
/// Args:
///     robot: The robot.
///     resolution: Edge of a voxel, from 0.001 to 1 [m].
///     prior: Probability that a voxel is occupied of which nothing is known.
///     free_error: Probability that a voxel is occupied although the body has been there.
///     contact_error: Probability that a contact is at none of its places.
///     max_voxels: How many voxels are kept at most. What would need more is refused.
///
/// Raises:
///     InputError: Names the argument.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> memory = cs.ContactMemory(robot, resolution=0.05)
///     >>> memory.add_free(robot.neutral())
///     >>> points, probabilities = memory.points()
///     >>> bool(memory.is_free(points).all())
///     True
#[pyclass(frozen, name = "ContactMemory", module = "contactsense")]
pub struct PyContactMemory {
    memory: Mutex<ContactMemory>,
    robot: Py<PyRobot>,
}

impl PyContactMemory {
    fn sole(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, ContactMemory>> {
        sole(py, "ContactMemory", &self.memory)
    }
}

#[pymethods]
impl PyContactMemory {
    #[new]
    #[pyo3(signature = (robot, *, resolution=None, prior=None, free_error=None, contact_error=None, max_voxels=None),
        text_signature = "(robot, *, resolution=0.02, prior=0.5, free_error=0.01, contact_error=0.05, max_voxels=2_000_000)")]
    fn new(
        #[pyo3(from_py_with = robot)] robot: Bound<'_, PyRobot>,
        resolution: Option<Number>,
        prior: Option<Number>,
        free_error: Option<Number>,
        contact_error: Option<Number>,
        max_voxels: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let py = robot.py();
        let mut options = MemoryOptions::default();
        for (name, given, value) in [
            ("resolution", resolution, &mut options.resolution),
            ("prior", prior, &mut options.prior),
            ("free_error", free_error, &mut options.free_error),
            ("contact_error", contact_error, &mut options.contact_error),
        ] {
            if let Some(given) = given {
                *value = given.named(name)?;
            }
        }
        if let Some(most) = max_voxels {
            options.max_voxels = whole("max_voxels", most, u64::from(u32::MAX))? as usize;
        }
        let memory = ContactMemory::new(Arc::clone(&robot.get().0), options);
        let memory = memory.map_err(|error| to_python(py, error))?;
        Ok(Self { memory: Mutex::new(memory), robot: robot.unbind() })
    }

    /// The robot.
    #[getter]
    fn robot(&self, py: Python<'_>) -> Py<PyRobot> {
        self.robot.clone_ref(py)
    }

    /// Edge of a voxel [m].
    #[getter]
    fn resolution(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.sole(py)?.options().resolution)
    }

    /// Probability that a voxel is occupied of which nothing is known.
    #[getter]
    fn prior(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.sole(py)?.options().prior)
    }

    /// Probability that a voxel is occupied although the body has been there.
    #[getter]
    fn free_error(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.sole(py)?.options().free_error)
    }

    /// Probability that a contact is at none of its places.
    #[getter]
    fn contact_error(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.sole(py)?.options().contact_error)
    }

    /// How many voxels are kept at most.
    #[getter]
    fn max_voxels(&self, py: Python<'_>) -> PyResult<usize> {
        Ok(self.sole(py)?.options().max_voxels)
    }

    /// The robot touched nothing: where its body is there is no obstacle.
    ///
    /// Links whose surface is not closed have no inside, and say nothing. Adding a configuration again changes nothing. Other
    /// Python threads run meanwhile.
    ///
    /// Args:
    ///     q: A configuration, `(nq,)`, or several, `(n, nq)`.
    ///
    /// Raises:
    ///     InputError: Names the argument; also where more than `max_voxels` would be known. Of several configurations those before
    ///         the one that is refused are kept.
    fn add_free(&self, q: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = q.py();
        let flat = match Vector::new("q", q) {
            Ok(one) => one.into_vec(),
            Err(_) => Table::new("q", q, 2, "(nq,) or (n, nq)")?.numbers,
        };
        let width = self.robot.get().0.nq();
        if flat.is_empty() || !flat.len().is_multiple_of(width) {
            return Err(input(py, format!("q: expected shape ({width},) or (n, {width})")));
        }
        let mut memory = self.sole(py)?;
        for row in flat.chunks(width) {
            let held = &mut *memory;
            detached(py, || held.add_free(row))?.map_err(|error| to_python(py, error))?;
            py.check_signals()?;
        }
        Ok(())
    }

    /// There was one contact: an obstacle is at one of its places. To be called once a contact, not once a tick.
    ///
    /// Args:
    ///     contact: A `ContactEstimate` or `MapEstimate`, a `Contact` of a report, or a tuple `(point, normal, covariance)` of
    ///         `(3,)` [m], `(3,)` outward, and `(3, 3)` [m^2], symmetric and positive semidefinite, world frame. Voxels reach
    ///         2^31 `resolution`s from the origin along each axis. Modes share the evidence by their probabilities.
    ///         An estimate stands for the first of its `contacts`: of several, add each.
    ///
    /// Raises:
    ///     InputError: Names the argument, or `max_voxels` where more would be known; the memory is unchanged.
    fn add_contact(&self, contact: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = contact.py();
        let places = places(contact)?;
        let mut memory = self.sole(py)?;
        memory.add_contact(&places).map_err(|error| to_python(py, error))
    }

    /// Probability that the voxel of each point is occupied; the prior where nothing is known of it.
    ///
    /// Args:
    ///     points: `(n, 3)`, world frame [m].
    ///
    /// Returns:
    ///     `(n,)`.
    ///
    /// Raises:
    ///     InputError: Names the argument.
    fn probability<'py>(&self, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (py, points) = (points.py(), rows::<3>("points", points)?);
        let memory = self.sole(py)?;
        Ok(PyArray1::from_iter(py, points.iter().map(|point| memory.probability(&Vector3::from(*point)))))
    }

    /// Whether the voxel of each point is known to be free.
    ///
    /// Args:
    ///     points: `(n, 3)`, world frame [m].
    ///     below: Free is what is occupied with a lower probability.
    ///
    /// Returns:
    ///     `(n,)` of bool; False where nothing is known.
    ///
    /// Raises:
    ///     InputError: Names the argument.
    #[pyo3(signature = (points, *, below=None), text_signature = "(self, points, *, below=0.1)")]
    fn is_free<'py>(
        &self,
        points: &Bound<'py, PyAny>,
        below: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let (py, points) = (points.py(), rows::<3>("points", points)?);
        let below = below.map(|below| share("below", below)).transpose()?.unwrap_or(FREE_BELOW);
        let memory = self.sole(py)?;
        let free = |point: &[f64; 3]| {
            let point = Vector3::from(*point);
            memory.known(&point) && memory.probability(&point) < below
        };
        Ok(PyArray1::from_iter(py, points.iter().map(free)))
    }

    /// Whether anything is known of the voxel of each point.
    ///
    /// Args:
    ///     points: `(n, 3)`, world frame [m].
    ///
    /// Returns:
    ///     `(n,)` of bool.
    ///
    /// Raises:
    ///     InputError: Names the argument.
    fn known<'py>(&self, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let (py, points) = (points.py(), rows::<3>("points", points)?);
        let memory = self.sole(py)?;
        Ok(PyArray1::from_iter(py, points.iter().map(|point| memory.known(&Vector3::from(*point)))))
    }

    /// Centres of all voxels of which something is known, and the probability that each is occupied.
    ///
    /// Returns:
    ///     `(points, probabilities)`: `(n, 3)`, world frame [m], and `(n,)`; in the order of x, y, z; read-only.
    #[allow(clippy::type_complexity)]
    fn points<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>)> {
        let memory = self.sole(py)?;
        let (voxels, edge) = (memory.voxels(), memory.options().resolution);
        let centres: Vec<[f64; 3]> =
            voxels.iter().map(|(index, _)| index.map(|i| (f64::from(i) + 0.5) * edge)).collect();
        let probabilities: Vec<f64> =
            voxels.iter().map(|(_, log_odds)| (1.0 + (-log_odds).exp()).recip()).collect();
        Ok((read_only(from_rows(py, centres.into_iter())?), numbers(py, &probabilities)))
    }

    /// Axis-aligned boxes that hold exactly the known voxels whose probability is in a range, each once.
    ///
    /// Args:
    ///     least: Least probability.
    ///     most: Greatest probability.
    ///
    /// Returns:
    ///     `(lower, upper)`: corners, `(m, 3)` each, world frame [m]; read-only.
    ///
    /// Raises:
    ///     InputError: Names the argument.
    #[pyo3(signature = (*, least=None, most=None), text_signature = "(self, *, least=0.5, most=1.0)")]
    #[allow(clippy::type_complexity)]
    fn boxes<'py>(
        &self,
        py: Python<'py>,
        least: Option<&Bound<'py, PyAny>>,
        most: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>)> {
        let least = least.map(|least| share("least", least)).transpose()?.unwrap_or(OCCUPIED_FROM);
        let most = most.map(|most| share("most", most)).transpose()?.unwrap_or(1.0);
        let found = self.sole(py)?.boxes(least, most);
        let lower = from_rows(py, found.iter().map(|one| one.lower))?;
        let upper = from_rows(py, found.iter().map(|one| one.upper))?;
        Ok((read_only(lower), read_only(upper)))
    }

    /// Writes all that is known as arrays of NumPy: `indices` (n, 3), `log_odds` (n,), and the options.
    ///
    /// A voxel spans from `indices * resolution` to `(indices + 1) * resolution` in the world frame [m].
    ///
    /// Args:
    ///     path: A file, which should end in ".npz".
    ///
    /// Raises:
    ///     InputError: The file cannot be written.
    fn save(slf: &Bound<'_, Self>, path: &Bound<'_, PyAny>) -> PyResult<()> {
        files(slf.py())?.call_method1("save", (slf, path)).map(drop)
    }

    /// The memory that `save` wrote.
    ///
    /// Args:
    ///     path: The file.
    ///     robot: The robot whose body and contacts are added from here on.
    ///
    /// Raises:
    ///     InputError: The file cannot be read, or is none of `save`.
    #[staticmethod]
    fn load<'py>(path: &Bound<'py, PyAny>, robot: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        files(path.py())?.call_method1("load", (path, robot))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        files(slf.py())?.call_method1("reduced", (slf,))
    }

    /// Forgets all.
    fn clear(&self, py: Python<'_>) -> PyResult<()> {
        self.sole(py)?.clear();
        Ok(())
    }

    /// Indices `(n, 3)` and log-odds `(n,)` of the known voxels: all that is known.
    #[allow(clippy::type_complexity)]
    fn _voxels<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>)> {
        let voxels = self.sole(py)?.voxels();
        let log_odds: Vec<f64> = voxels.iter().map(|(_, log_odds)| *log_odds).collect();
        let indices = from_rows(py, voxels.iter().map(|(index, _)| index.map(f64::from)))?;
        Ok((indices, numbers(py, &log_odds)))
    }

    /// Takes on what `_voxels` gave.
    fn _set_voxels(&self, indices: &Bound<'_, PyAny>, log_odds: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = indices.py();
        let (indices, log_odds) = (rows::<3>("indices", indices)?, Vector::new("log_odds", log_odds)?);
        let whole = |x: &f64| x.fract() == 0.0 && x.abs() < f64::from(i32::MAX);
        if indices.len() != log_odds.slice().len() || !indices.as_flattened().iter().all(whole) {
            return Err(input(py, "indices: expected whole numbers, as many rows as log_odds".into()));
        }
        let voxels = indices.iter().zip(log_odds.slice());
        let voxels: Vec<([i32; 3], f64)> =
            voxels.map(|(index, log_odds)| (index.map(|x| x as i32), *log_odds)).collect();
        self.sole(py)?.set_voxels(&voxels).map_err(|error| to_python(py, error))
    }

    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        Ok(self.sole(py)?.len())
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let memory = self.sole(py)?;
        let (robot, edge, known) = (self.robot.get().0.name(), memory.options().resolution, memory.len());
        Ok(format!("ContactMemory('{robot}', resolution={edge}, {known} voxels known)"))
    }
}

/// The module that writes and reads files.
fn files(py: Python<'_>) -> PyResult<Bound<'_, PyModule>> {
    py.import("contactsense.memory")
}

/// Defaults of what is free and what is occupied.
const FREE_BELOW: f64 = 0.1;
const OCCUPIED_FROM: f64 = 0.5;

/// A probability.
fn share(name: &str, object: &Bound<'_, PyAny>) -> PyResult<f64> {
    let value = number(name, object)?;
    if (0.0..=1.0).contains(&value) {
        return Ok(value);
    }
    Err(input(object.py(), format!("{name}: expected a probability from 0 to 1, got {value}")))
}

/// Where a contact may be.
fn places(contact: &Bound<'_, PyAny>) -> PyResult<Vec<PossiblePlace>> {
    if let Ok(estimate) = contact.cast::<PyContactEstimate>() {
        return Ok(estimate.get().modes_now().iter().map(PossiblePlace::of_mode).collect());
    }
    if let Ok(found) = contact.cast::<PyContact>() {
        let modes = found.get().modes_now();
        if !modes.is_empty() {
            return Ok(modes.iter().map(PossiblePlace::of_mode).collect());
        }
        return found.get().one_place().map(|place| vec![place]).ok_or_else(|| {
            input(
                contact.py(),
                "contact: its point cannot be determined; there is no place to remember".into(),
            )
        });
    }
    let expected = "a ContactEstimate, a Contact, or a tuple (point, normal, covariance)";
    type Parts<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>);
    let (point, normal, covariance) =
        contact.extract::<Parts<'_>>().map_err(|error| wrong("contact", expected, contact, error))?;
    place(&point, &normal, &covariance).map(|place| vec![place])
}

fn place(
    point: &Bound<'_, PyAny>,
    normal: &Bound<'_, PyAny>,
    covariance: &Bound<'_, PyAny>,
) -> PyResult<PossiblePlace> {
    let py = point.py();
    let point = Vector::new("point", point)?.fixed::<3>(py, "point")?;
    let normal = Vector::new("normal", normal)?.fixed::<3>(py, "normal")?;
    let covariance = rows::<3>("covariance", covariance)?;
    let covariance: [[f64; 3]; 3] =
        covariance.try_into().map_err(|_| input(py, "covariance: expected shape (3, 3)".into()))?;
    let covariance = Matrix3::from_fn(|i, k| covariance[i][k]);
    Ok(PossiblePlace { point: point.into(), normal: normal.into(), covariance, probability: 1.0 })
}
