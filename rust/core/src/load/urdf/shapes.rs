//! The shapes of a URDF link.

use urdf_rs::{Geometry as Shape, Link};

use super::build::pose;
use super::meshes::MeshFinder;
use super::options::UrdfGeometry;
use crate::error::Result;
use crate::load::load_mesh;
use crate::surface::{Geometry, Part};

/// Every shape of `link` in the given role; [`Error::Geometry`] names the link.
pub(super) fn parts(link: &Link, role: UrdfGeometry, meshes: &MeshFinder) -> Result<Vec<Part>> {
    let shapes: Vec<(&urdf_rs::Pose, &Shape)> = match role {
        UrdfGeometry::Collision => {
            link.collision.iter().map(|shape| (&shape.origin, &shape.geometry)).collect()
        }
        UrdfGeometry::Visual => link.visual.iter().map(|shape| (&shape.origin, &shape.geometry)).collect(),
    };
    let part =
        |(origin, shape)| Ok(Part { geometry: geometry(shape, &link.name, meshes)?, pose: pose(origin) });
    shapes.into_iter().map(part).collect()
}

fn geometry(shape: &Shape, link: &str, meshes: &MeshFinder) -> Result<Geometry> {
    Ok(match shape {
        Shape::Box { size } => Geometry::Box { half_extents: size.map(|x| 0.5 * x) },
        Shape::Cylinder { radius, length } => {
            Geometry::Cylinder { radius: *radius, half_length: 0.5 * length }
        }
        Shape::Capsule { radius, length } => Geometry::Capsule { radius: *radius, half_length: 0.5 * length },
        Shape::Sphere { radius } => Geometry::Sphere { radius: *radius },
        Shape::Mesh { filename, scale } => {
            let owner = format!("link '{link}'");
            let path = meshes.find(filename, link).map_err(|error| error.of(&owner))?;
            let (vertices, triangles) = load_mesh(&path, scale.map_or([1.0; 3], |scale| *scale))
                .map_err(|error| error.within(&owner))?;
            Geometry::Mesh { vertices, triangles }
        }
    })
}
