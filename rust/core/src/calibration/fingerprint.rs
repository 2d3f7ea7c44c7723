//! Whether two robots have the same joints and inertias.

use crate::robot::{JointKind, Robot};

/// Fowler, Noll and Vo's hash of 64 bits.
const OFFSET: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0000_0100_0000_01b3;

/// Of the joints' names, kinds and places and the bodies' inertias, to six digits; a floating base is left out, so that a
/// robot calibrated with its base held is the same robot when it walks.
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
        let place = body.placement.translation.iter().chain(body.placement.rotation.iter());
        let numbers = place.chain(body.com.iter()).chain(body.inertia.iter()).chain([&body.mass]);
        for number in numbers {
            // No difference between 0 and -0, nor between numbers that rounding makes of 0.
            let rounded = if number.abs() < 1e-9 { 0.0 } else { *number };
            add(&format!("{rounded:.5e}"));
        }
    }
    format!("{hash:016x}")
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
