//! Meshes from files.

use std::path::Path;

use nalgebra::Vector3;

use super::weld;
use crate::{Error, Result};

const KINDS: &str = "STL (binary or ASCII), OBJ and COLLADA (.stl, .obj, .dae)";

/// Vertices [m] and triangles of a mesh file, scaled along each axis.
///
/// STL (binary or ASCII), OBJ (polygons become triangles) and COLLADA with its nodes' transforms and its unit. As
/// usual in ROS, COLLADA's up axis is ignored: z stays z. A scale that mirrors also turns the triangles, so that
/// normals stay outward. Vertices at exactly the same place are merged.
///
/// # Errors
/// [`Error::Geometry`] with the path if the file cannot be read, is cut short or malformed, has no triangles, or is
/// of another kind; also if the scale is zero or not finite.
pub fn load_mesh(path: &Path, scale: [f64; 3]) -> Result<(Vec<[f64; 3]>, Vec<[u32; 3]>)> {
    if !scale.iter().all(|s| s.is_finite() && *s != 0.0) {
        return Err(Error::Geometry(format!(
            "{}: scale is {scale:?}; it must be finite and not zero",
            path.display()
        )));
    }
    let bad = |what: String| Error::Geometry(format!("{}: {what}; meshes can be {KINDS}", path.display()));
    let kind = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    if !["stl", "obj", "dae"].contains(&kind.as_str()) {
        return Err(bad(format!("unknown kind of mesh '.{kind}'")));
    }
    let bytes = std::fs::read(path).map_err(|error| bad(format!("cannot be read ({error})")))?;
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for mesh in parse(&kind, &bytes, path).map_err(bad)? {
        let first = vertices.len() as u32;
        vertices.extend(
            mesh.vertices.iter().map(|v| Vector3::from([0, 1, 2].map(|k| f64::from(v[k]) * scale[k]))),
        );
        triangles.extend(mesh.faces.iter().map(|t| t.map(|v| v + first)));
    }
    if triangles.is_empty() {
        return Err(bad("has no triangles".into()));
    }
    if triangles.iter().flatten().any(|&v| v as usize >= vertices.len()) {
        return Err(bad("has a triangle with an index out of range".into()));
    }
    let (vertices, index) = weld::weld(&vertices, 0.0);
    let mirrored = scale.iter().product::<f64>() < 0.0;
    for t in &mut triangles {
        *t = t.map(|v| index[v as usize]);
        if mirrored {
            t.swap(1, 2);
        }
    }
    Ok((vertices.into_iter().map(Into::into).collect(), triangles))
}

fn parse(kind: &str, bytes: &[u8], path: &Path) -> std::result::Result<Vec<mesh_loader::Mesh>, String> {
    if kind == "stl" {
        check_stl_length(bytes)?;
    }
    let path = path.to_owned();
    let loader = mesh_loader::Loader::default().custom_reader(|_| Ok(Vec::new()));
    // The parser panics on some malformed files instead of returning an error.
    let scene = std::panic::catch_unwind(|| match kind {
        "stl" => loader.load_stl_from_slice(bytes, &path),
        "obj" => loader.load_obj_from_slice(bytes, &path),
        _ => loader.load_collada_from_slice(bytes, &path),
    });
    match scene {
        Ok(Ok(scene)) => Ok(scene.meshes),
        Ok(Err(error)) => Err(format!("cannot be parsed ({error})")),
        Err(_) => Err("is malformed".into()),
    }
}

/// A binary STL file says how many triangles it has.
fn check_stl_length(bytes: &[u8]) -> std::result::Result<(), String> {
    let start: Vec<u8> = bytes.iter().copied().skip_while(u8::is_ascii_whitespace).take(5).collect();
    if start == b"solid" {
        let text = String::from_utf8_lossy(bytes);
        if text.contains("facet") && !text.contains("endsolid") {
            return Err("is cut short (no 'endsolid')".into());
        }
        return Ok(());
    }
    let count = bytes.get(80..84).map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]]));
    match count {
        None => Err("is cut short (no header)".into()),
        Some(n) if (bytes.len() as u64) < 84 + 50 * u64::from(n) => {
            Err(format!("is cut short ({} bytes for {n} triangles)", bytes.len()))
        }
        Some(_) => Ok(()),
    }
}
