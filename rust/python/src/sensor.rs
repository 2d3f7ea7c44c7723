//! `ForceTorqueSensor`.

use contactsense::robot::LARGEST;
use contactsense::sensor::{Convention, ForceTorqueSensor};
use contactsense::spatial::Pose;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyString, PyTuple};

use crate::arguments::{number_if_any, shown, text};
use crate::arrays::{rows, Vector};
use crate::description::placement;
use crate::errors::{input, refused};
use crate::pickle::{reduced, Reduced};
use crate::returned::{numbers, pose, read_only};

/// A six-axis force/torque sensor where `link` joins its parent: `link` and all behind it load the sensor.
///
/// A reading is (force, moment) about the sensor frame's origin, in its axes [N, Nm]. Frozen; equal where all arguments
/// are; can be pickled and copied.
///
/// Args:
///     name: Its name, unique among a robot's sensors.
///     link: Name of the link that it joins to the link's parent.
///     pose: The sensor frame in the link's, `(4, 4)` [m]; None for the link frame itself.
///     convention: "load": what the distal side exerts on the sensor (a free hand at rest: its weight); "support": the
///         opposite.
///     offset: What the sensor reads without load, `(6,)` [N, Nm], in its own axes and convention: subtracted from
///         readings before all else. None for zeros.
///
/// Raises:
///     InputError: Names the argument.
///
/// Example:
///     >>> import contactsense as cs
///     >>> sensor = cs.ForceTorqueSensor("wrist", "link_7", convention="support")
///     >>> sensor
///     ForceTorqueSensor('wrist', 'link_7', convention='support')
///     >>> sensor.pose.shape
///     (4, 4)
#[pyclass(frozen, eq, skip_from_py_object, name = "ForceTorqueSensor", module = "contactsense")]
#[derive(PartialEq, Clone)]
pub struct PyForceTorqueSensor(pub ForceTorqueSensor);

#[pymethods]
impl PyForceTorqueSensor {
    #[new]
    #[pyo3(signature = (name, link, *, pose=None, convention=None, offset=None),
           text_signature = "(name, link, *, pose=None, convention='load', offset=None)")]
    fn new(
        py: Python<'_>,
        name: &Bound<'_, PyAny>,
        link: &Bound<'_, PyAny>,
        pose: Option<&Bound<'_, PyAny>>,
        convention: Option<&Bound<'_, PyAny>>,
        offset: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let convention = match convention.map_or(Ok("load"), |convention| text("convention", convention))? {
            "load" => Convention::Load,
            "support" => Convention::Support,
            other => {
                return Err(input(py, format!("convention: must be 'load' or 'support', not '{other}'")));
            }
        };
        let pose = pose.map_or(Ok(Pose::identity()), |object| placement("pose", object))?;
        let offset = offset.map_or(Ok([0.0; 6]), |offset| wrench("offset", offset))?;
        let (name, link) = (text("name", name)?.into(), text("link", link)?.into());
        Ok(Self(ForceTorqueSensor { name, link, pose, convention, offset }))
    }

    /// Name of the sensor.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// Name of the link that it joins to the link's parent.
    #[getter]
    fn link(&self) -> &str {
        &self.0.link
    }

    /// The sensor frame in the link's, `(4, 4)` [m]; a read-only copy.
    #[getter]
    fn pose<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        Ok(read_only(pose(py, &self.0.pose)?))
    }

    /// What a reading means: "load" or "support".
    #[getter]
    fn convention(&self) -> &'static str {
        self.0.convention.name()
    }

    /// What the sensor reads without load, `(6,)` [N, Nm], in its own axes and convention; a read-only copy.
    #[getter]
    fn offset<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        numbers(py, &self.0.offset)
    }

    fn __hash__(&self) -> u64 {
        use std::hash::{DefaultHasher, Hash, Hasher};
        let mut hasher = DefaultHasher::new();
        (&self.0.name, &self.0.link, self.0.convention.name()).hash(&mut hasher);
        hasher.finish()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "ForceTorqueSensor", &self.0)
    }

    fn __repr__(&self) -> String {
        let Self(ForceTorqueSensor { name, link, convention, offset, .. }) = self;
        let offset = if *offset == [0.0; 6] { String::new() } else { format!(", offset={offset:?}") };
        format!("ForceTorqueSensor('{name}', '{link}', convention='{}'{offset})", convention.name())
    }
}

