//! What every primitive is described by: its nearest point, crossings, and triangles.

use nalgebra::Vector3;

/// Segments of a full circle in a tessellation.
pub(super) const SEGMENTS: usize = 48;

/// The nearest point of a primitive.
pub(super) struct Nearest {
    pub point: Vector3<f64>,
    pub normal: Vector3<f64>,
    /// Negative inside.
    pub signed_distance: f64,
}

/// Where a line goes in or comes out.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    pub distance: f64,
    pub normal: Vector3<f64>,
}

/// Triangles for display.
pub(super) type Tessellation = (Vec<Vector3<f64>>, Vec<[u32; 3]>);

/// The direction of `v`, or `otherwise` at zero.
#[inline]
pub(super) fn direction_or(v: &Vector3<f64>, otherwise: Vector3<f64>) -> Vector3<f64> {
    let norm = v.norm();
    if norm > f64::MIN_POSITIVE {
        v / norm
    } else {
        otherwise
    }
}

/// The outward normal of the end of a shape along z on whose side `z` lies.
#[inline]
pub(super) fn end(z: f64) -> Vector3<f64> {
    Vector3::new(0.0, 0.0, if z < 0.0 { -1.0 } else { 1.0 })
}
