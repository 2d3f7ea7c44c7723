//! The core's own URDF reader, for comparison with the package's.

use std::path::PathBuf;
use std::sync::Arc;

use contactsense::load::{UrdfGeometry, UrdfOptions};
use contactsense::robot::Robot;
use nalgebra::Vector3;
use pyo3::prelude::*;

use crate::errors::{detached, input, to_python};
use crate::robot::PyRobot;

/// A robot read without Pinocchio; `locked` are pairs of a name and a position or `None`.
#[pyfunction]
#[pyo3(signature = (path, package_dirs=vec![], floating_base=false, locked=vec![], geometry="collision",
                    gravity=[0.0, 0.0, -9.81]))]
pub fn _robot_from_urdf(
    py: Python<'_>,
    path: PathBuf,
    package_dirs: Vec<PathBuf>,
    floating_base: bool,
    locked: Vec<(String, Option<f64>)>,
    geometry: &str,
    gravity: [f64; 3],
) -> PyResult<PyRobot> {
    let geometry = match geometry {
        "collision" => UrdfGeometry::Collision,
        "visual" => UrdfGeometry::Visual,
        other => {
            return Err(input(py, format!("geometry: must be 'collision' or 'visual', not '{other}'")));
        }
    };
    let options = UrdfOptions {
        package_dirs,
        floating_base,
        locked_joints: locked,
        geometry,
        gravity: Vector3::from(gravity),
    };
    let robot = detached(py, || Robot::from_urdf(path, &options))?;
    Ok(PyRobot(Arc::new(robot.map_err(|error| to_python(py, error))?)))
}
