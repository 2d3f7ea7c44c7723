//! Meshes from files.

use std::path::Path;

use nalgebra::Vector3;

use super::{collada, weld};
use crate::{Error, Result};

const KINDS: &str = "STL (binary or ASCII), OBJ and COLLADA (.stl, .obj, .dae)";
const STL_HEADER: usize = 80;
const STL_TRIANGLE: u64 = 50;

/// Vertices (m), and the triangles' indices into them.
pub type VerticesAndTriangles = (Vec<[f64; 3]>, Vec<[u32; 3]>);

type Soup = (Vec<Vector3<f64>>, Vec<[u32; 3]>);

/// Vertices (m) and triangles of a mesh file, scaled along each axis.
///
/// STL (binary or ASCII), OBJ (polygons become triangles) and COLLADA with its nodes' transforms and its unit. As
/// usual in ROS, COLLADA's up axis is ignored: z stays z. A scale that mirrors also turns the triangles, so that
/// normals stay outward. Vertices at exactly the same place are merged.
///
/// # Errors
/// [`Error::Geometry`] with the path if the file cannot be read, is cut short or malformed, has no triangles, or is
/// of another kind; also if the scale is zero or not finite.
pub fn load_mesh(path: &Path, scale: [f64; 3]) -> Result<VerticesAndTriangles> {
    if !scale.iter().all(|s| s.is_finite() && *s != 0.0) {
        let path = path.display();
        return Err(Error::Geometry(format!("{path}: scale is {scale:?}; it must be finite and not zero")));
    }
    let bad = |what: String| Error::Geometry(format!("{}: {what}; meshes can be {KINDS}", path.display()));
    let kind = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    if !["stl", "obj", "dae"].contains(&kind.as_str()) {
        return Err(bad(format!("unknown kind of mesh '.{kind}'")));
    }
    let bytes = std::fs::read(path).map_err(|error| bad(format!("cannot be read ({error})")))?;
    let (mut vertices, mut triangles) = match kind.as_str() {
        "stl" => stl(bytes),
        "obj" => obj(&bytes),
        _ => collada::parse(&String::from_utf8_lossy(&bytes)),
    }
    .map_err(bad)?;
    if triangles.is_empty() {
        return Err(bad("has no triangles".into()));
    }
    if triangles.iter().flatten().any(|&v| v as usize >= vertices.len()) {
        return Err(bad("has a triangle with an index out of range".into()));
    }
    if !vertices.iter().flatten().all(|x| x.is_finite()) {
        return Err(bad("has a vertex that is not finite".into()));
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

fn stl(mut bytes: Vec<u8>) -> std::result::Result<Soup, String> {
    let start: Vec<u8> = bytes.iter().copied().skip_while(u8::is_ascii_whitespace).take(5).collect();
    let announced =
        bytes.get(STL_HEADER..STL_HEADER + 4).map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]]));
    let binary_length = |n: u32| STL_HEADER as u64 + 4 + STL_TRIANGLE * u64::from(n);
    let length = bytes.len() as u64;
    // Some binary files begin as the others do: only the length tells.
    if start != b"solid" || announced.is_some_and(|n| binary_length(n) == length) {
        match announced {
            None => return Err("is cut short (no header)".into()),
            Some(n) if length < binary_length(n) => {
                return Err(format!("is cut short ({length} bytes for {n} triangles)"));
            }
            Some(_) => bytes[..STL_HEADER].fill(0),
        }
    } else if !String::from_utf8_lossy(&bytes).contains("endsolid") {
        return Err("is cut short (no 'endsolid')".into());
    }
    collect(|| mesh_loader::Loader::default().load_stl_from_slice(&bytes, "mesh.stl"))
}

fn obj(bytes: &[u8]) -> std::result::Result<Soup, String> {
    // Materials are not needed; without a reader no other file is opened.
    let loader = mesh_loader::Loader::default().custom_reader(|_| Ok(Vec::new()));
    collect(|| loader.load_obj_from_slice(bytes, "mesh.obj"))
}

fn collect(parse: impl FnOnce() -> std::io::Result<mesh_loader::Scene>) -> std::result::Result<Soup, String> {
    // The parser can panic on a malformed file where it should return an error.
    let scene = std::panic::catch_unwind(std::panic::AssertUnwindSafe(parse))
        .map_err(|_| "is malformed".to_string())?
        .map_err(|error| format!("cannot be parsed ({error})"))?;
    let mut soup: Soup = Default::default();
    for mesh in scene.meshes {
        let first = soup.0.len() as u32;
        soup.0.extend(mesh.vertices.iter().map(|v| Vector3::from(v.map(f64::from))));
        soup.1.extend(mesh.faces.iter().map(|t| t.map(|v| v + first)));
    }
    Ok(soup)
}
