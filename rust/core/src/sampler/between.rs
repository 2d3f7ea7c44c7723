//! What relates the torques of forces on two links, at one pose.

use nalgebra::Matrix6;

use crate::torque::Frame;

/// For each two of the links that are looked on, what relates the torques of wrenches on them ([`Frame::between`]).
#[derive(Debug, Clone)]
pub(super) struct Between {
    /// By link of the robot: its number among those that are looked on.
    number: Vec<usize>,
    wanted: usize,
    all: Vec<Matrix6<f64>>,
}

impl Between {
    pub fn new(links: usize, wanted: &[usize]) -> Self {
        let mut number = vec![0; links];
        wanted.iter().enumerate().for_each(|(k, link)| number[*link] = k);
        let count = wanted.len();
        Between { number, wanted: count, all: vec![Matrix6::zeros(); count * count] }
    }

    pub fn set(&mut self, links: &[Frame], wanted: &[usize]) {
        for (i, first) in wanted.iter().enumerate() {
            for (j, second) in wanted.iter().enumerate().skip(i) {
                let between = links[*first].between(&links[*second]);
                self.all[i * self.wanted + j] = between;
                self.all[j * self.wanted + i] = between.transpose();
            }
        }
    }

    /// Of two links of the robot.
    pub fn of(&self, first: usize, second: usize) -> &Matrix6<f64> {
        &self.all[self.number[first] * self.wanted + self.number[second]]
    }
}
