//! The core's URDF reader: its checking pass for the package's loader, and a whole robot for comparison with it.

use std::path::PathBuf;
use std::sync::Arc;

use contactsense::load::{CheckedUrdf, MissingMeshes, UrdfGeometry, UrdfOptions};
use contactsense::robot::Robot;
use contactsense::surface::Geometry;
use nalgebra::Vector3;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::errors::{detached, input, to_python};
use crate::returned::from_rows;
use crate::robot::PyRobot;

fn options(
    py: Python<'_>,
    package_dirs: Vec<PathBuf>,
    floating_base: bool,
    geometry: &str,
    missing_meshes: &str,
) -> PyResult<UrdfOptions> {
    let geometry = match geometry {
        "collision" => UrdfGeometry::Collision,
        "visual" => UrdfGeometry::Visual,
        "collision_or_visual" => UrdfGeometry::CollisionOrVisual,
        other => {
            let text =
                format!("geometry: must be 'collision', 'visual' or 'collision_or_visual', not '{other}'");
            return Err(input(py, text));
        }
    };
    let missing_meshes = match missing_meshes {
        "error" => MissingMeshes::Error,
        "warn" => MissingMeshes::Warn,
        other => return Err(input(py, format!("missing_meshes: must be 'error' or 'warn', not '{other}'"))),
    };
    Ok(UrdfOptions { package_dirs, floating_base, geometry, missing_meshes, ..UrdfOptions::default() })
}

/// The link's name, the place of the shape among the link's, and the shape.
type StandingFor<'py> = (String, usize, Bound<'py, PyTuple>);

/// Text for Pinocchio, its shapes that stand for others, and warnings (`contactsense::load::CheckedUrdf`).
#[pyfunction]
pub fn _checked_urdf<'py>(
    py: Python<'py>,
    path: PathBuf,
    package_dirs: Vec<PathBuf>,
    floating_base: bool,
    geometry: &str,
    missing_meshes: &str,
) -> PyResult<(String, Vec<StandingFor<'py>>, Vec<String>)> {
    let options = options(py, package_dirs, floating_base, geometry, missing_meshes)?;
    let checked =
        detached(py, || CheckedUrdf::read(path, &options))?.map_err(|error| to_python(py, error))?;
    let mut shapes = vec![];
    for (link, place, geometry) in checked.shapes {
        let shape = match geometry {
            Geometry::Mesh { vertices, triangles } => {
                let triangles =
                    PyArray1::from_slice(py, triangles.as_flattened()).reshape([triangles.len(), 3])?;
                ("mesh", (from_rows(py, vertices.into_iter())?, triangles)).into_pyobject(py)?
            }
            Geometry::Capsule { radius, half_length } => {
                ("capsule", (radius, 2.0 * half_length)).into_pyobject(py)?
            }
            _ => continue,
        };
        shapes.push((link, place, shape));
    }
    Ok((checked.xml, shapes, checked.warnings))
}

/// A robot read without Pinocchio.
#[pyfunction]
#[pyo3(signature = (path, package_dirs=vec![], floating_base=false, locked=vec![], geometry="collision",
                    gravity=[0.0, 0.0, -9.81], armature=vec![], missing_meshes="error"))]
#[allow(clippy::too_many_arguments)] // those of `Robot.from_urdf`
pub fn _robot_from_urdf(
    py: Python<'_>,
    path: PathBuf,
    package_dirs: Vec<PathBuf>,
    floating_base: bool,
    locked: Vec<(String, f64)>,
    geometry: &str,
    gravity: [f64; 3],
    armature: Vec<(String, f64)>,
    missing_meshes: &str,
) -> PyResult<PyRobot> {
    let options = UrdfOptions {
        locked_joints: locked,
        gravity: Vector3::from(gravity),
        armature,
        ..options(py, package_dirs, floating_base, geometry, missing_meshes)?
    };
    let robot = detached(py, || Robot::from_urdf(path, &options))?;
    Ok(PyRobot(Arc::new(robot.map_err(|error| to_python(py, error))?)))
}
