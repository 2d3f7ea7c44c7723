//! A repaired mesh with its search tree.

pub(super) mod bvh;
pub(crate) mod bvh4;
pub(crate) mod neighbours;
pub(crate) mod repair;

use nalgebra::Vector3;

use self::bvh4::{Child, Tree};
use self::neighbours::Neighbours;
use crate::{Error, Result};

#[derive(Debug, Clone)]
pub(crate) struct Mesh {
    pub vertices: Vec<Vector3<f64>>,
    pub triangles: Vec<[u32; 3]>,
    /// Unit normals of the triangles.
    pub normals: Vec<Vector3<f64>>,
    /// Corners in leaf order, and which triangle they are.
    pub corners: Vec<[Vector3<f64>; 3]>,
    pub order: Vec<u32>,
    pub tree: Tree,
    pub neighbours: Neighbours,
    pub closed: bool,
}

impl Mesh {
    /// Repairs and indexes a mesh; what was odd goes to `remarks`.
    pub fn new(
        vertices: Vec<Vector3<f64>>,
        triangles: Vec<[u32; 3]>,
        remarks: &mut Vec<String>,
    ) -> Result<Self> {
        check(&vertices, &triangles)?;
        let repaired = repair::repair(vertices, triangles, remarks)?;
        let (vertices, triangles) = (repaired.vertices, repaired.triangles);
        let all: Vec<[Vector3<f64>; 3]> = triangles.iter().map(|t| t.map(|v| vertices[v as usize])).collect();
        let normals: Vec<Vector3<f64>> = all
            .iter()
            .map(|[a, b, c]| (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_else(Vector3::z))
            .collect();
        let (tree, order) = Tree::new(&all);
        let corners = order.iter().map(|&id| all[id as usize]).collect();
        let neighbours = Neighbours::new(&vertices, &triangles, &normals);
        Ok(Mesh { vertices, triangles, normals, corners, order, tree, neighbours, closed: repaired.closed })
    }

    /// The corners of triangle `id`.
    #[inline]
    pub fn corners_of(&self, id: usize) -> [Vector3<f64>; 3] {
        self.triangles[id].map(|v| self.vertices[v as usize])
    }
}

fn check(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Result<()> {
    if vertices.is_empty() || triangles.is_empty() {
        return Err(Error::geometry(format!(
            "mesh: {} vertices and {} triangles; it needs at least one triangle",
            vertices.len(),
            triangles.len()
        )));
    }
    if triangles.len() >= Child::MAX_TRIANGLES {
        return Err(Error::geometry(format!("mesh: {} triangles are too many", triangles.len())));
    }
    if let Some(i) = vertices.iter().position(|v| !v.iter().all(|x| x.is_finite() && x.abs() < 1e15)) {
        return Err(Error::geometry(format!(
            "mesh: vertex {i} is {:?}; it must be finite",
            vertices[i].as_slice()
        )));
    }
    let bad = triangles.iter().position(|t| t.iter().any(|&v| v as usize >= vertices.len()));
    if let Some(i) = bad {
        return Err(Error::geometry(format!(
            "mesh: triangle {i} is {:?}, but there are only {} vertices",
            triangles[i],
            vertices.len()
        )));
    }
    Ok(())
}
