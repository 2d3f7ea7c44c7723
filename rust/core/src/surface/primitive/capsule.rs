//! A capsule around the z axis, centred: all points within a radius of a segment.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::Vector3;

use super::elements::{direction_or, end, Crossing, Nearest, Tessellation, SEGMENTS};
use super::{cylinder, sphere};

pub(super) fn closest(radius: f64, half_length: f64, p: &Vector3<f64>) -> Nearest {
    let axis = Vector3::new(0.0, 0.0, p.z.clamp(-half_length, half_length));
    let from_axis = p - axis;
    // At the very end of the segment, the pole is as near as any point of the equator.
    let otherwise = if p.z.abs() >= half_length { end(p.z) } else { Vector3::x() };
    let normal = direction_or(&from_axis, otherwise);
    Nearest { point: axis + normal * radius, normal, signed_distance: from_axis.norm() - radius }
}

pub(super) fn cross(
    radius: f64,
    half_length: f64,
    origin: &Vector3<f64>,
    direction: &Vector3<f64>,
) -> Option<[Crossing; 2]> {
    let sides = cylinder::cross_side(radius, origin, direction)?;
    let mut crossings = sides;
    for (k, side) in sides.iter().enumerate() {
        let z = if side.distance.is_finite() {
            origin.z + direction.z * side.distance
        } else {
            side.distance * direction.z
        };
        if z.abs() > half_length {
            let center = Vector3::new(0.0, 0.0, half_length.copysign(z));
            // A line that enters the endless cylinder beyond an end and misses that end's sphere misses all.
            crossings[k] = sphere::cross(radius, &(origin - center), direction)?[k];
        }
    }
    let [enter, leave]: [Crossing; 2] = crossings;
    (enter.distance < leave.distance).then_some([enter, leave])
}

pub(super) fn sample(radius: f64, half_length: f64, [u, v, w]: [f64; 3]) -> (Vector3<f64>, Vector3<f64>) {
    // By Archimedes a zone of the sphere has the area of the cylinder around it: both are uniform in height.
    let at = u * 2.0 * (radius + half_length) - (radius + half_length);
    if at.abs() < half_length {
        let (sin, cos) = (2.0 * PI * v).sin_cos();
        let normal = Vector3::new(cos, sin, 0.0);
        return (normal * radius + Vector3::z() * at, normal);
    }
    let height = (at.abs() - half_length) / radius;
    let (_, mut normal) = sphere::sample(radius, [0.5 + 0.5 * height, v, w]);
    normal.z = normal.z.copysign(at);
    (normal * radius + Vector3::new(0.0, 0.0, half_length.copysign(at)), normal)
}

/// Also a sphere, with no length.
pub(super) fn tessellate(radius: f64, half_length: f64) -> Tessellation {
    let quarter = SEGMENTS / 4;
    let mut rings: Vec<(f64, f64)> = Vec::new(); // radius and height, bottom to top, without the poles
    for i in 1..2 * quarter {
        let (sin, cos) = (FRAC_PI_2 * (i as f64 / quarter as f64 - 1.0)).sin_cos();
        if i == quarter && half_length > 0.0 {
            rings.push((radius, -half_length));
            rings.push((radius, half_length));
        } else {
            let shift = if i == quarter { 0.0 } else { half_length.copysign(sin) };
            rings.push((radius * cos, radius * sin + shift));
        }
    }
    let mut vertices = Vec::new();
    for &(ring, height) in &rings {
        for i in 0..SEGMENTS {
            let (sin, cos) = (2.0 * PI * i as f64 / SEGMENTS as f64).sin_cos();
            vertices.push(Vector3::new(ring * cos, ring * sin, height));
        }
    }
    let at = |ring: usize, i: usize| (ring * SEGMENTS + i % SEGMENTS) as u32;
    let bottom = vertices.len() as u32;
    vertices.push(Vector3::new(0.0, 0.0, -half_length - radius));
    vertices.push(Vector3::new(0.0, 0.0, half_length + radius));
    let last = rings.len() - 1;
    let mut triangles = Vec::new();
    for i in 0..SEGMENTS {
        triangles.push([bottom, at(0, i + 1), at(0, i)]);
        triangles.push([bottom + 1, at(last, i), at(last, i + 1)]);
        for ring in 0..last {
            let (a, b, c, d) = (at(ring, i), at(ring, i + 1), at(ring + 1, i + 1), at(ring + 1, i));
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    (vertices, triangles)
}
