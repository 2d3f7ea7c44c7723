//! A link's surface: closest points, all hits of a line, samples uniform by area.
//!
//! A surface is the union of parts. Meshes are repaired when the surface is made and searched through a tree;
//! boxes, cylinders, spheres and capsules are exact. Everything is in the link's frame, in metres, and immutable.

mod answers;
mod build;
pub(crate) mod mesh;
mod part;
mod primitive;
mod query;
mod sample;

#[cfg(test)]
pub(crate) mod tests;

pub use answers::{ClosestPoint, RayHit, SurfacePoint};
pub use part::{Geometry, Part};

use nalgebra::Vector3;

use part::Solid;
use sample::Sampler;
pub use sample::Sampling;

/// The surface of one link.
///
/// ```
/// use contactsense::spatial::Pose;
/// use contactsense::surface::{Geometry, Part, Surface};
/// use nalgebra::Vector3;
///
/// let ball = Part { geometry: Geometry::Sphere { radius: 0.5 }, pose: Pose::identity() };
/// let (surface, remarks) = Surface::new(vec![ball])?;
/// assert!(remarks.is_empty());
///
/// let near = surface.closest_point(&Vector3::new(2.0, 0.0, 0.0));
/// assert!((near.distance - 1.5).abs() < 1e-12 && (near.normal - Vector3::x()).norm() < 1e-12);
///
/// let mut hits = Vec::with_capacity(8);
/// surface.cast_line_into(&Vector3::new(0.0, 0.0, -2.0), &Vector3::z(), f64::NEG_INFINITY, &mut hits);
/// assert!((hits[0].distance - 1.5).abs() < 1e-12 && hits.len() == 2);
///
/// assert_eq!(surface.sample(100, 7).len(), 100);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Surface {
    solids: Vec<Solid>,
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    sampler: Sampler,
    center: Vector3<f64>,
    radius: f64,
}

impl Surface {
    /// Vertices of all parts (m); those of a primitive belong to a tessellation for display.
    pub fn vertices(&self) -> &[[f64; 3]] {
        &self.vertices
    }

    /// Triangles of all parts, counter-clockwise seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Sum of the parts' areas, exact for primitives (m^2). Where parts overlap, both count.
    pub fn area(&self) -> f64 {
        self.sampler.area()
    }

    /// Area that is not hidden by other parts, to about a hundredth (m^2).
    pub fn exposed_area(&self) -> f64 {
        if self.solids.len() == 1 {
            return self.area();
        }
        self.area() * self.sampler.exposed_share(&self.solids)
    }

    /// Whether every part is closed: each edge of a mesh is used as often in one direction as in the other.
    pub fn watertight(&self) -> bool {
        self.solids.iter().all(Solid::closed)
    }

    /// Centre and radius of a sphere around all parts (m).
    pub fn bounding_sphere(&self) -> (Vector3<f64>, f64) {
        (self.center, self.radius)
    }

    /// The nearest point of the surface, the minimum over the parts.
    ///
    /// Where parts overlap it can lie inside another part. A query that is not finite gives a distance of NaN.
    pub fn closest_point(&self, p: &Vector3<f64>) -> ClosestPoint {
        self.nearest(p, None)
    }

    /// As [`closest_point`](Self::closest_point), faster if `triangle` (of an earlier answer) is near the query.
    ///
    /// None, or an index that names no mesh triangle, only loses the gain.
    pub fn closest_point_from(&self, p: &Vector3<f64>, triangle: Option<u32>) -> ClosestPoint {
        self.nearest(p, triangle)
    }

    /// The point nearest to `p` in the neighbourhood of `triangle` (of an earlier answer): no point next to it is nearer,
    /// though another part of a surface that is not convex may be. Much faster than
    /// [`closest_point`](Self::closest_point), and the same where surface and query move by little.
    ///
    /// None, or an index that names no mesh triangle, gives the nearest point of all.
    pub fn closest_point_near(&self, p: &Vector3<f64>, triangle: Option<u32>) -> ClosestPoint {
        let start = triangle
            .and_then(|triangle| self.solids.iter().find_map(|solid| Some((solid, solid.holds(triangle)?))));
        let found = match start {
            Some((Solid::Mesh { mesh, first }, id)) => mesh.descend(p, id, *first),
            _ => None,
        };
        found.unwrap_or_else(|| self.nearest(p, start.and(triangle)))
    }

    /// Whether a point of the surface lies inside another closed part, where nothing outside the link reaches it.
    /// `triangle` is the one that holds the point, if it is on a mesh.
    pub fn hides(&self, point: &Vector3<f64>, triangle: Option<u32>) -> bool {
        self.solids.len() > 1 && self.sampler.hides(&self.solids, point, triangle)
    }

    /// Whether a point is inside a closed part; parts that are not closed have no inside.
    pub fn contains(&self, p: &Vector3<f64>) -> bool {
        self.solids.iter().any(|solid| solid.contains(p, 0.0))
    }

    /// Distance to the surface where it is less than `bound`, else `bound` (m), and the triangle of the nearest point if it is
    /// on a mesh; much faster than [`closest_point_from`](Self::closest_point_from) where the bound is small.
    pub(crate) fn distance_within(
        &self,
        p: &Vector3<f64>,
        bound: f64,
        triangle: Option<u32>,
    ) -> (f64, Option<u32>) {
        let mut best = ClosestPoint { distance: bound, ..ClosestPoint::NONE };
        for solid in &self.solids {
            solid.closest_point(p, triangle, &mut best);
        }
        (best.distance, best.triangle)
    }

    fn nearest(&self, p: &Vector3<f64>, warm_start: Option<u32>) -> ClosestPoint {
        let mut best = ClosestPoint::NONE;
        for solid in &self.solids {
            solid.closest_point(p, warm_start, &mut best);
        }
        if !best.point.x.is_finite() {
            best.distance = f64::NAN;
        }
        best
    }

    /// Appends every crossing of a line with the surface to `hits`, nearest first; returns whether all fitted.
    ///
    /// `direction` is a unit vector; crossings before `t_min` (m) are left out (minus infinity: a full line). Hits
    /// inside another closed part are left out too, so that those of closed parts come in pairs in and out.
    ///
    /// Never allocates: where the crossings of all parts, before those inside others are dropped, do not fit into the
    /// capacity of `hits`, only the nearest ones that fit are looked at, and it returns `false`. A line that is not finite, or
    /// without direction, hits nothing.
    pub fn cast_line_into(
        &self,
        origin: &Vector3<f64>,
        direction: &Vector3<f64>,
        t_min: f64,
        hits: &mut Vec<RayHit>,
    ) -> bool {
        query::cast::cast(&self.solids, (&self.center, self.radius), origin, direction, t_min, hits)
    }

    /// `n` points, uniform by area over what is exposed: points strictly inside another closed part, or on a face
    /// that another part covers, are not taken. The same seed gives the same points, and a larger `n` appends.
    ///
    /// Gives fewer than `n` only if less than about a thousandth of the area is exposed.
    pub fn sample(&self, n: usize, seed: u64) -> Vec<SurfacePoint> {
        let mut points = Vec::with_capacity(n);
        self.sampling(n, seed).draw(u64::MAX, &mut points);
        points
    }

    /// The points of [`sample`](Self::sample), to be drawn in parts.
    pub fn sampling(&self, n: usize, seed: u64) -> Sampling<'_> {
        Sampling::new(&self.sampler, &self.solids, n, seed)
    }
}
