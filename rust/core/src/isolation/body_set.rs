//! The bodies that can carry a contact, given what the joints behind the contact body do not feel
//! (Vorndamme 2017, the correction after step 4).

use super::found::Scene;
use super::region::Region;
use super::wrench::{WrenchEstimate, ORIGIN};
use crate::robot::jacobian::jacobian_column;
use crate::robot::{LinkIndex, Robot};

/// A set of bodies, grown from a contact body away from the base.
#[derive(Debug, Clone)]
pub(super) struct BodySet {
    member: Vec<bool>,
}

impl BodySet {
    pub fn new(robot: &Robot) -> Self {
        Self { member: vec![false; robot.body_count()] }
    }

    /// `first`, and every body behind it whose joints would not feel `wrench` more than they do.
    pub fn grow(
        &mut self,
        scene: Scene,
        first: usize,
        wrench: &WrenchEstimate,
        torque: &[f64],
        threshold: &[f64],
    ) {
        let Scene { robot, kinematics, region } = scene;
        self.fill(robot, region, first, |body| {
            robot.velocity_range(body).enumerate().all(|(column, k)| {
                let axis = jacobian_column(robot, kinematics, body, column, &ORIGIN);
                (wrench.torque_on(&axis) - torque[k]).abs() <= threshold[k]
            })
        });
    }

    /// `first` and every body behind it.
    pub fn grow_all(&mut self, robot: &Robot, region: &Region, first: usize) {
        self.fill(robot, region, first, |_| true);
    }

    /// Every body, or none.
    pub fn set_all(&mut self, member: bool) {
        self.member.fill(member);
    }

    /// `first`, and every body behind a member that `joins`.
    fn fill(&mut self, robot: &Robot, region: &Region, first: usize, joins: impl Fn(usize) -> bool) {
        self.member.fill(false);
        self.member[first] = true;
        for body in first + 1..robot.body_count() {
            self.member[body] = self.member[robot.parent_body(body)] && region.joints[body] && joins(body);
        }
    }

    /// The touchable links on these bodies, nearest to the base first.
    pub fn links<'a>(&'a self, robot: &'a Robot, region: &'a Region) -> impl Iterator<Item = LinkIndex> + 'a {
        let members = self.member.iter().enumerate().filter(|(_, member)| **member);
        members.flat_map(|(body, _)| region.links_of(robot, body))
    }
}
