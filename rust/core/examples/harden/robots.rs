//! Robots, and arguments that are of one.

use contactsense::robot::{JointKind, LinkIndex, Robot, RobotDescription};
use contactsense::sensor::ForceTorqueSensor;
use contactsense::Result;

use crate::random::Random;

/// The example arm with joints of other kinds: a floating base, a turning joint without limits, a sliding one.
pub fn any_robot(random: &mut Random) -> Result<Robot> {
    let mut description = RobotDescription::example_arm();
    for (k, kind) in [(0, JointKind::FreeFlyer), (2, JointKind::Continuous), (3, JointKind::Prismatic)] {
        if random.once_in(3) {
            description.joints[k].kind = kind;
        }
    }
    if random.once_in(2) {
        (description.joints[5].lower, description.joints[5].upper) = (Some(-2.0), Some(2.0));
    }
    Robot::new(description)
}

/// A position, often valid: quaternions, and cosines with sines, are then of length one.
pub fn configuration(robot: &Robot, random: &mut Random) -> Vec<f64> {
    let mut q = random.vector(robot.nq());
    if q.len() != robot.nq() || random.once_in(20) {
        return q;
    }
    let mut first = 0;
    for joint in robot.joint_kinds() {
        let turn = match joint {
            JointKind::FreeFlyer => &mut q[first + 3..first + 7],
            JointKind::Continuous => &mut q[first..first + 2],
            JointKind::Revolute | JointKind::Prismatic => &mut [][..],
        };
        first += joint.nq();
        let length = turn.iter().map(|x| x * x).sum::<f64>().sqrt();
        turn.iter_mut().for_each(|x| *x /= length);
    }
    q
}

/// Any link; that a robot has it is not certain.
pub fn link(robot: &Robot, random: &mut Random) -> LinkIndex {
    let most = robot.links().len() + usize::from(random.once_in(4)) * 3;
    LinkIndex::new(random.below(most))
}

pub fn sensor(robot: &Robot) -> ForceTorqueSensor {
    ForceTorqueSensor::new(
        "wrist",
        robot[robot.touchable_links()[robot.touchable_links().len() - 1]].name.clone(),
    )
}
