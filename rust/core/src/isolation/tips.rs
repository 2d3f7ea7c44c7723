//! The last body over its threshold on every branch (Vorndamme 2017, eq. 22 on a tree).

use crate::robot::{Robot, WORLD};

/// Finds the bodies whose joint feels a contact while no joint behind it does.
#[derive(Debug, Clone)]
pub(crate) struct TipSearch {
    felt_behind: Vec<bool>,
    tips: Vec<usize>,
}

impl TipSearch {
    /// Space for a robot's bodies.
    pub fn new(robot: &Robot) -> Self {
        let count = robot.body_count();
        Self { felt_behind: vec![false; count], tips: Vec::with_capacity(count) }
    }

    /// The tips, farthest from the base first; `over(k)` tells whether velocity variable k is over its threshold.
    pub fn find(&mut self, robot: &Robot, over: impl Fn(usize) -> bool) -> &[usize] {
        self.felt_behind.fill(false);
        self.tips.clear();
        for body in (1..robot.body_count()).rev() {
            let felt = robot.velocity_range(body).any(&over);
            if felt && !self.felt_behind[body] {
                self.tips.push(body);
            }
            let parent = robot.parent_body(body);
            if (felt || self.felt_behind[body]) && parent != WORLD {
                self.felt_behind[parent] = true;
            }
        }
        &self.tips
    }

    /// The tips of the last search.
    pub fn tips(&self) -> &[usize] {
        &self.tips
    }
}
