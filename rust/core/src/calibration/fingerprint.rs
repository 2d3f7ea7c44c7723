//! Whether two robots have the same joints and inertias.

use crate::robot::{JointKind, Robot};

/// Fowler, Noll and Vo's hash of 64 bits.
const OFFSET: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0000_0100_0000_01b3;

/// Of a length (m), and of an entry of a rotation matrix: what differs by more is another robot.
const PLACE_STEP: f64 = 1e-6;
/// Of a mass, and of the size of an inertia: shares.
const INERTIA_STEP: f64 = 1e-5;
/// Descriptions hold decimal numbers, and readers round them differently: with steps that begin at a number which is no
/// decimal, rounding does not change the step (share of a step).
const OFFSET_OF_STEPS: f64 = std::f64::consts::FRAC_1_PI;

/// Of the joints' names, kinds and places and the bodies' inertias, coarsely, so that all readers of a description give the
/// same; a floating base is left out, so that a robot calibrated with its base held is the same robot when it walks.
pub(super) fn fingerprint(robot: &Robot) -> String {
    let mut hash = OFFSET;
    let mut add = |text: &str| {
        for byte in text.bytes().chain([0]) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(PRIME);
        }
    };
    for (body, name) in robot.bodies[1..].iter().zip(robot.joint_names()) {
        if body.kind == JointKind::FreeFlyer {
            continue;
        }
        add(name);
        add(body.kind.name());
        let places =
            body.placement.translation.iter().chain(body.placement.rotation.iter()).chain(body.com.iter());
        for place in places {
            add(&steps(*place, PLACE_STEP));
        }
        let size = body.inertia.trace();
        // Entries are beside the size: those of a small body tell it from another one, too, and those that only rounding
        // makes other than zero do not.
        let magnitude = steps(size.ln(), INERTIA_STEP);
        let entries =
            body.inertia.iter().map(|entry| steps(if size > 0.0 { entry / size } else { 0.0 }, INERTIA_STEP));
        for text in [steps(body.mass.ln(), INERTIA_STEP), magnitude].into_iter().chain(entries) {
            add(&text);
        }
    }
    format!("{hash:016x}")
}

/// The number of the step that a number lies in.
fn steps(number: f64, step: f64) -> String {
    let count = (number / step + OFFSET_OF_STEPS).floor();
    // No difference between 0 and -0.
    format!("{}", count + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_tells_robots_apart_by_inertia_and_name() {
        let arm = Robot::example_arm();
        assert_eq!(fingerprint(&arm), fingerprint(&arm.clone()));
        let mut heavier = arm.clone();
        heavier.bodies[3].mass *= 1.01;
        assert_ne!(fingerprint(&arm), fingerprint(&heavier));
    }
}
