//! Python classes of contactsense: checks and converts, holds no algorithm.

#![allow(rustdoc::broken_intra_doc_links)] // units such as [m] look like links; docstrings show the text as it is

use pyo3::prelude::*;

mod arguments;
mod arrays;
mod columns;
mod compensator;
mod description;
mod errors;
mod estimate;
mod isolator;
mod monitor;
mod names;
mod noise;
mod observer;
mod particle;
mod plain;
mod returned;
mod robot;
mod sensor;
mod surface;
mod urdf;

/// An object of a class that was pickled, from its state.
#[pyfunction]
fn _restore<'py>(py: Python<'py>, class_: &str, state: &[u8]) -> PyResult<Bound<'py, PyAny>> {
    match class_ {
        "Candidate" | "Contact" | "Isolation" => isolator::restore(py, class_, state),
        "ContactReport" => monitor::restore(py, state),
        "Mode" | "ContactEstimate" => estimate::restore(py, class_, state),
        "NoiseModel" => Ok(Bound::new(py, noise::PyNoiseModel(plain::restored(state)?))?.into_any()),
        "ForceTorqueSensor" => {
            Ok(Bound::new(py, sensor::PyForceTorqueSensor(plain::restored(state)?))?.into_any())
        }
        other => Err(errors::input(py, format!("class: there is no '{other}' to restore"))),
    }
}

#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("build_profile", if cfg!(debug_assertions) { "debug" } else { "release" })?;
    errors::register(module)?;
    module.add_function(wrap_pyfunction!(urdf::_checked_urdf, module)?)?;
    module.add_function(wrap_pyfunction!(urdf::_robot_from_urdf, module)?)?;
    module.add_function(wrap_pyfunction!(_restore, module)?)?;
    module.add_class::<robot::PyRobot>()?;
    module.add_class::<surface::PySurface>()?;
    module.add_class::<surface::ClosestPoints>()?;
    module.add_class::<surface::RayHits>()?;
    module.add_class::<surface::SurfaceSamples>()?;
    module.add_class::<observer::PyMomentumObserver>()?;
    module.add_class::<sensor::PyForceTorqueSensor>()?;
    module.add_class::<compensator::PyLoadCompensator>()?;
    module.add_class::<noise::PyNoiseModel>()?;
    module.add_class::<isolator::PyContactIsolator>()?;
    module.add_class::<isolator::PyIsolation>()?;
    module.add_class::<isolator::PyContact>()?;
    module.add_class::<isolator::PyCandidate>()?;
    module.add_class::<monitor::PyContactMonitor>()?;
    module.add_class::<monitor::PyContactReport>()?;
    module.add_class::<particle::PyContactParticleFilter>()?;
    module.add_class::<particle::Particles>()?;
    module.add_class::<estimate::PyContactEstimate>()?;
    module.add_class::<estimate::PyMode>()?;
    Ok(())
}
