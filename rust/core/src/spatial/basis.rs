//! Directions that go with a given one.

use nalgebra::Vector3;

/// A unit vector across a direction, which need not be a unit vector.
#[inline]
pub(crate) fn across(direction: &Vector3<f64>) -> Vector3<f64> {
    // Not across an axis that is nearly the direction itself.
    let apart = if direction.x.abs() < 0.8 { Vector3::x() } else { Vector3::y() };
    direction.cross(&apart).normalize()
}
