//! The force of a push at a given point that explains torques best.

use nalgebra::Vector3;

use super::force_model::{across, ForceModel};
use super::frames::{Frame, Frames};
use crate::robot::Robot;

/// A force on a link, in its frame [N].
#[derive(Debug, Clone, Copy)]
pub(super) struct BestForce {
    pub force: Vector3<f64>,
    /// Its part along the inward normal, never negative: a push does not pull [N].
    pub normal: f64,
    /// Variance of that part by the stated noise, infinite where no torque shows it [N^2].
    pub variance: f64,
    /// Its parts across the normal, over their standard deviations.
    pub across: [f64; 2],
}

impl BestForce {
    /// At a point of a link, with its outward normal (both in the link's frame).
    pub fn of(
        frame: &Frame,
        force_model: ForceModel,
        point: &Vector3<f64>,
        normal: &Vector3<f64>,
    ) -> BestForce {
        let (gain, product) = frame.response(point, normal);
        let size = if gain > 0.0 && product > 0.0 { product / gain } else { 0.0 };
        let variance = gain.recip();
        let bare = BestForce { force: -normal * size, normal: size, variance, across: [0.0; 2] };
        match force_model {
            ForceModel::FrictionCone(friction) if size > 0.0 => {
                bare.with_friction(frame, friction, point, normal).unwrap_or(bare)
            }
            _ => bare,
        }
    }

    /// Where the part across the normal is Gaussian, as for the particles.
    fn with_friction(
        &self,
        frame: &Frame,
        friction: f64,
        point: &Vector3<f64>,
        normal: &Vector3<f64>,
    ) -> Option<BestForce> {
        let first = across(normal);
        let directions = [-normal, first, normal.cross(&first)];
        let (mut gram, products) = frame.responses(point, &directions);
        let deviation = 0.5 * friction * self.normal;
        gram[(1, 1)] += deviation.powi(-2);
        gram[(2, 2)] += deviation.powi(-2);
        let inverse = gram.try_inverse()?;
        let found = inverse * products;
        let usable = found[0] > 0.0 && inverse[(0, 0)] > 0.0 && found.iter().all(|x| x.is_finite());
        usable.then(|| BestForce {
            force: directions[0] * found[0] + directions[1] * found[1] + directions[2] * found[2],
            normal: found[0],
            variance: inverse[(0, 0)],
            across: [found[1] / deviation, found[2] / deviation],
        })
    }
}

/// A push on a link: point and outward normal in the link's frame.
#[derive(Clone, Copy)]
pub(super) struct Push<'a> {
    pub robot: &'a Robot,
    pub frames: &'a Frames,
    pub force_model: ForceModel,
    pub link: usize,
    pub point: Vector3<f64>,
    pub normal: Vector3<f64>,
}

impl Push<'_> {
    /// Takes from the torques what the best force of this push does.
    pub fn subtract(&self, torque: &mut [f64]) {
        let frame = &self.frames.links[self.link];
        let best = BestForce::of(frame, self.force_model, &self.point, &self.normal);
        self.frames.subtract(self.robot, self.link, &self.point, &best.force, torque);
    }
}
