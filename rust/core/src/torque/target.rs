//! A measured external torque, over its noise, as each link's joints feel it.

use super::frames::Frames;

/// Torques over their noise.
#[derive(Debug, Clone)]
pub(crate) struct Target {
    /// By link of the robot: of the velocity variables that move it, in the order of its axes.
    links: Vec<Vec<f64>>,
    /// Squared norm of all of them.
    pub squared: f64,
}

impl Target {
    /// For these frames; all zero.
    pub fn new(frames: &Frames) -> Self {
        Target { links: frames.links.iter().map(|frame| vec![0.0; frame.joints()]).collect(), squared: 0.0 }
    }

    /// Takes on torques with their standard deviations, both one a velocity variable.
    pub fn set(&mut self, frames: &Frames, torque: &[f64], deviation: &[f64]) {
        self.squared = torque.iter().zip(deviation).map(|(torque, noise)| (torque / noise).powi(2)).sum();
        for &link in &frames.wanted {
            for (value, &k) in self.links[link].iter_mut().zip(frames.links[link].variables()) {
                *value = torque[k] / deviation[k];
            }
        }
    }

    /// What the joints feel that move a link.
    #[inline]
    pub fn on(&self, link: usize) -> &[f64] {
        &self.links[link]
    }

    /// Takes on another one of the same frames.
    pub fn copy(&mut self, other: &Target, wanted: &[usize]) {
        for &link in wanted {
            self.links[link].copy_from_slice(&other.links[link]);
        }
        self.squared = other.squared;
    }
}
