//! From parts to a surface.

use nalgebra::Vector3;

use super::mesh::Mesh;
use super::part::{self, Geometry, Part, Solid};
use super::primitive::Placed;
use super::sample::Sampler;
use super::Surface;
use crate::{Error, Result};

impl Surface {
    /// Makes the surface of the given parts, and says in sentences what was odd about them and what was done.
    ///
    /// Meshes are repaired: duplicate vertices merged, degenerate and duplicate triangles removed, winding made
    /// consistent and outward.
    ///
    /// # Errors
    /// [`Error::Geometry`] if there are no parts, a number is not finite, a size is not
    /// positive, a mesh is empty, has an index out of range, or has nothing left after the repair.
    pub fn new(parts: Vec<Part>) -> Result<(Surface, Vec<String>)> {
        if parts.is_empty() {
            return Err(Error::geometry("a surface needs at least one part"));
        }
        let several = parts.len() > 1;
        let mut remarks = Vec::new();
        let mut solids = Vec::with_capacity(parts.len());
        let mut vertices: Vec<Vector3<f64>> = Vec::new();
        let mut triangles: Vec<[u32; 3]> = Vec::new();
        for (index, part) in parts.into_iter().enumerate() {
            let mut own = Vec::new();
            let solid = solid(part, triangles.len(), &mut own).map_err(|error| {
                if several {
                    error.within(&format!("part {index}"))
                } else {
                    error
                }
            })?;
            remarks.extend(own.into_iter().map(
                |what| {
                    if several {
                        format!("part {index}: {what}")
                    } else {
                        what
                    }
                },
            ));
            let (own_vertices, own_triangles) = match &solid {
                Solid::Mesh { mesh, .. } => (mesh.vertices.clone(), mesh.triangles.clone()),
                Solid::Exact(placed) => placed.tessellate(),
            };
            let first = vertices.len();
            for (what, count) in [
                ("vertices", first + own_vertices.len()),
                ("triangles", triangles.len() + own_triangles.len()),
            ] {
                if count > u32::MAX as usize {
                    return Err(Error::geometry(format!("{count} {what} are too many")));
                }
            }
            vertices.extend(own_vertices);
            triangles.extend(own_triangles.iter().map(|t| t.map(|v| v + first as u32)));
            solids.push(solid);
        }
        let (center, radius) = bounding_sphere(&solids);
        let sampler = Sampler::new(&solids, radius + center.norm());
        let vertices = vertices.into_iter().map(Into::into).collect();
        Ok((Surface { solids, vertices, triangles, sampler, center, radius }, remarks))
    }
}

fn solid(part: Part, first: usize, remarks: &mut Vec<String>) -> Result<Solid> {
    let rigid = part.pose.check_rigid();
    rigid.map_err(|why| {
        Error::geometry(format!("a part's pose {why}; mirror or scale the geometry instead"))
    })?;
    match part.geometry {
        Geometry::Mesh { vertices, triangles } => {
            let placed = vertices.into_iter().map(|v| part.pose.transform_point(&v.into())).collect();
            Ok(Solid::Mesh { mesh: Mesh::new(placed, triangles, remarks)?, first })
        }
        geometry => Ok(Solid::Exact(Placed { shape: part::primitive(&geometry)?, pose: part.pose })),
    }
}

fn bounding_sphere(solids: &[Solid]) -> (Vector3<f64>, f64) {
    let mut low = Vector3::repeat(f64::INFINITY);
    let mut high = Vector3::repeat(f64::NEG_INFINITY);
    for solid in solids {
        match solid {
            Solid::Mesh { mesh, .. } => {
                for v in &mesh.vertices {
                    low = low.inf(v);
                    high = high.sup(v);
                }
            }
            Solid::Exact(placed) => {
                let [a, b] = placed.bounds();
                low = low.inf(&a);
                high = high.sup(&b);
            }
        }
    }
    let center = (low + high) * 0.5;
    let radius = solids
        .iter()
        .map(|solid| match solid {
            Solid::Mesh { mesh, .. } => mesh.vertices.iter().map(|v| (v - center).norm()).fold(0.0, f64::max),
            Solid::Exact(placed) => placed.farthest(&center),
        })
        .fold(0.0, f64::max);
    (center, radius)
}
