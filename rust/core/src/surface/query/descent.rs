//! Closest point by descent: from triangle to triangle, as long as that leads nearer.

use nalgebra::Vector3;

use super::triangle::{closest_feature, Feature};
use crate::surface::answers::ClosestPoint;
use crate::surface::mesh::neighbours::NONE;
use crate::surface::mesh::Mesh;

/// Steps from triangle to triangle at most.
const STEPS: usize = 32;
/// Triangles round one vertex at most: a search through the tree looks at about as many.
const LARGEST_FAN: usize = 128;

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
                        inside: self.is_inner_side(&(p - point), id, feature),
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
        closest_feature(p, &self.corners_of(id))
    }
}