/// One force and moment of a size that can be computed with.
fn wrench(name: &str, object: &Bound<'_, PyAny>) -> PyResult<[f64; 6]> {
    let wrench = Vector::new(name, object)?.fixed::<6>(object.py(), name)?;
    if wrench.iter().all(|x| x.abs() < LARGEST) {
        return Ok(wrench);
    }
    Err(input(object.py(), format!("{name}: must be finite and below {LARGEST:e} [N, Nm]")))
}

/// The sensors of an iterable; a single one is no iterable of sensors.
pub fn sensors(object: &Bound<'_, PyAny>) -> PyResult<Vec<ForceTorqueSensor>> {
    let py = object.py();
    let refuse = |cause| refused(py, cause, || "sensors: expected an iterable of ForceTorqueSensor".into());
    let mut found = vec![];
    for item in object.try_iter().map_err(refuse)? {
        let item = item.map_err(refuse)?;
        found.push(item.cast::<PyForceTorqueSensor>().map_err(|error| refuse(error.into()))?.get().0.clone());
    }
    Ok(found)
}

/// The sensors as Python's.
pub fn sensor_tuple<'py>(py: Python<'py>, sensors: &[ForceTorqueSensor]) -> PyResult<Bound<'py, PyTuple>> {
    let wrap = |sensor: &ForceTorqueSensor| Bound::new(py, PyForceTorqueSensor(sensor.clone()));
    PyTuple::new(py, sensors.iter().map(wrap).collect::<PyResult<Vec<_>>>()?)
}

/// A scalar, or rows of six.
pub fn wrench_thresholds(object: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    match number_if_any(object)? {
        Some(number) => Ok(vec![number]),
        None => Ok(rows::<6>("wrench_threshold", object)?.concat()),
    }
}

pub fn sensor_names(object: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    names("wanted_contacts", "sensors", object)
}

/// Names of sensors, and links with points on them.
type WantedPlaces = (Vec<String>, Vec<(String, [f64; 3])>);

/// Where contacts are meant.
pub fn wanted_places(object: &Bound<'_, PyAny>) -> PyResult<WantedPlaces> {
    let py = object.py();
    let wanted = || {
        let text = "expected an iterable of the names of sensors and of pairs (link, point_local)";
        format!("wanted_contacts: {text}, got {}", shown(object))
    };
    let refuse = |cause| refused(py, cause, wanted);
    if object.is_instance_of::<PyString>() {
        return Err(input(py, wanted()));
    }
    let (mut names, mut points) = (vec![], vec![]);
    for item in object.try_iter().map_err(refuse)? {
        let item = item.map_err(refuse)?;
        if item.is_instance_of::<PyString>() {
            names.push(item.extract().map_err(refuse)?);
        } else {
            let (link, point): (String, Bound<'_, PyAny>) = item.extract().map_err(refuse)?;
            let point = Vector::new("wanted_contacts", &point)?.fixed::<3>(py, "wanted_contacts")?;
            points.push((link, point));
        }
    }
    Ok((names, points))
}

/// An iterable of strings, but no string itself: names of `what`.
pub fn names(argument: &str, what: &str, object: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    let py = object.py();
    let wanted = || format!("{argument}: expected an iterable of the names of {what}, got {}", shown(object));
    let refuse = |cause| refused(py, cause, wanted);
    if object.is_instance_of::<PyString>() {
        return Err(input(py, wanted()));
    }
    let mut names = vec![];
    for item in object.try_iter().map_err(refuse)? {
        names.push(item.map_err(refuse)?.extract().map_err(refuse)?);
    }
    Ok(names)
}
