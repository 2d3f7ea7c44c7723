//! Pickling, copying and plain dicts of what is frozen.
//!
//! What the core holds is written as MessagePack, which keeps every bit of a number. It is read only by the version that
//! wrote it: fields may differ in another.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList, PyTuple};
use serde::de::DeserializeOwned;
use serde::Serialize;

use crate::calibration::PyCalibration;
use crate::calibration_parts::{PyBodyInertia, PyJointFriction, PyPayload};
use crate::candidate::PyCandidate;
use crate::contact::PyContact;
use crate::contact_map::PyMapEstimate;
use crate::diagnosis::PyFinding;
use crate::errors::{input, refused};
use crate::estimate::{PyContactEstimate, PyMode};
use crate::identifiability::PyIdentifiability;
use crate::isolation::PyIsolation;
use crate::monitor_payload::PyPayloadProposal;
use crate::motion::PyMotion;
use crate::noise::PyNoiseModel;
use crate::particle::Particles;
use crate::report::PyContactReport;
use crate::sensor::PyForceTorqueSensor;
use crate::surface::{ClosestPoints, RayHits, SurfaceSamples};
use crate::tool_load::PyToolLoad;

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// What `__reduce__` gives: the function that restores, and its arguments.
pub type Reduced<'py> = (Bound<'py, PyAny>, Bound<'py, PyTuple>);

fn restore(py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
    py.import("contactsense._core")?.getattr("_restore")
}

/// For an object of a class that is restored from what the core holds.
pub fn reduced<'py>(py: Python<'py>, kind: &str, content: &impl Serialize) -> PyResult<Reduced<'py>> {
    let bytes = rmp_serde::to_vec(content).map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    Ok((restore(py)?, (kind, VERSION, PyBytes::new(py, &bytes)).into_pyobject(py)?))
}

/// For an object that is nothing but its arrays.
pub fn reduced_arrays<'py>(
    py: Python<'py>,
    kind: &str,
    arrays: Bound<'py, PyTuple>,
) -> PyResult<Reduced<'py>> {
    Ok((restore(py)?, (kind, VERSION, arrays).into_pyobject(py)?))
}

/// Restores what `pickle` or `copy` has taken apart.
#[pyfunction]
pub fn _restore<'py>(
    py: Python<'py>,
    kind: &str,
    version: &str,
    content: &Bound<'py, PyAny>,
) -> PyResult<Py<PyAny>> {
    if version != VERSION {
        return Err(input(
            py,
            format!("pickle: made by contactsense {version}, and this is {VERSION}; make it anew with this version"),
        ));
    }
    match kind {
        "Candidate" => made(py, PyCandidate::from_content(read(content)?)),
        "Contact" => made(py, PyContact::from_content(read(content)?)),
        "Isolation" => made(py, PyIsolation::from_content(read(content)?)),
        "ContactReport" => made(py, PyContactReport::from_content(read(content)?)),
        "ContactEstimate" => made(py, PyContactEstimate::from_content(read(content)?)),
        "MapEstimate" => Ok(Py::new(py, PyMapEstimate::with_base(read(content)?))?.into_any()),
        "Identifiability" => made(py, PyIdentifiability::from_content(read(content)?)),
        "Mode" => made(py, PyMode::from_content(read(content)?)),
        "Calibration" => made(py, PyCalibration(read(content)?)),
        "JointFriction" => made(py, PyJointFriction::from_content(read(content)?)),
        "BodyInertia" => made(py, PyBodyInertia(read(content)?)),
        "Payload" => made(py, PyPayload(read(content)?)),
        "Motion" => made(py, PyMotion::new(py, read(content)?)?),
        "Finding" => made(py, PyFinding(read(content)?)),
        "NoiseModel" => made(py, PyNoiseModel(read(content)?)),
        "ForceTorqueSensor" => made(py, PyForceTorqueSensor(read(content)?)),
        "ToolLoad" => made(py, PyToolLoad(read(content)?)),
        "PayloadProposal" => made(py, PyPayloadProposal(read(content)?)),
        "ClosestPoints" => made(py, ClosestPoints::from_arrays(content)?),
        "RayHits" => made(py, RayHits::from_arrays(content)?),
        "SurfaceSamples" => made(py, SurfaceSamples::from_arrays(content)?),
        "Particles" => made(py, Particles::from_arrays(content)?),
        other => Err(input(py, format!("pickle: there is no class '{other}' to restore"))),
    }
}

fn made<T: pyo3::PyClass + Into<PyClassInitializer<T>>>(py: Python<'_>, object: T) -> PyResult<Py<PyAny>> {
    Ok(Py::new(py, object)?.into_any())
}

fn read<T: DeserializeOwned>(content: &Bound<'_, PyAny>) -> PyResult<T> {
    let py = content.py();
    let damaged = || "pickle: the content is damaged".to_string();
    let bytes = content.cast::<PyBytes>().map_err(|error| refused(py, error.into(), damaged))?;
    rmp_serde::from_slice(bytes.as_bytes()).map_err(|error| input(py, format!("{}: {error}", damaged())))
}

/// The attributes of an object as a dict of plain values: lists in place of arrays and tuples, dicts in place of results.
pub fn plain_dict<'py>(object: &Bound<'py, PyAny>, attributes: &[&str]) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(object.py());
    for name in attributes {
        dict.set_item(name, plain(&object.getattr(*name)?)?)?;
    }
    Ok(dict)
}

fn plain<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    if let Ok(tuple) = value.cast::<PyTuple>() {
        let items: Vec<_> = tuple.iter().map(|item| plain(&item)).collect::<PyResult<_>>()?;
        return Ok(PyList::new(value.py(), items)?.into_any());
    }
    if let Ok(dict) = value.cast::<PyDict>() {
        let copy = PyDict::new(value.py());
        for (key, item) in dict {
            copy.set_item(key, plain(&item)?)?;
        }
        return Ok(copy.into_any());
    }
    for method in ["to_dict", "tolist"] {
        if value.hasattr(method)? {
            return value.call_method0(method);
        }
    }
    Ok(value.clone())
}

/// `__reduce__` and `__repr__` of a class that is nothing but its arrays, and its making from them.
macro_rules! arrays_alone {
    ($class:ident, $name:literal, $first:ident $(, $field:ident)*) => {
        #[pymethods]
        impl $class {
            fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<crate::pickle::Reduced<'py>> {
                let arrays = (self.$first.clone_ref(py), $(self.$field.clone_ref(py)),*).into_pyobject(py)?;
                crate::pickle::reduced_arrays(py, $name, arrays)
            }

            fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
                Ok(format!("{}({} rows)", $name, self.$first.bind(py).len()?))
            }
        }

        impl $class {
            pub fn from_arrays(content: &Bound<'_, PyAny>) -> PyResult<Self> {
                let py = content.py();
                let ($first, $($field),*) = content.extract()?;
                let array = read_only(Py::into_bound($first, py)).unbind();
                Ok(Self { $first: array, $($field: read_only(Py::into_bound($field, py)).unbind()),* })
            }
        }
    };
}
pub(crate) use arrays_alone;
