//! The part of the robot whose contacts one solution explains: everything, or what lies between sensors.

use crate::robot::Robot;

/// Joints whose torque counts, and links that may be touched.
#[derive(Debug, Clone)]
pub(super) struct Region {
    /// By body: its joint's torque counts.
    pub joints: Vec<bool>,
    /// By link.
    pub links: Vec<bool>,
}

impl Region {
    pub fn whole(robot: &Robot) -> Self {
        Self { joints: vec![true; robot.body_count()], links: vec![true; robot.links().len()] }
    }

    /// The joints from the region's root to `body`.
    pub fn chain<'a>(&'a self, robot: &'a Robot, body: usize) -> impl DoubleEndedIterator<Item = usize> + 'a {
        robot.chain(body).iter().copied().filter(|joint| self.joints[*joint])
    }

    /// The touchable links of a body in this region.
    pub fn links_of<'a>(&'a self, robot: &'a Robot, body: usize) -> impl Iterator<Item = usize> + 'a {
        robot.links_of_body(body).iter().copied().filter(|link| self.links[*link])
    }
}
