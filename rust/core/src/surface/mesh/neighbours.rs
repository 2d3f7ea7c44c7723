//! Which triangles of a mesh lie next to each other.

use nalgebra::Vector3;

use super::repair::components::Edges;

/// No triangle.
pub(crate) const NONE: u32 = u32::MAX;

/// Which triangles meet at edges and vertices.
#[derive(Debug, Clone)]
pub(crate) struct Neighbours {
    /// The other triangle at each edge (corner k to the next one); `NONE` where there is not exactly one.
    pub across: Vec<[u32; 3]>,
    /// Where in `fans` each vertex' triangles begin; one entry more than vertices.
    first: Vec<u32>,
    fans: Vec<u32>,
    /// Of each vertex: the sum of its triangles' unit normals, each times its angle there (rad).
    pub normals: Vec<Vector3<f64>>,
    pub faces: Vec<Face>,
}

/// What tells at once whether a query is above a triangle.
#[derive(Debug, Clone)]
pub(crate) struct Face {
    pub corner: Vector3<f64>,
    /// Their products with a query from the corner are its barycentric coordinates.
    pub coordinates: [Vector3<f64>; 2],
}

impl Face {
    fn new([a, b, c]: [Vector3<f64>; 3]) -> Self {
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(&ac);
        let squared = normal.norm_squared();
        Face { corner: a, coordinates: [ac.cross(&normal) / squared, normal.cross(&ab) / squared] }
    }
}

impl Neighbours {
    /// Of triangles with these unit normals.
    pub fn new(points: &[Vector3<f64>], triangles: &[[u32; 3]], faces: &[Vector3<f64>]) -> Self {
        let vertices = points.len();
        let mut first = vec![0u32; vertices + 1];
        triangles.iter().flatten().for_each(|&v| first[v as usize + 1] += 1);
        (0..vertices).for_each(|v| first[v + 1] += first[v]);
        let mut next = first.clone();
        let mut fans = vec![0; 3 * triangles.len()];
        for (id, triangle) in triangles.iter().enumerate() {
            for &v in triangle {
                fans[next[v as usize] as usize] = id as u32;
                next[v as usize] += 1;
            }
        }
        let mut across = vec![[NONE; 3]; triangles.len()];
        for uses in Edges::new(triangles).iter() {
            let &[([from, to], a), (_, b)] = uses else { continue };
            for (own, other) in [(a.triangle, b.triangle), (b.triangle, a.triangle)] {
                let triangle = triangles[own as usize];
                let corner = (0..3).find(|&k| {
                    let (start, end) = (triangle[k], triangle[(k + 1) % 3]);
                    [start.min(end), start.max(end)] == [from, to]
                });
                if let Some(k) = corner {
                    across[own as usize][k] = other;
                }
            }
        }
        let mut normals = vec![Vector3::zeros(); vertices];
        for (triangle, normal) in triangles.iter().zip(faces) {
            for k in 0..3 {
                let [at, next, last] = [k, k + 1, k + 2].map(|k| triangle[k % 3] as usize);
                let (one, other) = (points[next] - points[at], points[last] - points[at]);
                normals[at] += normal * one.angle(&other);
            }
        }
        let faces =
            triangles.iter().map(|triangle| Face::new(triangle.map(|v| points[v as usize]))).collect();
        Neighbours { across, first, fans, normals, faces }
    }

    /// The triangles round a vertex.
    #[inline]
    pub fn fan(&self, vertex: u32) -> &[u32] {
        &self.fans[self.first[vertex as usize] as usize..self.first[vertex as usize + 1] as usize]
    }
}
