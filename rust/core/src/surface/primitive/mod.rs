//! Exact primitives: closest points, crossings, samples, and a tessellation for display.
//!
//! Each is convex, so a line crosses it twice or not at all.

mod r#box;
mod capsule;
mod cylinder;
mod elements;
mod sphere;

use std::f64::consts::PI;

use nalgebra::Vector3;

use self::elements::{Crossing, Nearest, Tessellation};
use super::answers::{ClosestPoint, RayHit, SurfacePoint};
use crate::spatial::Pose;

/// A primitive in its own frame (m).
#[derive(Debug, Clone, Copy)]
pub(super) enum Primitive {
    Box(Vector3<f64>),
    Cylinder { radius: f64, half_length: f64 },
    Sphere { radius: f64 },
    Capsule { radius: f64, half_length: f64 },
}

impl Primitive {
    fn closest(&self, p: &Vector3<f64>) -> Nearest {
        match *self {
            Primitive::Box(half) => r#box::closest(&half, p),
            Primitive::Cylinder { radius, half_length } => cylinder::closest(radius, half_length, p),
            Primitive::Sphere { radius } => sphere::closest(radius, p),
            Primitive::Capsule { radius, half_length } => capsule::closest(radius, half_length, p),
        }
    }

    /// The crossings in and out. The direction has unit length.
    fn cross(&self, origin: &Vector3<f64>, direction: &Vector3<f64>) -> Option<[Crossing; 2]> {
        match *self {
            Primitive::Box(half) => r#box::cross(&half, origin, direction),
            Primitive::Cylinder { radius, half_length } => {
                cylinder::cross(radius, half_length, origin, direction)
            }
            Primitive::Sphere { radius } => sphere::cross(radius, origin, direction),
            Primitive::Capsule { radius, half_length } => {
                capsule::cross(radius, half_length, origin, direction)
            }
        }
    }

    pub fn area(&self) -> f64 {
        match *self {
            Primitive::Box(h) => 8.0 * (h.x * h.y + h.y * h.z + h.z * h.x),
            Primitive::Cylinder { radius, half_length } => 2.0 * PI * radius * (radius + 2.0 * half_length),
            Primitive::Sphere { radius } => 4.0 * PI * radius * radius,
            Primitive::Capsule { radius, half_length } => 4.0 * PI * radius * (radius + half_length),
        }
    }

    /// A point and its normal, uniform by area for uniform `u` in [0, 1).
    fn sample(&self, u: [f64; 3]) -> (Vector3<f64>, Vector3<f64>) {
        match *self {
            Primitive::Box(half) => r#box::sample(&half, u),
            Primitive::Cylinder { radius, half_length } => cylinder::sample(radius, half_length, u),
            Primitive::Sphere { radius } => sphere::sample(radius, u),
            Primitive::Capsule { radius, half_length } => capsule::sample(radius, half_length, u),
        }
    }

    fn tessellate(&self) -> Tessellation {
        match *self {
            Primitive::Box(half) => r#box::tessellate(&half),
            Primitive::Cylinder { radius, half_length } => cylinder::tessellate(radius, half_length),
            Primitive::Sphere { radius } => capsule::tessellate(radius, 0.0),
            Primitive::Capsule { radius, half_length } => capsule::tessellate(radius, half_length),
        }
    }

    /// Largest distance of any of its points from `p`.
    fn farthest(&self, p: &Vector3<f64>) -> f64 {
        let round = |radius: f64, half_length: f64| (p.xy().norm() + radius).hypot(p.z.abs() + half_length);
        match *self {
            Primitive::Box(half) => (p.abs() + half).norm(),
            Primitive::Cylinder { radius, half_length } => round(radius, half_length),
            Primitive::Sphere { radius } => p.norm() + radius,
            Primitive::Capsule { radius, half_length } => round(0.0, half_length) + radius,
        }
    }

    /// Half the extents of its axis-aligned box.
    fn half_extents(&self) -> Vector3<f64> {
        match *self {
            Primitive::Box(half) => half,
            Primitive::Cylinder { radius, half_length } => Vector3::new(radius, radius, half_length),
            Primitive::Sphere { radius } => Vector3::repeat(radius),
            Primitive::Capsule { radius, half_length } => Vector3::new(radius, radius, half_length + radius),
        }
    }
}

/// A primitive on a link.
#[derive(Debug, Clone)]
pub(super) struct Placed {
    pub shape: Primitive,
    pub pose: Pose,
}

impl Placed {
    /// Replaces `best` if this primitive is nearer.
    pub fn closest_point(&self, p: &Vector3<f64>, best: &mut ClosestPoint) {
        let nearest = self.shape.closest(&self.pose.inverse_transform_point(p));
        let distance = nearest.signed_distance.abs();
        if distance < best.distance {
            *best = ClosestPoint {
                point: self.pose.transform_point(&nearest.point),
                normal: self.pose.rotation * nearest.normal,
                distance,
                inside: nearest.signed_distance < 0.0,
                triangle: None,
            };
        }
    }

    pub fn contains(&self, p: &Vector3<f64>, tolerance: f64) -> bool {
        self.shape.closest(&self.pose.inverse_transform_point(p)).signed_distance < -tolerance
    }

    /// Calls `visit` for both crossings of a line, those from `t_min` on, until it returns `false`.
    pub fn cross(
        &self,
        origin: &Vector3<f64>,
        direction: &Vector3<f64>,
        t_min: f64,
        part: u32,
        visit: &mut impl FnMut(RayHit) -> bool,
    ) {
        // From the point of the line nearest to the centre, so that a far origin costs no precision.
        let shift = (self.pose.translation - origin).dot(direction);
        let local = self.pose.inverse_transform_point(&(origin + direction * shift));
        let along = self.pose.inverse_transform_vector(direction);
        let Some(crossings) = self.shape.cross(&local, &along) else {
            return;
        };
        for (crossing, entering) in crossings.into_iter().zip([true, false]) {
            let distance = crossing.distance + shift;
            if distance < t_min {
                continue;
            }
            let more = visit(RayHit {
                distance,
                point: origin + direction * distance,
                normal: self.pose.rotation * crossing.normal,
                triangle: None,
                part,
                entering,
                hidden: false,
            });
            if !more {
                return;
            }
        }
    }

    pub fn sample(&self, u: [f64; 3]) -> SurfacePoint {
        let (point, normal) = self.shape.sample(u);
        SurfacePoint {
            point: self.pose.transform_point(&point),
            normal: self.pose.rotation * normal,
            triangle: None,
        }
    }

    pub fn tessellate(&self) -> Tessellation {
        let (vertices, triangles) = self.shape.tessellate();
        (vertices.iter().map(|v| self.pose.transform_point(v)).collect(), triangles)
    }

    pub fn farthest(&self, p: &Vector3<f64>) -> f64 {
        self.shape.farthest(&self.pose.inverse_transform_point(p))
    }

    /// Low and high corner of a box around it in the link's frame.
    pub fn bounds(&self) -> [Vector3<f64>; 2] {
        let half = self.pose.rotation.abs() * self.shape.half_extents();
        [self.pose.translation - half, self.pose.translation + half]
    }
}
