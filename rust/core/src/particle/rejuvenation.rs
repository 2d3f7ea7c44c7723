//! Copies are moved apart along the surface, so that they explain the torques as well as before.

use nalgebra::Vector3;

use super::columns::Slice;
use super::instant::Instant;
use super::motion::{put, signed};
use super::options::Motion;
use super::response::ResponseModel;
use crate::math::random::Stream;
use crate::robot::Robot;
use crate::spatial::basis::across;
use crate::surface::SurfacePoint;

/// Random numbers a particle uses at most.
const DRAWS: u64 = 4;

/// What moving particles apart needs to know.
#[derive(Debug, Clone)]
pub(super) struct Rejuvenation {
    pub motion: Motion,
    /// How far they are moved, a standard deviation [m].
    pub apart: f64,
    /// Whether not only copies are moved.
    pub all: bool,
    pub response_model: ResponseModel,
    /// Whether force and stiffness go along, so that the torque stays.
    pub keep_torque: bool,
    pub stiffness_range: [f64; 2],
    /// Forces are not raised above it [N].
    pub most_force: f64,
    pub random: Stream,
}

impl Rejuvenation {
    /// Moves those that `parents` says are copies (or all), at the present pose; the first one has the number `start`.
    pub fn apply(
        &self,
        robot: &Robot,
        instant: &Instant,
        parents: &[u32],
        start: usize,
        particles: &mut Slice<'_>,
    ) {
        for k in 0..particles.len() {
            let number = start + k;
            let copy = number > 0 && parents[number] == parents[number - 1];
            let Some(surface) = robot.links()[particles.link[k] as usize].surface.as_ref() else { continue };
            if !(copy || self.all) {
                continue;
            }
            let pose = instant.pose(particles.link[k] as usize);
            let [along, beside] = self.random.moderate(number as u64 * DRAWS);
            let aside = tangent(&particles.normal[k], along * self.apart, beside * self.apart);
            if self.motion == Motion::Curvature {
                let local = pose.inverse_transform_point(&particles.centre[k]) + aside;
                let near = surface.closest_point_near(&local, particles.triangle[k]);
                let (distance, normal) = signed(&near, &local);
                particles.centre[k] = pose.transform_point(&local);
                particles.distance[k] = distance;
                put(particles, k, &SurfacePoint { normal, ..near.into() });
            } else {
                let near = surface.closest_point_near(&(particles.point[k] + aside), particles.triangle[k]);
                put(particles, k, &near.into());
            }
            if !self.keep_torque {
                continue;
            }
            let (gain, product) = (particles.gain[k], particles.product[k]);
            let here = self.response_model.apply(instant, particles, k);
            let scale = (here.product * gain) / (here.gain * product);
            if scale > 0.0 && particles.force[k] * scale < self.most_force {
                let [low, high] = self.stiffness_range;
                particles.force[k] *= scale;
                particles.stiffness[k] = (particles.stiffness[k] * scale).clamp(low, high);
                particles.force_variance[k] *= scale * scale;
                particles.cross_variance[k] *= scale * scale;
                particles.stiffness_variance[k] *= scale * scale;
            }
        }
    }
}

/// A vector across `normal`.
pub(crate) fn tangent(normal: &Vector3<f64>, along: f64, beside: f64) -> Vector3<f64> {
    let first = across(normal);
    first * along + normal.cross(&first) * beside
}
