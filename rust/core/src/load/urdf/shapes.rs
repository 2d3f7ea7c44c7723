//! The shapes of URDF links: which are used, and what they are.

use urdf_rs::Geometry as Shape;

use super::build::pose;
use super::element::check;
use super::meshes::MeshFinder;
use super::options::{UrdfGeometry, UrdfOptions};
use super::xml::Element;
use crate::error::{Error, Result};
use crate::load::load_mesh;
use crate::surface::{Geometry, Part};

pub(super) const ROLES: [&str; 2] = ["collision", "visual"];
const SHAPES: &str = "mesh, box, cylinder, sphere, capsule";

/// Whether an element of a link holds a shape.
pub(super) fn is_shape(element: &Element) -> bool {
    ROLES.contains(&element.tag.as_str())
}

/// Keeps of each link the shapes that make its surface, with the paths of their mesh files.
pub(super) fn choose_shapes(
    elements: &mut [Element],
    options: &UrdfOptions,
    meshes: &mut MeshFinder,
    warnings: &mut Vec<String>,
) -> Result<()> {
    let mut visual_only = 0;
    let mut count = 0;
    for link in elements.iter_mut().filter(|element| element.tag == "link") {
        let has_collision = link.child("collision").is_some();
        visual_only += usize::from(link.child("visual").is_some() && !has_collision);
        let role = match options.geometry {
            UrdfGeometry::Visual => "visual",
            UrdfGeometry::CollisionOrVisual if !has_collision => "visual",
            _ => "collision",
        };
        let owner = link.owner();
        let mut kept = vec![];
        for mut child in std::mem::take(&mut link.children) {
            let keeps = match child.tag.as_str() {
                tag if tag == role => use_shape(&mut child, &owner, options, meshes, warnings),
                tag => Ok(!ROLES.contains(&tag)),
            };
            if keeps.map_err(|error| error.of(&owner))? {
                count += usize::from(is_shape(&child));
                kept.push(child);
            }
        }
        kept.iter_mut().filter(|child| is_shape(child)).for_each(|child| child.tag = "collision".into());
        link.children = kept;
    }
    if count == 0 {
        let tag = if options.geometry == UrdfGeometry::Visual { "visual" } else { "collision" };
        let instead = if visual_only > 0 && options.geometry == UrdfGeometry::Collision {
            format!("; geometry=\"visual\" takes the <visual> shapes that {visual_only} links have")
        } else {
            String::new()
        };
        warnings.push(format!(
            "No link has <{tag}> geometry, so the robot has no surface to be touched{instead}"
        ));
    }
    Ok(())
}

/// Whether a shape is used; [`Error::Geometry`] where it cannot be, a warning where it is left out.
fn use_shape(
    element: &mut Element,
    owner: &str,
    options: &UrdfOptions,
    meshes: &mut MeshFinder,
    warnings: &mut Vec<String>,
) -> Result<bool> {
    let place = format!("{owner}: <{}>", element.tag);
    let one = || format!("{place} needs one <geometry> with one of {SHAPES}");
    if element.child("geometry").is_none_or(|geometry| geometry.children.len() != 1) {
        return Err(Error::geometry(one()));
    }
    if element.child("geometry").is_some_and(|geometry| geometry.child("plane").is_some()) {
        warnings.push(format!("{place} is an endless <plane> and was left out"));
        return Ok(false);
    }
    check(element, &place, Error::geometry)?;
    let geometry = element.children.iter_mut().find(|child| child.tag == "geometry");
    let Some(shape) = geometry.and_then(|geometry| geometry.children.first_mut()) else {
        return Err(Error::geometry(one()));
    };
    let tag = shape.tag.clone();
    let keys: &[&str] = match tag.as_str() {
        "mesh" => {
            let filename = shape.attribute("filename").trim().to_owned();
            if filename.is_empty() {
                return Err(Error::geometry(format!("{place}: <mesh> needs the attribute 'filename'")));
            }
            if shape.numbers("scale").contains(&0.0) {
                return Err(Error::geometry(format!("{place}: 'scale' of <mesh> must not be zero")));
            }
            let mesh = format!("{owner}: mesh '{filename}'");
            let found = meshes.find(&filename, &mesh, options.missing_meshes, warnings)?;
            let path = found.as_ref().map(|path| path.to_string_lossy());
            shape.attributes.retain(|(name, _)| name != "filename");
            shape.attributes.push(("filename".into(), path.unwrap_or_default().into_owned()));
            return Ok(found.is_some());
        }
        "box" => &["size"],
        "sphere" => &["radius"],
        "cylinder" | "capsule" => &["radius", "length"],
        _ => {
            let text = format!("{place} has the unknown shape <{tag}>; supported: {SHAPES}");
            return Err(Error::geometry(text));
        }
    };
    if let Some(missing) = keys.iter().find(|key| shape.numbers(key).is_empty()) {
        return Err(Error::geometry(format!("{place}: <{tag}> needs the attribute '{missing}'")));
    }
    let sizes: Vec<f64> = keys.iter().flat_map(|key| shape.numbers(key)).collect();
    if sizes.iter().any(|size| *size < 0.0) {
        let text = format!("{place}: the sizes of <{tag}> must be positive, not {sizes:?}");
        return Err(Error::geometry(text));
    }
    if sizes.contains(&0.0) {
        warnings.push(format!("{place} is a <{tag}> of size zero and was left out"));
        return Ok(false);
    }
    Ok(true)
}

/// A link's shapes as parts of its surface; reads the mesh files.
pub(super) fn parts(link: &urdf_rs::Link) -> Result<Vec<Part>> {
    let part = |shape: &urdf_rs::Collision| {
        let geometry = match &shape.geometry {
            Shape::Box { size } => Geometry::Box { half_extents: size.map(|x| 0.5 * x) },
            Shape::Cylinder { radius, length } => {
                Geometry::Cylinder { radius: *radius, half_length: 0.5 * length }
            }
            Shape::Capsule { radius, length } => {
                Geometry::Capsule { radius: *radius, half_length: 0.5 * length }
            }
            Shape::Sphere { radius } => Geometry::Sphere { radius: *radius },
            Shape::Mesh { filename, scale } => {
                let (vertices, triangles) =
                    load_mesh(filename.as_ref(), scale.map_or([1.0; 3], |scale| *scale))
                        .map_err(|error| error.within(&format!("link '{}'", link.name)))?;
                Geometry::Mesh { vertices, triangles }
            }
        };
        Ok(Part { geometry, pose: pose(&shape.origin) })
    };
    link.collision.iter().map(part).collect()
}
