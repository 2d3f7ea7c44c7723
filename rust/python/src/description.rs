//! The loaders' plain tuples as the core's description.

use std::path::PathBuf;

use contactsense::load::load_mesh;
use contactsense::robot::{
    BodyIndex, JointDescription, JointKind, LinkDescription, LinkIndex, RobotDescription,
};
use contactsense::spatial::Pose;
use contactsense::surface::{Geometry, Part};
use contactsense::Error;
use nalgebra::{Matrix3, Vector3};
use numpy::{PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays::{rows, Vector};
use crate::errors::{input, to_python};

struct MeshFile {
    path: PathBuf,
    scale: [f64; 3],
}

/// A description whose mesh files are not read yet.
pub struct Draft {
    description: RobotDescription,
    /// Of each part of each link.
    files: Vec<Vec<Option<MeshFile>>>,
}

impl Draft {
    /// Reads the mesh files; needs no Python.
    pub fn load(mut self) -> contactsense::Result<RobotDescription> {
        for (link, files) in self.description.links.iter_mut().zip(self.files) {
            for (part, file) in link.geometry.iter_mut().zip(files) {
                let Some(MeshFile { path, scale }) = file else { continue };
                let (vertices, triangles) = load_mesh(&path, scale)
                    .map_err(|error| error.within(&format!("link '{}'", link.name)))?;
                part.geometry = Geometry::Mesh { vertices, triangles };
            }
        }
        Ok(self.description)
    }
}

fn vector(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Vector3<f64>> {
    Ok(Vector3::from(Vector::new(name, object)?.fixed::<3>(object.py(), name)?))
}

fn square(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Matrix3<f64>> {
    match rows::<3>(name, object)?.as_slice() {
        [a, b, c] => Ok(Matrix3::from_row_slice(&[*a, *b, *c].concat())),
        _ => Err(input(object.py(), format!("{name}: expected an array of shape (3, 3)"))),
    }
}

/// A `(4, 4)` pose.
pub fn placement(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Pose> {
    match rows::<4>(name, object)?.as_slice() {
        [a, b, c, _] => Ok(Pose {
            rotation: Matrix3::new(a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]),
            translation: Vector3::new(a[3], b[3], c[3]),
        }),
        _ => Err(input(object.py(), format!("{name}: expected an array of shape (4, 4)"))),
    }
}

fn kind(py: Python<'_>, name: &str) -> PyResult<JointKind> {
    let kinds = [JointKind::FreeFlyer, JointKind::Revolute, JointKind::Continuous, JointKind::Prismatic];
    let found = kinds.into_iter().find(|kind| kind.name() == name);
    found.ok_or_else(|| input(py, format!("joints: unknown kind '{name}'")))
}

fn joint(tuple: &Bound<'_, PyTuple>) -> PyResult<JointDescription> {
    let py = tuple.py();
    Ok(JointDescription {
        name: tuple.get_item(0)?.extract()?,
        parent: BodyIndex::new(tuple.get_item(1)?.extract()?),
        kind: kind(py, &tuple.get_item(2)?.extract::<String>()?)?,
        axis: vector("axis", &tuple.get_item(3)?)?,
        placement: placement("placement", &tuple.get_item(4)?)?,
        mass: tuple.get_item(5)?.extract()?,
        com: vector("com", &tuple.get_item(6)?)?,
        inertia: square("inertia", &tuple.get_item(7)?)?,
        armature: tuple.get_item(8)?.extract()?,
    })
}

fn part(tuple: &Bound<'_, PyTuple>) -> PyResult<(Part, Option<MeshFile>)> {
    let py = tuple.py();
    let mut file = None;
    let kind: String = tuple.get_item(0)?.extract()?;
    let sizes = tuple.get_item(1)?;
    let geometry = match kind.as_str() {
        "mesh_file" => {
            let (path, scale): (PathBuf, [f64; 3]) = sizes.extract()?;
            file = Some(MeshFile { path, scale });
            // Filled in by `Draft::load`.
            Geometry::Mesh { vertices: vec![], triangles: vec![] }
        }
        "mesh" => {
            let vertices = rows::<3>("vertices", &sizes.get_item(0)?)?;
            let triangles = sizes.get_item(1)?;
            let triangles = triangles.cast::<PyArray2<u32>>()?.readonly();
            let slice = triangles.as_slice()?;
            Geometry::Mesh {
                vertices,
                triangles: slice.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
            }
        }
        "box" => {
            let size: [f64; 3] = sizes.extract()?;
            Geometry::Box { half_extents: size.map(|x| 0.5 * x) }
        }
        "cylinder" => {
            let (radius, length): (f64, f64) = sizes.extract()?;
            Geometry::Cylinder { radius, half_length: 0.5 * length }
        }
        "capsule" => {
            let (radius, length): (f64, f64) = sizes.extract()?;
            Geometry::Capsule { radius, half_length: 0.5 * length }
        }
        "sphere" => {
            let (radius,): (f64,) = sizes.extract()?;
            Geometry::Sphere { radius }
        }
        other => return Err(to_python(py, Error::geometry(format!("unknown geometry kind '{other}'")))),
    };
    Ok((Part { geometry, pose: placement("placement", &tuple.get_item(2)?)? }, file))
}

fn link(tuple: &Bound<'_, PyTuple>) -> PyResult<(LinkDescription, Vec<Option<MeshFile>>)> {
    let name: String = tuple.get_item(0)?.extract()?;
    let (mut geometry, mut files) = (vec![], vec![]);
    for item in tuple.get_item(7)?.try_iter()? {
        let (part, file) = part(item?.cast::<PyTuple>()?)?;
        geometry.push(part);
        files.push(file);
    }
    let link = LinkDescription {
        body: BodyIndex::new(tuple.get_item(1)?.extract()?),
        placement: placement("placement", &tuple.get_item(2)?)?,
        parent: tuple.get_item(3)?.extract::<Option<usize>>()?.map(LinkIndex::new),
        mass: tuple.get_item(4)?.extract()?,
        com: vector("com", &tuple.get_item(5)?)?,
        inertia: square("inertia", &tuple.get_item(6)?)?,
        geometry,
        name,
    };
    Ok((link, files))
}

/// A description of the loaders' tuples (`contactsense.loading.description` says what they hold).
pub fn description(
    name: String,
    joints: &Bound<'_, PyAny>,
    links: &Bound<'_, PyAny>,
    gravity: &Bound<'_, PyAny>,
    warnings: Vec<String>,
) -> PyResult<Draft> {
    let mut files = vec![];
    let mut description = RobotDescription {
        name,
        joints: vec![],
        links: vec![],
        gravity: vector("gravity", gravity)?,
        warnings,
    };
    for item in joints.try_iter()? {
        description.joints.push(joint(item?.cast::<PyTuple>()?)?);
    }
    for item in links.try_iter()? {
        let (link, of_parts) = link(item?.cast::<PyTuple>()?)?;
        description.links.push(link);
        files.push(of_parts);
    }
    Ok(Draft { description, files })
}
