//! The loaders' plain tuples as the core's description.

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

/// A `(3, 3)` matrix.
pub fn square(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Matrix3<f64>> {
    match rows::<3>(name, object)?.as_slice() {
        [a, b, c] => Ok(Matrix3::from_row_slice(&[*a, *b, *c].concat())),
        _ => Err(input(object.py(), format!("{name}: expected an array of shape (3, 3)"))),
    }
}

/// A rigid `(4, 4)` pose.
pub fn placement(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Pose> {
    let pose = match rows::<4>(name, object)?.as_slice() {
        [a, b, c, [0.0, 0.0, 0.0, 1.0]] => Pose {
            rotation: Matrix3::new(a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]),
            translation: Vector3::new(a[3], b[3], c[3]),
        },
        _ => {
            let text = format!("{name}: expected an array of shape (4, 4) with last row 0, 0, 0, 1");
            return Err(input(object.py(), text));
        }
    };
    pose.check_rigid().map_err(|why| input(object.py(), format!("{name}: {why}")))?;
    Ok(pose)
}

fn kind(py: Python<'_>, name: &str) -> PyResult<JointKind> {
    let kinds = [JointKind::FreeFlyer, JointKind::Revolute, JointKind::Continuous, JointKind::Prismatic];
    let found = kinds.into_iter().find(|kind| kind.name() == name);
    found.ok_or_else(|| input(py, format!("joints: unknown kind '{name}'")))
}

/// Numbers of a loader's array, which the core checks.
fn numbers<const N: usize>(name: &str, array: &Bound<'_, PyAny>) -> PyResult<[f64; N]> {
    Vector::new(name, &array.call_method0("ravel")?)?.fixed(array.py(), name)
}

fn pose(array: &Bound<'_, PyAny>) -> PyResult<Pose> {
    let [a, b, c, x, d, e, f, y, g, h, i, z, ..] = numbers::<16>("placement", array)?;
    Ok(Pose { rotation: Matrix3::new(a, b, c, d, e, f, g, h, i), translation: Vector3::new(x, y, z) })
}

fn joint(tuple: &Bound<'_, PyTuple>) -> PyResult<JointDescription> {
    let py = tuple.py();
    Ok(JointDescription {
        name: tuple.get_item(0)?.extract()?,
        parent: BodyIndex::new(tuple.get_item(1)?.extract()?),
        kind: kind(py, &tuple.get_item(2)?.extract::<String>()?)?,
        axis: numbers("axis", &tuple.get_item(3)?)?.into(),
        placement: pose(&tuple.get_item(4)?)?,
        mass: tuple.get_item(5)?.extract()?,
        com: numbers("com", &tuple.get_item(6)?)?.into(),
        inertia: Matrix3::from_row_slice(&numbers::<9>("inertia", &tuple.get_item(7)?)?),
        armature: tuple.get_item(8)?.extract()?,
        lower: limit(&tuple.get_item(9)?)?,
        upper: limit(&tuple.get_item(10)?)?,
        effort: limit(&tuple.get_item(11)?)?,
        velocity: limit(&tuple.get_item(12)?)?,
    })
}

/// None where it is infinite.
fn limit(value: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
    Ok(Some(value.extract::<f64>()?).filter(|value| !value.is_infinite()))
}

fn part(tuple: &Bound<'_, PyTuple>) -> PyResult<Part> {
    let py = tuple.py();
    let kind: String = tuple.get_item(0)?.extract()?;
    let sizes = tuple.get_item(1)?;
    let geometry = match kind.as_str() {
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
    Ok(Part { geometry, pose: pose(&tuple.get_item(2)?)? })
}

fn link(tuple: &Bound<'_, PyTuple>) -> PyResult<LinkDescription> {
    let mut geometry = vec![];
    for item in tuple.get_item(7)?.try_iter()? {
        geometry.push(part(item?.cast::<PyTuple>()?)?);
    }
    Ok(LinkDescription {
        name: tuple.get_item(0)?.extract()?,
        body: BodyIndex::new(tuple.get_item(1)?.extract()?),
        placement: pose(&tuple.get_item(2)?)?,
        parent: tuple.get_item(3)?.extract::<Option<usize>>()?.map(LinkIndex::new),
        mass: tuple.get_item(4)?.extract()?,
        com: numbers("com", &tuple.get_item(5)?)?.into(),
        inertia: Matrix3::from_row_slice(&numbers::<9>("inertia", &tuple.get_item(6)?)?),
        geometry,
    })
}

/// A description of the loaders' tuples (`contactsense.loading.description` says what they hold).
pub fn description(tuple: &Bound<'_, PyTuple>) -> PyResult<RobotDescription> {
    let (mut joints, mut links) = (vec![], vec![]);
    for item in tuple.get_item(1)?.try_iter()? {
        joints.push(joint(item?.cast::<PyTuple>()?)?);
    }
    for item in tuple.get_item(2)?.try_iter()? {
        links.push(link(item?.cast::<PyTuple>()?)?);
    }
    Ok(RobotDescription {
        name: tuple.get_item(0)?.extract()?,
        joints,
        links,
        gravity: numbers("gravity", &tuple.get_item(3)?)?.into(),
        warnings: tuple.get_item(4)?.extract()?,
    })
}
