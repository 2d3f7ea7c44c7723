//! Meshes from files.
//!
//! What a file says is never trusted: sizes are limited, indices looked up, sums checked, so that no file ends in a
//! panic, takes more than a few gigabytes, or for ever.

mod collada;
mod collada_mesh;
mod collada_reader;
mod obj;
mod polygon;
mod soup;
mod stl;

#[cfg(test)]
mod tests;

use std::path::Path;

use nalgebra::Vector3;

use super::mesh_file::soup::Soup;
use super::problem::Problem;
use super::regular_file;
use crate::surface::mesh::repair::weld;
use crate::{Error, Result};

const KINDS: &str = "STL (binary or ASCII), OBJ and COLLADA (.stl, .obj, .dae)";
/// Larger files are not read [bytes]: a binary STL of five million triangles.
const LARGEST_FILE: u64 = 1 << 28;

/// Vertices (m), and the triangles' indices into them.
pub type VerticesAndTriangles = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// Vertices (m) and triangles of a mesh file, scaled along each axis.
///
/// STL (binary or ASCII), OBJ and COLLADA with its nodes' transforms and its unit; polygons become triangles, concave
/// ones too. As usual in ROS, COLLADA's up axis is ignored: z stays z. A scale that mirrors also turns the triangles, so that
/// normals stay outward. Vertices at exactly the same place are merged.
///
/// # Errors
/// [`Error::Geometry`] with the path if the file cannot be read, is cut short or malformed, has no triangles, or is
/// of another kind; if it is no regular file, is larger than 256 MiB, or has more than five million triangles; also
/// if the scale is zero or not finite.
pub fn load_mesh(path: &Path, scale: [f64; 3]) -> Result<VerticesAndTriangles> {
    if !scale.iter().all(|s| s.is_finite() && *s != 0.0) {
        let text = format!("{}: scale is {scale:?}; it must be finite and not zero", path.display());
        return Err(Error::geometry(text).in_file(path));
    }
    let bad = |what: Problem| {
        let text = format!("{}: {what}; meshes can be {KINDS}", path.display());
        Error::geometry(text).in_file(path).because(what.cause)
    };
    let kind = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    if !["stl", "obj", "dae"].contains(&kind.as_str()) {
        return Err(bad(format!("unknown kind of mesh '.{kind}'").into()));
    }
    let bytes = regular_file::read(path, LARGEST_FILE).map_err(|Problem { text, cause }| {
        bad(Problem { text: format!("cannot be read ({text})"), cause })
    })?;
    let Soup { mut vertices, mut triangles } = match kind.as_str() {
        "stl" => stl::parse(&bytes).map_err(Problem::from),
        "obj" => obj::parse(&String::from_utf8_lossy(&bytes)).map_err(Problem::from),
        _ => collada::parse(&String::from_utf8_lossy(&bytes)),
    }
    .map_err(bad)?;
    if triangles.is_empty() {
        return Err(bad("has no triangles".into()));
    }
    let scale = Vector3::from(scale);
    vertices.iter_mut().for_each(|v| v.component_mul_assign(&scale));
    let (vertices, index) = weld::weld(&vertices, 0.0);
    let mirrored = scale.iter().filter(|s| **s < 0.0).count() % 2 == 1;
    for t in &mut triangles {
        *t = t.map(|v| index[v as usize]);
        if mirrored {
            t.swap(1, 2);
        }
    }
    Ok((vertices.into_iter().map(Into::into).collect(), triangles))
}
