//! Closest point by descent: from triangle to triangle, as long as that leads nearer.

use nalgebra::Vector3;

use super::triangle::{closest_feature, Feature};
use crate::surface::mesh::repair::components::Edges;
use crate::surface::mesh::Mesh;
use crate::surface::ClosestPoint;

/// Steps from triangle to triangle at most.
const STEPS: usize = 32;
/// Triangles round one vertex at most: a search through the tree looks at about as many.
const LARGEST_FAN: usize = 128;
const NONE: u32 = u32::MAX;

/// Which triangles meet at edges and vertices.
#[derive(Debug, Clone)]
pub(crate) struct Neighbours {
    /// The other triangle at each edge (corner k to the next one); `NONE` where there is not exactly one.
    across: Vec<[u32; 3]>,
    /// Where in `fans` each vertex' triangles begin; one entry more than vertices.
    first: Vec<u32>,
    fans: Vec<u32>,
    faces: Vec<Face>,
}

/// What tells at once whether a query is above a triangle.
#[derive(Debug, Clone)]
struct Face {
    corner: Vector3<f64>,
    /// Their products with a query from the corner are its barycentric coordinates.
    coordinates: [Vector3<f64>; 2],
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
    pub fn new(points: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Self {
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
        let faces =
            triangles.iter().map(|triangle| Face::new(triangle.map(|v| points[v as usize]))).collect();
        Neighbours { across, first, fans, faces }
    }

    fn fan(&self, vertex: u32) -> &[u32] {
        &self.fans[self.first[vertex as usize] as usize..self.first[vertex as usize + 1] as usize]
    }
}

impl Mesh {
    /// The point nearest to `p` among those that lie next to it, found by going downhill from triangle `start`;
    /// `None` where that takes too long.
    pub fn descend(&self, p: &Vector3<f64>, start: usize, first: usize) -> Option<ClosestPoint> {
        let mut id = start;
        let (mut point, mut feature) = self.on_triangle(p, id);
        let mut squared = (point - p).norm_squared();
        for _ in 0..STEPS {
            let mut better = None;
            let mut visit = |other: u32| {
                let (point, feature) = self.on_triangle(p, other as usize);
                let nearer = (point - p).norm_squared();
                if nearer < squared {
                    squared = nearer;
                    better = Some((other as usize, point, feature));
                }
            };
            match feature {
                Feature::Face => {}
                Feature::Edge(k) => match self.neighbours.across[id][usize::from(k)] {
                    NONE => {}
                    other if self.leads_nearer(&(p - point), id, usize::from(k), other) => visit(other),
                    _ => {}
                },
                Feature::Corner(k) => {
                    let corner = self.triangles[id][usize::from(k)];
                    let fan = self.neighbours.fan(corner);
                    if fan.len() > LARGEST_FAN {
                        return None;
                    }
                    if fan.iter().any(|&other| self.leads_away(&(p - point), corner, other)) {
                        fan.iter().filter(|&&other| other as usize != id).for_each(|&other| visit(other));
                    }
                }
            }
            match better {
                Some(next) => (id, point, feature) = next,
                None => {
                    return Some(ClosestPoint {
                        point,
                        normal: self.normals[id],
                        distance: squared.sqrt(),
                        triangle: Some((first + id) as u32),
                    })
                }
            }
        }
        None
    }

    /// Whether the triangle across edge `k` of triangle `id` goes towards the query, `apart` from a point of the edge.
    #[inline]
    fn leads_nearer(&self, apart: &Vector3<f64>, id: usize, k: usize, other: u32) -> bool {
        let [a, b] = [k, (k + 1) % 3].map(|corner| self.triangles[id][corner]);
        let tip = self.triangles[other as usize].into_iter().find(|v| *v != a && *v != b).unwrap_or(a);
        let [a, b, tip] = [a, b, tip].map(|v| self.vertices[v as usize]);
        let (edge, side) = (b - a, tip - a);
        // The part of `side` across the edge.
        apart.dot(&(side * edge.norm_squared() - edge * side.dot(&edge))) > 0.0
    }

    /// Whether an edge of a triangle from its vertex `corner` goes towards the query, `apart` from that. What lies between
    /// two edges that do not, does not either.
    #[inline]
    fn leads_away(&self, apart: &Vector3<f64>, corner: u32, triangle: u32) -> bool {
        let at = self.vertices[corner as usize];
        let mut ends = self.triangles[triangle as usize].into_iter().filter(|v| *v != corner);
        ends.any(|end| apart.dot(&(self.vertices[end as usize] - at)) > 0.0)
    }

    #[inline]
    fn on_triangle(&self, p: &Vector3<f64>, id: usize) -> (Vector3<f64>, Feature) {
        let face = &self.neighbours.faces[id];
        let apart = p - face.corner;
        let (u, v) = (face.coordinates[0].dot(&apart), face.coordinates[1].dot(&apart));
        if u > 0.0 && v > 0.0 && u + v < 1.0 {
            let normal = &self.normals[id];
            return (p - normal * normal.dot(&apart), Feature::Face);
        }
        closest_feature(p, &self.triangles[id].map(|v| self.vertices[v as usize]))
    }
}
