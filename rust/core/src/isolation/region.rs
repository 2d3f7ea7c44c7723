//! The parts of the robot whose contacts are solved for together: everything, or what lies between sensors.

use crate::robot::{LinkIndex, Robot, WORLD};
use crate::sensor::SensorTree;

/// Joints whose torque counts, and links that may be touched.
#[derive(Debug, Clone)]
pub(super) struct Region {
    /// By body: its joint's torque counts.
    pub joints: Vec<bool>,
    /// By velocity variable: the same.
    pub feels: Vec<bool>,
    /// By link.
    pub links: Vec<bool>,
    /// All of the robot.
    pub whole: bool,
    /// A wanted contact may act here that no sensor measures: nothing can be told of others.
    pub unknown: bool,
}

impl Region {
    pub fn whole(robot: &Robot) -> Self {
        Self {
            joints: vec![true; robot.body_count()],
            feels: vec![true; robot.nv()],
            links: vec![true; robot.links().len()],
            whole: true,
            unknown: false,
        }
    }

    /// What loads a sensor directly; none: what no sensor in use carries.
    fn set(&mut self, robot: &Robot, tree: &SensorTree, sensor: Option<usize>) {
        self.whole = tree.is_empty();
        for body in WORLD + 1..robot.body_count() {
            self.joints[body] = tree.before_joint(body) == sensor;
            self.feels[robot.velocity_range(body)].fill(self.joints[body]);
        }
        for (link, member) in self.links.iter_mut().enumerate() {
            *member = tree.of_link(link) == sensor;
        }
    }

    /// The joints from the region's root to `body`.
    pub fn chain<'a>(&'a self, robot: &'a Robot, body: usize) -> impl DoubleEndedIterator<Item = usize> + 'a {
        robot.chain(body).iter().copied().filter(|joint| self.joints[*joint])
    }

    /// The touchable links of a body in this region.
    pub fn links_of<'a>(&'a self, robot: &'a Robot, body: usize) -> impl Iterator<Item = LinkIndex> + 'a {
        robot.links_of_body(body).iter().copied().filter(|link| self.links[link.get()])
    }
}

/// The region of each sensor, and of what no sensor carries.
#[derive(Debug, Clone)]
pub(super) struct Regions {
    pub tree: SensorTree,
    /// Which sensors' contacts are meant, those behind such sensors included.
    pub wanted: Vec<bool>,
    pub base: Region,
    pub behind: Vec<Region>,
}

impl Regions {
    pub fn new(robot: &Robot, tree: SensorTree, wanted: Vec<bool>) -> Self {
        let whole = Region::whole(robot);
        let mut regions = Self { behind: vec![whole.clone(); tree.len()], base: whole, wanted, tree };
        regions.divide(robot);
        regions
    }

    /// Leaves out the sensors that are false in `active`.
    pub fn set_active(&mut self, robot: &Robot, active: &[bool]) {
        let before = |sensor| self.tree.is_active(sensor);
        if (0..active.len()).any(|sensor| before(sensor) != active[sensor]) {
            self.tree.set_active(active);
            self.divide(robot);
        }
    }

    /// Leaves out the torques of some velocity variables until [`Regions::restore`].
    pub fn leave_out(&mut self, robot: &Robot, left_out: &[bool]) {
        for region in std::iter::once(&mut self.base).chain(&mut self.behind) {
            for body in WORLD + 1..robot.body_count() {
                let range = robot.velocity_range(body);
                if left_out[range.clone()].contains(&true) {
                    region.joints[body] = false;
                    region.feels[range].fill(false);
                }
            }
        }
    }

    /// All torques count again.
    pub fn restore(&mut self, robot: &Robot) {
        self.divide(robot);
    }

    fn divide(&mut self, robot: &Robot) {
        let Self { tree, wanted, base, behind } = self;
        base.set(robot, tree, None);
        base.unknown = false;
        for (sensor, region) in behind.iter_mut().enumerate() {
            region.set(robot, tree, Some(sensor));
            region.unknown = false;
        }
        for sensor in (0..tree.len()).filter(|sensor| wanted[*sensor] && !tree.is_active(*sensor)) {
            match tree.parent(sensor) {
                Some(carrier) => behind[carrier].unknown = true,
                None => base.unknown = true,
            }
        }
    }
}
