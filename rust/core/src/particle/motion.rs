//! How a particle moves with the robot: three models.

use nalgebra::Vector3;

use super::columns::Slice;
use super::instant::Instant;
use super::options::Motion;
use super::response::ResponseModel;
use super::step_noise::StepNoise;
use crate::math::random::Stream;
use crate::robot::Robot;
use crate::surface::{ClosestPoint, Surface, SurfacePoint};

/// Random numbers a particle and step uses at most.
const DRAWS: u64 = 4;
/// Every so many steps the nearest point is looked for on the whole link, in between next to the last one; and it is
/// seen whether the point is hidden inside another part of the link.
const REFRESH: u64 = 32;

/// What a step of motion needs to know.
#[derive(Debug, Clone)]
pub(super) struct Move {
    pub motion: Motion,
    /// Logarithms of the least and the greatest radius.
    pub log_radius: [f64; 2],
    pub response_model: ResponseModel,
    pub noise: StepNoise,
    /// Standard deviation of the force of particles that are not tied to an obstacle [N].
    pub loose_force: f64,
    pub stiffness_range: [f64; 2],
    /// Whether a force is drawn from what is believed of it, and the stiffness moved at random.
    pub sampled: bool,
    pub random: Stream,
    pub step: u64,
}

impl Move {
    /// Moves particles, of which the first has the number `start`, to the present pose.
    pub fn apply(&self, robot: &Robot, instant: &Instant, start: usize, particles: &mut Slice<'_>) {
        for k in 0..particles.len() {
            let Some(surface) = robot.links()[particles.link[k] as usize].surface.as_ref() else { continue };
            let number = (start + k) as u64;
            match self.motion {
                Motion::Curvature => self.roll(surface, instant, number, particles, k),
                Motion::FixedOnLink => self.stay_on_link(surface, number, particles, k),
                Motion::FixedInWorld => self.stay_in_world(surface, instant, number, particles, k),
            }
            self.response_model.apply(instant, particles, k);
            if self.sampled {
                self.draw(number, particles, k);
            }
        }
    }

    /// Draws force and stiffness at random (Bimbo 2019, after eq. 8).
    fn draw(&self, number: u64, particles: &mut Slice<'_>, k: usize) {
        let [force, stiffness] = self.random.normals(number * DRAWS + 2);
        let [low, high] = self.stiffness_range;
        particles.force[k] += force * particles.force_variance[k].sqrt();
        particles.force_variance[k] = 0.0;
        particles.stiffness[k] =
            (particles.stiffness[k] * (self.noise.stiffness * stiffness).exp()).clamp(low, high);
    }

    /// The obstacle stays, and the contact is the point nearest to its centre of curvature (Bimbo 2019, eq. 8).
    fn roll(&self, surface: &Surface, instant: &Instant, number: u64, particles: &mut Slice<'_>, k: usize) {
        let link = particles.link[k] as usize;
        let draw = number * DRAWS;
        let whole = (number + self.step).is_multiple_of(REFRESH);
        if self.random.uniform(draw) < self.noise.redraw {
            let [low, high] = self.log_radius;
            let radius = (low + (high - low) * self.random.uniform(draw + 1)).exp();
            let centre = particles.point[k] + particles.normal[k] * radius;
            particles.centre[k] = instant.before(link).transform_point(&centre);
            particles.distance[k] = radius;
        }
        let local = instant.pose(link).inverse_transform_point(&particles.centre[k]);
        let triangle = particles.triangle[k];
        let near = if whole {
            surface.closest_point_from(&local, triangle)
        } else {
            surface.closest_point_near(&local, triangle)
        };
        let near = if whole && surface.hides(&near.point, near.triangle) {
            // A descent has led below another part. From outside, the nearest point of all is never hidden.
            let near = surface.closest_point(&local);
            if surface.hides(&near.point, near.triangle) {
                particles.log_weight[k] = f64::NEG_INFINITY; // nothing touches the link there
            }
            near
        } else {
            near
        };
        let (distance, normal) = signed(&near, &local);
        let change = particles.distance[k] - distance;
        particles.distance[k] = distance;
        put(particles, k, &SurfacePoint { normal, ..near.into() });
        particles.force[k] += change * particles.stiffness[k];
        let [cross, stiffness] = [particles.cross_variance[k], particles.stiffness_variance[k]];
        particles.force_variance[k] += 2.0 * change * cross
            + change * change * stiffness
            + (self.noise.force * particles.force[k]).powi(2)
            + (self.noise.distance * particles.stiffness[k]).powi(2);
        particles.cross_variance[k] += change * stiffness;
    }

    /// The contact stays where it is in the world (the second baseline).
    fn stay_in_world(
        &self,
        surface: &Surface,
        instant: &Instant,
        number: u64,
        particles: &mut Slice<'_>,
        k: usize,
    ) {
        let link = particles.link[k] as usize;
        let fixed = instant.before(link).transform_point(&particles.point[k]);
        let near = surface
            .closest_point_near(&instant.pose(link).inverse_transform_point(&fixed), particles.triangle[k]);
        put(particles, k, &near.into());
        self.stay_on_link(surface, number, particles, k);
    }

    /// The contact moves with the link (the first baseline).
    fn stay_on_link(&self, surface: &Surface, number: u64, particles: &mut Slice<'_>, k: usize) {
        let seen = (number + self.step).is_multiple_of(REFRESH);
        // Copies that were moved apart may have come below another part.
        if seen && surface.hides(&particles.point[k], particles.triangle[k]) {
            particles.log_weight[k] = f64::NEG_INFINITY;
        }
        particles.force_variance[k] += self.loose_force.powi(2);
    }
}

/// Nearer than this the direction to the nearest point is lost to rounding [m].
const TOUCHING: f64 = 1e-7;

/// Distance and outward normal at the nearest point: a centre inside the link has a negative distance.
pub(crate) fn signed(near: &ClosestPoint, local: &Vector3<f64>) -> (f64, Vector3<f64>) {
    let apart = local - near.point;
    if near.distance < TOUCHING {
        return (near.distance, near.normal);
    }
    // On an edge or a corner the direction is between the faces' normals.
    let side = if near.inside { -1.0 } else { 1.0 };
    (side * near.distance, apart * (side / near.distance))
}

/// Puts a particle at a point of its link's surface.
pub(super) fn put(particles: &mut Slice<'_>, k: usize, touch: &SurfacePoint) {
    particles.point[k] = touch.point;
    particles.normal[k] = touch.normal;
    particles.triangle[k] = touch.triangle;
}
