//! The distance between two links.

use nalgebra::Vector3;

use super::cover::Cover;
use crate::spatial::Pose;
use crate::surface::{RayHit, Surface};

/// Beyond so much more than is needed, a lower bound of a distance will do (m).
const ROUGH: f64 = 0.03;
/// Samples by which a link is found inside another one, and the least share of them that are: near edges, and at the openings
/// of meshes that are not closed, the side of single samples can be wrong.
const INSIDE_SAMPLES: usize = 16;
const INSIDE_SHARE: f64 = 0.75;
/// Crossings of a line with a surface that are looked at.
const HITS: usize = 64;

/// What is kept between two links.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kept {
    /// The usual clearance.
    Clear,
    /// A small one, by fine samples, where links are near each other by design.
    Tight,
    /// None, but edges do not cross faces, where they are nearer still.
    Apart,
}

impl Kept {
    /// Least distance (m); where links only must not cross, what steps along a motion may be in error by.
    pub fn margin(self) -> f64 {
        match self {
            Kept::Clear => 0.01,
            Kept::Tight | Kept::Apart => 0.002,
        }
    }
}

/// Two links in a pose: one that is sampled, and the other one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gap<'a> {
    pub cover: &'a Cover,
    pub surfaces: [&'a Surface; 2],
    pub poses: [&'a Pose; 2],
}

impl Gap<'_> {
    /// What is left of the distance to be kept (m), or less than that where it is more than `enough`.
    pub fn left(&self, kept: Kept, fine: Option<&Cover>, enough: f64) -> f64 {
        match (kept, fine) {
            (Kept::Clear, _) | (Kept::Tight, None) => self.beyond(self.cover, kept.margin(), enough),
            (Kept::Tight, Some(fine)) => self.beyond(fine, kept.margin(), enough),
            (Kept::Apart, _) if self.cross() => -1.0,
            (Kept::Apart, _) => 0.0,
        }
    }

    /// Whether one link is inside the other one as a whole.
    pub fn is_inside(&self) -> bool {
        let (center, radius) = self.surfaces[1].bounding_sphere();
        let samples = self.cover.groups.len().min(INSIDE_SAMPLES);
        let inside = self.cover.groups.iter().take(samples).filter(|group| {
            let point = self.place(&group.center);
            if (point - center).norm() > radius {
                return false;
            }
            self.surfaces[1].closest_point(&point).inside
        });
        samples > 0 && inside.count() as f64 >= INSIDE_SHARE * samples as f64
    }

    /// A point of the first link in the frame of the other one.
    fn place(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.poses[1].inverse_transform_point(&self.poses[0].transform_point(point))
    }

    fn beyond(&self, cover: &Cover, margin: f64, enough: f64) -> f64 {
        let needed = margin + cover.hole;
        let [(a, r), (b, s)] = self.surfaces.map(Surface::bounding_sphere);
        let apart = (self.place(&a) - b).norm() - r - s;
        let mut least = enough + needed;
        if apart > least {
            return apart - needed;
        }
        let mut triangle = None;
        for group in &cover.groups {
            let center = self.place(&group.center);
            if (center - b).norm() - s - group.radius > least {
                continue;
            }
            let (distance, near) = self.surfaces[1].distance_within(&center, least + group.radius, triangle);
            if distance - group.radius >= least.min(needed + ROUGH) {
                least = least.min(distance - group.radius);
                continue;
            }
            triangle = near;
            for point in &group.points {
                let (distance, near) = self.surfaces[1].distance_within(&self.place(point), least, triangle);
                least = distance;
                triangle = near.or(triangle);
                if least < needed {
                    return least - needed;
                }
            }
        }
        least - needed
    }

    /// Whether an edge of either link crosses a face of the other one.
    fn cross(&self) -> bool {
        let swapped = Gap {
            surfaces: [self.surfaces[1], self.surfaces[0]],
            poses: [self.poses[1], self.poses[0]],
            ..*self
        };
        self.edges_cross() || swapped.edges_cross()
    }

    fn edges_cross(&self) -> bool {
        let [own, other] = self.surfaces;
        let (center, radius) = other.bounding_sphere();
        let points: Vec<Vector3<f64>> =
            own.vertices().iter().map(|vertex| self.place(&Vector3::from(*vertex))).collect();
        let mut hits: Vec<RayHit> = Vec::with_capacity(HITS);
        own.triangles().iter().any(|triangle| {
            let corners = triangle.map(|vertex| points[vertex as usize]);
            (0..3).any(|corner| {
                let (from, to) = (corners[corner], corners[(corner + 1) % 3]);
                let length = (to - from).norm();
                // In a closed mesh each edge comes once in either direction.
                if triangle[corner] > triangle[(corner + 1) % 3] && own.watertight()
                    || (0.5 * (from + to) - center).norm() > radius + 0.5 * length
                    || length == 0.0
                {
                    return false;
                }
                hits.clear();
                other.cast_line_into(&from, &((to - from) / length), 0.0, &mut hits);
                hits.first().is_some_and(|hit| hit.distance <= length)
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::cover::{FINE, USUAL};
    use super::*;
    use crate::surface::{Geometry, Part};

    fn cube(half: f64, faces: usize) -> Surface {
        let geometry = Geometry::Box { half_extents: [half; 3] };
        let (closed, _) = Surface::new(vec![Part { geometry, pose: Pose::identity() }]).expect("a box");
        let (vertices, triangles) = (closed.vertices().to_vec(), closed.triangles()[..faces].to_vec());
        let geometry = Geometry::Mesh { vertices, triangles };
        Surface::new(vec![Part { geometry, pose: Pose::identity() }]).expect("a mesh").0
    }

    fn at(x: f64) -> Pose {
        Pose { translation: Vector3::new(x, 0.0, 0.0), ..Pose::identity() }
    }

    #[test]
    fn what_is_left_depends_on_what_is_kept() {
        let surface = cube(0.05, 12);
        let (usual, fine) = (Cover::new(&surface, USUAL), Cover::new(&surface, FINE));
        let left = |gap: f64, kept| {
            let poses = [&at(0.1 + gap), &Pose::identity()];
            Gap { cover: &usual, surfaces: [&surface; 2], poses }.left(kept, Some(&fine), 0.0)
        };
        assert!(left(0.03, Kept::Clear) >= 0.0 && left(0.012, Kept::Clear) < 0.0);
        assert!(left(0.012, Kept::Tight) >= 0.0 && left(0.001, Kept::Tight) < 0.0);
        assert!(left(0.001, Kept::Apart) >= 0.0 && left(-0.001, Kept::Apart) < 0.0);
    }

    #[test]
    fn only_what_is_inside_as_a_whole_is_inside() {
        let small = cube(0.02, 12);
        let cover = Cover::new(&small, USUAL);
        // Closed, and without one of its faces.
        for faces in [12, 10] {
            let large = cube(0.2, faces);
            let inside = |x: f64| {
                Gap { cover: &cover, surfaces: [&small, &large], poses: [&at(x), &Pose::identity()] }
                    .is_inside()
            };
            assert!(inside(0.0) && inside(0.1));
            for x in [0.2, 0.25, 0.4, -0.25, -0.4] {
                assert!(!inside(x), "{faces} {x}");
            }
        }
    }
}
