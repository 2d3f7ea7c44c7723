//! The last poses of the robot, and the torques that were measured at them.

use super::frames::{Frame, Frames};
use super::schedule::NEW_POSE;

/// Poses that are kept: some eight motions of three samples, which tell a push on a link moved by two joints only from
/// what is none.
pub(super) const POSES: usize = 24;

/// A pose of the robot, with the torques measured there.
#[derive(Debug, Clone)]
pub(super) struct Sample {
    /// One a link of the robot, set for those that can be in contact.
    pub links: Vec<Frame>,
    /// Squared norm of the measured torques, each over its noise.
    pub measured: f64,
    /// What the best push left over when it was measured, likewise, in stated noise.
    pub left: f64,
}

/// A ring of samples: each but the newest is a new pose against the one before it.
#[derive(Debug, Clone)]
pub(super) struct Window {
    samples: Vec<Sample>,
    len: usize,
    newest: usize,
}

impl Window {
    pub fn new(frames: &Frames) -> Self {
        let sample = Sample { links: frames.links.clone(), measured: 0.0, left: 0.0 };
        Window { samples: vec![sample; POSES], len: 0, newest: 0 }
    }

    /// Forgets all samples.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    pub fn len(&self) -> usize {
        self.len
    }

    /// Those that are held, not in the order of time.
    pub fn samples(&self) -> &[Sample] {
        &self.samples[..self.len]
    }

    /// How many joints move a link.
    pub fn chain(&self, link: usize) -> usize {
        self.samples[self.newest].links[link].joints()
    }

    /// Place of the newest one among them.
    pub fn newest(&self) -> usize {
        self.newest
    }

    /// Place of the one before the newest.
    pub fn before(&self) -> usize {
        (self.newest + POSES - 1) % POSES
    }

    /// Takes in the present pose: beside the newest sample where that is a new pose of a link, in its place otherwise.
    /// Returns whether it is beside the others.
    pub fn take_in(&mut self, frames: &Frames, link: usize, left: f64) -> bool {
        let opened = self.len < 2 || {
            let [newest, before] = [self.newest, self.before()].map(|place| &self.samples[place].links[link]);
            newest.apart(&before.pose) >= NEW_POSE
        };
        if opened {
            self.newest = if self.len == 0 { 0 } else { (self.newest + 1) % POSES };
            self.len = (self.len + 1).min(POSES);
        }
        let sample = &mut self.samples[self.newest];
        for &link in &frames.wanted {
            sample.links[link].copy(&frames.links[link]);
        }
        (sample.measured, sample.left) = (frames.measured, left);
        opened
    }
}
