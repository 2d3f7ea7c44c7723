//! Python classes of contactsense: checks and converts, holds no algorithm.

#![allow(rustdoc::broken_intra_doc_links)] // units such as [m] look like links; docstrings show the text as it is

use pyo3::prelude::*;

mod arguments;
mod arrays;
mod by_name;
mod calibration;
mod calibration_parts;
mod candidate;
mod classification;
mod columns;
mod compensator;
mod cone;
mod contact;
mod contact_map;
mod description;
mod diagnosis;
mod errors;
mod estimate;
mod filter_options;
mod identifiability;
mod isolation;
mod isolator;
mod memory;
mod monitor;
mod monitor_external;
mod monitor_payload;
mod monitor_rows;
mod monitor_tare;
mod motion;
mod names;
mod next_motion;
mod noise;
mod observer;
mod once;
mod particle;
mod particles;
mod pickle;
mod reaction;
mod report;
mod returned;
mod robot;
mod robot_argument;
mod robot_mechanics;
mod robot_vectors;
mod sampler;
mod search_arguments;
mod sensor;
mod signals;
mod surface;
mod tool_load;
mod unpickle;
mod urdf;

// Arguments are copied out of NumPy arrays that another thread may write to; only the GIL keeps the two apart.
#[pymodule(gil_used = true)]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("build_profile", if cfg!(debug_assertions) { "debug" } else { "release" })?;
    module.add("_LINK_PREFIX", contactsense::load::CheckedUrdf::LINK_PREFIX)?;
    errors::register(module)?;
    module.add_function(wrap_pyfunction!(urdf::_checked_urdf, module)?)?;
    module.add_function(wrap_pyfunction!(urdf::_robot_from_urdf, module)?)?;
    module.add_function(wrap_pyfunction!(unpickle::_restore, module)?)?;
    module.add_function(wrap_pyfunction!(cone::_best_cone_forces, module)?)?;
    module.add_function(wrap_pyfunction!(diagnosis::diagnose, module)?)?;
    module.add_class::<robot::PyRobot>()?;
    module.add_class::<surface::PySurface>()?;
    module.add_class::<surface::ClosestPoints>()?;
    module.add_class::<surface::RayHits>()?;
    module.add_class::<surface::SurfaceSamples>()?;
    module.add_class::<observer::PyMomentumObserver>()?;
    module.add_class::<sensor::PyForceTorqueSensor>()?;
    module.add_class::<compensator::PyLoadCompensator>()?;
    module.add_class::<tool_load::PyToolLoad>()?;
    module.add_class::<monitor_payload::PyPayloadProposal>()?;
    module.add_function(wrap_pyfunction!(tool_load::identify_tool, module)?)?;
    module.add_class::<noise::PyNoiseModel>()?;
    module.add_function(wrap_pyfunction!(calibration::_calibrate, module)?)?;
    module.add_class::<calibration::PyCalibration>()?;
    module.add_class::<calibration_parts::PyJointFriction>()?;
    module.add_class::<calibration_parts::PyBodyInertia>()?;
    module.add_class::<calibration_parts::PyPayload>()?;
    module.add_function(wrap_pyfunction!(motion::exciting_motion, module)?)?;
    module.add_class::<motion::PyMotion>()?;
    module.add_function(wrap_pyfunction!(next_motion::next_motion, module)?)?;
    module.add_class::<next_motion::PyNextMotion>()?;
    module.add_class::<memory::PyContactMemory>()?;
    module.add_class::<diagnosis::PyFinding>()?;
    module.add_class::<isolator::PyContactIsolator>()?;
    module.add_class::<isolation::PyIsolation>()?;
    module.add_class::<contact::PyContact>()?;
    module.add_class::<candidate::PyCandidate>()?;
    module.add_class::<monitor::PyContactMonitor>()?;
    module.add_class::<report::PyContactReport>()?;
    module.add_class::<classification::PyContactClassifier>()?;
    module.add_class::<classification::PyContactClass>()?;
    module.add_class::<reaction::PyReaction>()?;
    module.add_class::<particle::PyContactParticleFilter>()?;
    module.add_class::<particles::Particles>()?;
    module.add_class::<sampler::PyStaticObstacleSampler>()?;
    module.add_class::<estimate::PyContactEstimate>()?;
    module.add_class::<estimate::PyMode>()?;
    module.add_class::<contact_map::PyContactMap>()?;
    module.add_class::<contact_map::PyMapEstimate>()?;
    module.add_class::<identifiability::PyIdentifiability>()?;
    Ok(())
}
