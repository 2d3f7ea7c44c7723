//! On which side of a mesh a query is.

use nalgebra::Vector3;

use super::triangle::Feature;
use crate::surface::mesh::neighbours::NONE;
use crate::surface::mesh::Mesh;

impl Mesh {
    /// Whether a query is on the inner side, `apart` from its nearest point, which is on a feature of triangle `id`.
    ///
    /// Where that is an edge or a corner, the normal of a single face there may tell the wrong side. The sum of the normals of
    /// all faces there, each weighted by its angle, does not (Baerentzen and Aanaes 2005).
    #[inline]
    pub fn is_inner_side(&self, apart: &Vector3<f64>, id: usize, feature: Feature) -> bool {
        let own = self.normals[id];
        let normal = match feature {
            Feature::Face => own,
            Feature::Edge(k) => match self.neighbours.across[id][usize::from(k)] {
                NONE => own,
                other => own + self.normals[other as usize],
            },
            Feature::Corner(k) => self.neighbours.normals[self.triangles[id][usize::from(k)] as usize],
        };
        apart.dot(&normal) < 0.0
    }
}
