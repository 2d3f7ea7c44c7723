//! The last poses of the robot, and the torques that were measured at them.

use super::instant::Instant;
use super::step_noise::NEW_POSE;
use crate::torque::{Frame, Target};

/// Poses that are kept: some eight motions of three samples, which tell a push on a link moved by two joints only from
/// what is none.
pub(super) const POSES: usize = 24;

/// A pose of the robot, with the torques measured there.
#[derive(Debug, Clone)]
pub(super) struct Sample {
    /// One a link of the robot, set for those that can be in contact.
    pub links: Vec<Frame>,
    /// The measured torques over their noise.
    pub target: Target,
    /// Squared norm of what the best push left over when it was measured, in stated noise.
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
    pub fn new(instant: &Instant) -> Self {
        let sample =
            Sample { links: instant.frames.links.clone(), target: instant.target.clone(), left: 0.0 };
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
        self.samples[self.newest].links[link].rows().len()
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
    pub fn take_in(&mut self, instant: &Instant, link: usize, left: f64) -> bool {
        let opened = self.len < 2 || {
            let [newest, before] =
                [self.newest, self.before()].map(|place| &self.samples[place].links[link].pose);
            instant.apart(link, newest, before) >= NEW_POSE
        };
        if opened {
            self.newest = if self.len == 0 { 0 } else { (self.newest + 1) % POSES };
            self.len = (self.len + 1).min(POSES);
        }
        let sample = &mut self.samples[self.newest];
        for &link in &instant.frames.wanted {
            sample.links[link].copy(&instant.frames.links[link]);
        }
        sample.target.copy(&instant.target, &instant.frames.wanted);
        sample.left = left;
        opened
    }
}
