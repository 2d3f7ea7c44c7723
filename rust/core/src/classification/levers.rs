//! How far a robot reaches behind each joint.

use crate::robot::{JointKind, Robot};

/// Added to the way from a joint to the last one behind it: the length of a hand (m).
const HAND: f64 = 0.1;

/// How far the parts behind each joint reach.
pub(super) fn levers(robot: &Robot) -> Vec<f64> {
    let count = robot.body_count();
    let mut reach = vec![0.0_f64; count];
    for body in (1..count).rev() {
        let parent = robot.bodies[body].parent;
        reach[parent] = reach[parent].max(robot.bodies[body].placement.translation.norm() + reach[body]);
    }
    let mut levers = vec![1.0; robot.nv()];
    for (body, reach) in reach.iter().enumerate().skip(1) {
        let range = robot.velocity_range(body);
        let turning = match robot.bodies[body].kind {
            JointKind::FreeFlyer => range.start + 3..range.end,
            JointKind::Prismatic => range.end..range.end,
            JointKind::Revolute | JointKind::Continuous => range,
        };
        levers[turning].fill(reach + HAND);
    }
    levers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lever_is_the_length_of_the_arm_behind_a_joint() {
        let levers = levers(&Robot::example_arm());
        // Seven joints 0.3 m apart.
        for (joint, lever) in levers.iter().enumerate() {
            assert!((lever - (0.3 * (6 - joint) as f64 + HAND)).abs() < 1e-9, "joint {joint}: {lever}");
        }
    }
}
