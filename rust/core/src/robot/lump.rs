//! Rigid bodies that move as one.

use nalgebra::{Matrix3, Vector3};

use crate::spatial::Pose;

/// Mass, centre of mass and inertia about it.
pub(crate) type Inertia = (f64, Vector3<f64>, Matrix3<f64>);

/// A rigid body given in a frame that is placed in another, in this other frame.
pub(crate) fn placed((mass, com, inertia): Inertia, placement: &Pose) -> Inertia {
    let rotation = &placement.rotation;
    (mass, placement.transform_point(&com), rotation * inertia * rotation.transpose())
}

/// Two rigid bodies as one, by the parallel axis theorem; without mass the centre stays where the first's is.
pub(crate) fn joined(one: Inertia, other: Inertia) -> Inertia {
    let mass = one.0 + other.0;
    if mass == 0.0 {
        return (0.0, one.1, one.2 + other.2);
    }
    let apart = one.1 - other.1;
    let spread = Matrix3::from_diagonal_element(apart.norm_squared()) - apart * apart.transpose();
    let com = (one.0 * one.1 + other.0 * other.1) / mass;
    (mass, com, one.2 + other.2 + spread * (one.0 * other.0 / mass))
}
