//! A box around the origin.

use nalgebra::Vector3;

use super::elements::{Crossing, Nearest, Tessellation};

fn face(axis: usize, sign: f64) -> Vector3<f64> {
    let mut normal = Vector3::zeros();
    normal[axis] = 1f64.copysign(sign);
    normal
}

pub(super) fn closest(half: &Vector3<f64>, p: &Vector3<f64>) -> Nearest {
    let over = p.abs() - half;
    let axis = over.imax();
    let mut point = p.zip_map(half, |x, h| x.clamp(-h, h));
    let signed_distance = if over[axis] > 0.0 {
        (p - point).norm()
    } else {
        point[axis] = half[axis].copysign(p[axis]);
        over[axis]
    };
    Nearest { point, normal: face(axis, p[axis]), signed_distance }
}

pub(super) fn cross(
    half: &Vector3<f64>,
    origin: &Vector3<f64>,
    direction: &Vector3<f64>,
) -> Option<[Crossing; 2]> {
    let mut enter = Crossing { distance: f64::NEG_INFINITY, normal: Vector3::zeros() };
    let mut leave = Crossing { distance: f64::INFINITY, normal: Vector3::zeros() };
    for axis in 0..3 {
        let d = direction[axis];
        if d == 0.0 {
            if origin[axis].abs() > half[axis] {
                return None;
            }
            continue;
        }
        let near = (-half[axis].copysign(d) - origin[axis]) / d;
        let far = (half[axis].copysign(d) - origin[axis]) / d;
        if near > enter.distance {
            enter = Crossing { distance: near, normal: face(axis, -d) };
        }
        if far < leave.distance {
            leave = Crossing { distance: far, normal: face(axis, d) };
        }
    }
    (enter.distance < leave.distance).then_some([enter, leave])
}

pub(super) fn sample(half: &Vector3<f64>, [u, v, w]: [f64; 3]) -> (Vector3<f64>, Vector3<f64>) {
    let areas = [half.y * half.z, half.z * half.x, half.x * half.y];
    let mut at = u * (areas[0] + areas[1] + areas[2]) * 2.0;
    let mut axis = 0;
    while axis < 2 && at >= 2.0 * areas[axis] {
        at -= 2.0 * areas[axis];
        axis += 1;
    }
    let normal = face(axis, at - areas[axis]);
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut point = normal.component_mul(half);
    point[j] = (2.0 * v - 1.0) * half[j];
    point[k] = (2.0 * w - 1.0) * half[k];
    (point, normal)
}

pub(super) fn tessellate(half: &Vector3<f64>) -> Tessellation {
    let vertices = (0..8)
        .map(|i| {
            half.zip_map(&Vector3::new(i & 1, i >> 1 & 1, i >> 2), |h, high| if high == 1 { h } else { -h })
        })
        .collect();
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    (vertices, quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}
