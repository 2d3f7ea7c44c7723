//! A cylinder around the z axis, centred.

use std::f64::consts::PI;

use nalgebra::{Vector2, Vector3};

use super::elements::{direction_or, end, Crossing, Nearest, Tessellation, SEGMENTS};

pub(super) fn closest(radius: f64, half_length: f64, p: &Vector3<f64>) -> Nearest {
    let radial = Vector3::new(p.x, p.y, 0.0);
    let outward = direction_or(&radial, Vector3::x());
    let beside = radial.norm() - radius;
    let beyond = p.z.abs() - half_length;
    let on_side = outward * radius + Vector3::new(0.0, 0.0, p.z.clamp(-half_length, half_length));
    let end_height = half_length.copysign(p.z);
    let (point, signed_distance) = match (beside > 0.0, beyond > 0.0) {
        (true, false) => (on_side, beside),
        (false, true) => (Vector3::new(p.x, p.y, end_height), beyond),
        (true, true) => (on_side, beside.hypot(beyond)),
        (false, false) if beside >= beyond => (on_side, beside),
        (false, false) => (Vector3::new(p.x, p.y, end_height), beyond),
    };
    let normal = if beside >= beyond { outward } else { end(p.z) };
    Nearest { point, normal, signed_distance }
}

/// Crossings of the endless cylinder; without a normal where the line is parallel to it and inside.
pub(super) fn cross_side(
    radius: f64,
    origin: &Vector3<f64>,
    direction: &Vector3<f64>,
) -> Option<[Crossing; 2]> {
    let across = direction.xy();
    let length = across.norm();
    if length < 1e-150 {
        let inside = origin.xy().norm() <= radius;
        return inside.then_some(
            [f64::NEG_INFINITY, f64::INFINITY]
                .map(|distance| Crossing { distance, normal: Vector3::zeros() }),
        );
    }
    let unit: Vector2<f64> = across / length;
    let offset = origin.x * unit.y - origin.y * unit.x;
    // The chord: never a difference of squares, which cancels.
    let half_squared = (radius - offset.abs()) * (radius + offset.abs());
    if half_squared <= 0.0 {
        return None;
    }
    let half = half_squared.sqrt();
    let middle = -origin.xy().dot(&unit);
    let foot = Vector2::new(unit.y, -unit.x) * offset;
    Some([-half, half].map(|along| {
        let normal = (foot + unit * along) / radius;
        Crossing {
            distance: (middle + along) / length,
            normal: Vector3::new(normal.x, normal.y, 0.0).normalize(),
        }
    }))
}

pub(super) fn cross(
    radius: f64,
    half_length: f64,
    origin: &Vector3<f64>,
    direction: &Vector3<f64>,
) -> Option<[Crossing; 2]> {
    let [mut enter, mut leave] = cross_side(radius, origin, direction)?;
    let d = direction.z;
    if d == 0.0 {
        if origin.z.abs() > half_length {
            return None;
        }
    } else {
        let near = (-half_length.copysign(d) - origin.z) / d;
        let far = (half_length.copysign(d) - origin.z) / d;
        if near > enter.distance {
            enter = Crossing { distance: near, normal: end(-d) };
        }
        if far < leave.distance {
            leave = Crossing { distance: far, normal: end(d) };
        }
    }
    (enter.distance < leave.distance).then_some([enter, leave])
}

pub(super) fn sample(radius: f64, half_length: f64, [u, v, w]: [f64; 3]) -> (Vector3<f64>, Vector3<f64>) {
    let (sin, cos) = (2.0 * PI * v).sin_cos();
    let outward = Vector3::new(cos, sin, 0.0);
    // Areas in units of 2 pi radius.
    let side = 2.0 * half_length;
    let at = u * (side + radius);
    if at < side {
        return (outward * radius + Vector3::z() * (at - half_length), outward);
    }
    let normal = end(at - side - 0.5 * radius);
    (outward * (radius * w.sqrt()) + normal * half_length, normal)
}

pub(super) fn tessellate(radius: f64, half_length: f64) -> Tessellation {
    let mut vertices = vec![Vector3::new(0.0, 0.0, -half_length), Vector3::new(0.0, 0.0, half_length)];
    let mut triangles = Vec::new();
    for i in 0..SEGMENTS {
        let (sin, cos) = (2.0 * PI * i as f64 / SEGMENTS as f64).sin_cos();
        vertices.push(Vector3::new(radius * cos, radius * sin, -half_length));
        vertices.push(Vector3::new(radius * cos, radius * sin, half_length));
        let (a, b) = (2 + 2 * i as u32, 2 + 2 * ((i + 1) % SEGMENTS) as u32);
        triangles.extend([[0, b, a], [1, a + 1, b + 1], [a, b, b + 1], [a, b + 1, a + 1]]);
    }
    (vertices, triangles)
}
