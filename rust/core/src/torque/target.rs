//! A measured external torque, with the wrenches of sensors where there are any, over its noise, as the rows feel it that each
//! link moves or loads.

use nalgebra::Vector6;

use super::frames::Frames;
use super::link_target::LinkTarget;

/// Torques over their noise.
#[derive(Debug, Clone)]
pub(crate) struct Target {
    /// By link of the robot.
    links: Vec<LinkTarget>,
    /// Squared norm of all torques.
    pub squared: f64,
}

impl Target {
    /// For these frames; all zero.
    pub fn new(frames: &Frames) -> Self {
        let link = |rows| LinkTarget { torque: vec![0.0; rows], product: Vector6::zeros(), squared: 0.0 };
        Target { links: frames.links.iter().map(|frame| link(frame.rows().len())).collect(), squared: 0.0 }
    }

    /// Takes on the rows of a measurement with their standard deviations.
    pub fn set(&mut self, frames: &Frames, torque: &[f64], deviation: &[f64]) {
        self.set_on(&frames.wanted, frames, torque, deviation);
    }

    /// The same for some links.
    pub fn set_on(&mut self, links: &[usize], frames: &Frames, torque: &[f64], deviation: &[f64]) {
        self.squared = torque.iter().zip(deviation).map(|(torque, noise)| (torque / noise).powi(2)).sum();
        for &link in links {
            let (frame, target) = (&frames.links[link], &mut self.links[link]);
            let LinkTarget { torque: own, product, squared } = target;
            (*product, *squared) = (Vector6::zeros(), 0.0);
            for (axis, (value, &k)) in own.iter_mut().zip(frame.rows()).enumerate() {
                *value = torque[k] / deviation[k];
                *product += frame.column(axis) * *value;
                *squared += *value * *value;
            }
        }
    }

    /// What the joints feel that move a link.
    #[inline]
    pub fn on(&self, link: usize) -> &LinkTarget {
        &self.links[link]
    }

    /// Takes on another one of the same frames.
    pub fn copy(&mut self, other: &Target, wanted: &[usize]) {
        for &link in wanted {
            self.links[link].torque.copy_from_slice(&other.links[link].torque);
            self.links[link].product = other.links[link].product;
            self.links[link].squared = other.links[link].squared;
        }
        self.squared = other.squared;
    }
}
