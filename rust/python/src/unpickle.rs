//! Restores what `pickle` or `copy` has taken apart.

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde::de::DeserializeOwned;

use crate::calibration::PyCalibration;
use crate::calibration_parts::{PyBodyInertia, PyJointFriction, PyPayload};
use crate::candidate::PyCandidate;
use crate::classification::PyContactClass;
use crate::contact::PyContact;
use crate::contact_map::PyMapEstimate;
use crate::diagnosis::PyFinding;
use crate::errors::{input, refused};
use crate::estimate::{PyContactEstimate, PyMode};
use crate::identifiability::PyIdentifiability;
use crate::isolation::PyIsolation;
use crate::monitor_payload::PyPayloadProposal;
use crate::motion::PyMotion;
use crate::next_motion::PyNextMotion;
use crate::noise::PyNoiseModel;
use crate::particles::Particles;
use crate::pickle::VERSION;
use crate::report::PyContactReport;
use crate::sensor::PyForceTorqueSensor;
use crate::surface::{ClosestPoints, RayHits, SurfaceSamples};
use crate::tool_load::PyToolLoad;

/// The object of a class, from what `__reduce__` gave.
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
        "ContactClass" => made(py, PyContactClass(read(content)?)),
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
        "NextMotion" => Ok(Py::new(py, PyNextMotion::with_base(py, read(content)?)?)?.into_any()),
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
