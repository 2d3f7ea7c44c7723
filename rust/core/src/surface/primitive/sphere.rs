//! A sphere around the origin.

use std::f64::consts::PI;

use nalgebra::Vector3;

use super::elements::{direction_or, Crossing, Nearest};

pub(super) fn closest(radius: f64, p: &Vector3<f64>) -> Nearest {
    let normal = direction_or(p, Vector3::z());
    Nearest { point: normal * radius, normal, signed_distance: p.norm() - radius }
}

pub(super) fn cross(radius: f64, origin: &Vector3<f64>, direction: &Vector3<f64>) -> Option<[Crossing; 2]> {
    let middle = -origin.dot(direction);
    let foot = origin + direction * middle;
    let offset = foot.norm();
    // The chord: never a difference of squares, which cancels.
    let half_squared = (radius - offset) * (radius + offset);
    if half_squared <= 0.0 {
        return None;
    }
    let half = half_squared.sqrt();
    Some(
        [-half, half].map(|along| Crossing {
            distance: middle + along,
            normal: (foot + direction * along).normalize(),
        }),
    )
}

pub(super) fn sample(radius: f64, [u, v, _]: [f64; 3]) -> (Vector3<f64>, Vector3<f64>) {
    let z = 2.0 * u - 1.0;
    let ring = ((1.0 - z) * (1.0 + z)).sqrt();
    let (sin, cos) = (2.0 * PI * v).sin_cos();
    let normal = Vector3::new(ring * cos, ring * sin, z);
    (normal * radius, normal)
}
