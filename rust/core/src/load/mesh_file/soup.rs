//! Triangles as a mesh file gives them, within limits.

use nalgebra::Vector3;

use super::polygon;

type Result<T> = std::result::Result<T, String>;

/// Most triangles of one mesh file; indexed, they take about 2 GB. A collision mesh has 1,000 times fewer.
pub(super) const MOST_TRIANGLES: usize = 5_000_000;
/// Most vertices: no triangle shares one.
pub(super) const MOST_VERTICES: usize = 3 * MOST_TRIANGLES;

/// Finite vertices, and triangles whose indices are in range.
#[derive(Debug, Default)]
pub(super) struct Soup {
    pub vertices: Vec<Vector3<f64>>,
    pub triangles: Vec<[u32; 3]>,
}

impl Soup {
    /// Adds a vertex and returns its index.
    pub fn add_vertex(&mut self, vertex: Vector3<f64>) -> Result<u32> {
        if !vertex.iter().all(|x| x.is_finite()) {
            return Err("has a vertex that is not finite".into());
        }
        if self.vertices.len() >= MOST_VERTICES {
            return Err(format!("has more than {MOST_VERTICES} vertices; simplify it"));
        }
        self.vertices.push(vertex);
        Ok((self.vertices.len() - 1) as u32)
    }

    /// Adds a triangle of vertices that are there.
    pub fn add_triangle(&mut self, triangle: [u32; 3]) -> Result<()> {
        if triangle.iter().any(|&v| v as usize >= self.vertices.len()) {
            return Err("has a triangle with an index out of range".into());
        }
        if self.triangles.len() >= MOST_TRIANGLES {
            return Err(format!("has more than {MOST_TRIANGLES} triangles; simplify it"));
        }
        self.triangles.push(triangle);
        Ok(())
    }

    /// Adds the triangles of a polygon of vertices that are there; of fewer than three nothing.
    pub fn add_polygon(&mut self, corners: &[u32]) -> Result<()> {
        if let &[a, b, c] = corners {
            return self.add_triangle([a, b, c]);
        }
        let points: Option<Vec<_>> =
            corners.iter().map(|&v| self.vertices.get(v as usize).copied()).collect();
        let points = points.ok_or("has a face with an index out of range")?;
        polygon::triangulate(&points, &mut |triangle| self.add_triangle(triangle.map(|i| corners[i])))
    }
}
