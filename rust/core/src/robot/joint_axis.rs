//! Motion axes of joints and products of spatial vectors, about the reference origin, linear part first.

use nalgebra::{Vector3, Vector6};

use super::description::JointKind;
use super::kinematics::BodyState;
use crate::spatial::vector::{split, stack};

/// The motion axis of a joint's `column` (0 but for a free flyer).
#[inline]
pub(crate) fn motion_axis(kind: JointKind, state: &BodyState, column: usize) -> Vector6<f64> {
    match kind {
        JointKind::Revolute | JointKind::Continuous => {
            let axis = state.axis();
            stack(&state.position.cross(&axis), &axis)
        }
        JointKind::Prismatic => stack(&state.axis(), &Vector3::zeros()),
        JointKind::FreeFlyer => {
            let axis = state.rotation.column(column % 3).into_owned();
            if column < 3 {
                stack(&axis, &Vector3::zeros())
            } else {
                stack(&state.position.cross(&axis), &axis)
            }
        }
    }
}

/// Rate of a motion vector fixed in a body that moves: `V x motion`.
#[inline]
pub(crate) fn cross_motion(state: &BodyState, motion: &Vector6<f64>) -> Vector6<f64> {
    let (linear, angular) = split(motion);
    stack(&(state.angular.cross(&linear) + state.linear.cross(&angular)), &state.angular.cross(&angular))
}

/// Rate of a force vector fixed in a body that moves: `V x* force`.
#[inline]
pub(crate) fn cross_force(
    state: &BodyState,
    force: &Vector3<f64>,
    moment: &Vector3<f64>,
) -> (Vector3<f64>, Vector3<f64>) {
    (state.angular.cross(force), state.angular.cross(moment) + state.linear.cross(force))
}
