//! The pieces of the surface that the posterior is made of: samples, and ever smaller parts of those that matter.

use nalgebra::Vector3;

use crate::posterior::{ContactSample, ContactSamples};
use crate::surface::SurfacePoint;
use crate::torque::PIECE;

/// A piece of a link's surface with a contact that pushes or pulls there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leaf {
    /// Index into the robot's links.
    pub link: usize,
    pub place: SurfacePoint,
    /// (m^2).
    pub area: f64,
    pub pulls: bool,
    /// Logarithm of its share of the posterior, not normalised.
    pub log_weight: f64,
    /// Size of the normal force of the newest measurement (N).
    pub force: f64,
    /// Root mean square of the distance of the contact from the place, if it is on this piece (m).
    pub spread: f64,
}

impl ContactSamples for Vec<Leaf> {
    #[inline]
    fn sample(&self, k: usize) -> ContactSample {
        let Leaf { link, place, force, pulls, .. } = &self[k];
        let outward = if *pulls { *force } else { -force };
        ContactSample {
            link: *link,
            point: place.point,
            normal: place.normal,
            force: place.normal * outward,
            stiffness: 0.0,
        }
    }
}

impl Leaf {
    /// Root mean square of the distance from the middle of a piece of an area (m^2), by the prior.
    pub fn width(area: f64) -> f64 {
        std::f64::consts::SQRT_2 * PIECE * area.sqrt()
    }

    /// Middles of its four parts, in the plane of the surface.
    pub fn quarters(&self) -> [Vector3<f64>; 4] {
        let first = crate::spatial::basis::across(&self.place.normal);
        let second = self.place.normal.cross(&first);
        let aside = 0.25 * self.area.sqrt();
        [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)]
            .map(|(a, b)| self.place.point + (first * a + second * b) * aside)
    }
}
