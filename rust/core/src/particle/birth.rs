//! Particles anew, uniform by area over the surface.

use std::mem::size_of;

use nalgebra::Vector3;

use super::columns::Slice;
use super::instant::Instant;
use super::motion::{put, signed};
use super::options::{FilterOptions, Likelihood, Motion};
use super::rejuvenation::tangent;
use super::response::ResponseModel;
use crate::error::{Error, Result};
use crate::math::random::Stream;
use crate::posterior::memory::space;
use crate::robot::Robot;
use crate::surface::SurfacePoint;

/// Points of the surface to choose from: as many as particles, but at least so many.
const LEAST: usize = 4_096;
/// Relative standard deviation of a particle's own belief at the start, of force and of stiffness.
const DOUBT: f64 = 0.5;

/// Memory that one place takes: kept, and once more while it is made [bytes].
pub(super) const PLACE: usize = size_of::<(u32, SurfacePoint)>() + size_of::<SurfacePoint>();

/// Places where particles are born.
#[derive(Debug, Clone)]
pub(super) struct Births {
    places: Vec<(u32, SurfacePoint)>,
    /// Mean distance between places [m].
    spacing: f64,
    log_stiffness: [f64; 2],
    log_radius: [f64; 2],
    force: [f64; 2],
    /// Whether a particle's force is drawn from what is believed of it.
    sampled: bool,
}

impl Births {
    /// # Errors
    /// [`Error::Input`] where none of the surface is exposed.
    pub fn new(robot: &Robot, wanted: &[usize], options: &FilterOptions) -> Result<Self> {
        let (places, area) = exposed_places(robot, wanted, options)?;
        Ok(Births {
            spacing: (area / places.len() as f64).sqrt(),
            places,
            log_stiffness: options.stiffness_range.map(f64::ln),
            log_radius: options.radius_range.map(f64::ln),
            force: options.force_range,
            sampled: options.likelihood == Likelihood::Exponential,
        })
    }

    /// How many places there are.
    pub fn places(&self) -> usize {
        self.places.len()
    }
}

/// Places on the surface of links, by area: as many as particles, but at least so many; and the area (m^2).
///
/// # Errors
/// [`Error::Input`] where none of the surface is exposed.
pub(crate) fn exposed_places(
    robot: &Robot,
    wanted: &[usize],
    options: &FilterOptions,
) -> Result<(Vec<(u32, SurfacePoint)>, f64)> {
    let surface = |index: usize| robot.links()[index].surface.as_ref();
    let areas: Vec<f64> =
        wanted.iter().map(|&index| surface(index).map_or(0.0, |surface| surface.exposed_area())).collect();
    let area: f64 = areas.iter().sum();
    let count = options.particles.max(LEAST);
    let mut places = space(count)?;
    let mut share = 0.0;
    for (&index, own) in wanted.iter().zip(&areas) {
        if area > 0.0 {
            share += own / area;
        }
        // Rounded sums, so that the shares add up to all.
        let wanted = ((share * count as f64).round() as usize).saturating_sub(places.len());
        if let Some(surface) = surface(index) {
            let seed = options.seed.wrapping_add(index as u64);
            places.extend(surface.sample(wanted, seed).into_iter().map(|place| (index as u32, place)));
        }
    }
    if places.is_empty() {
        return Err(hidden(robot, wanted, options));
    }
    Ok((places, area))
}

/// The birth of particles at one instant.
#[derive(Debug)]
pub(super) struct Birth<'a> {
    pub births: &'a Births,
    pub robot: &'a Robot,
    pub instant: &'a Instant,
    pub response_model: ResponseModel,
    pub motion: Motion,
    pub random: Stream,
}

impl Birth<'_> {
    /// Particle `number` of `count`, of which every place has as many as every other.
    pub fn evenly(&self, particles: &mut Slice<'_>, k: usize, number: usize, count: usize) {
        let place = (number as u128 * self.births.places() as u128 / count as u128) as usize;
        // Places are drawn at random themselves, and each has one particle at most.
        let apart = if self.births.places() < count { self.births.spacing } else { 0.0 };
        self.make(particles, k, number, place, apart);
    }

    /// Particle `number`, near a place chosen at random.
    pub fn anywhere(&self, particles: &mut Slice<'_>, k: usize, number: usize) {
        let share = self.random.uniform(DRAWS * number as u64 + PLACE_DRAW);
        let place = (share * self.births.places() as f64) as usize;
        self.make(particles, k, number, place, self.births.spacing);
    }

    /// Makes particle k: so far from a place [m], in touch with an obstacle, with the force that explains the measured torque best.
    fn make(&self, particles: &mut Slice<'_>, k: usize, number: usize, place: usize, apart: f64) {
        let Births { places, log_stiffness, log_radius, sampled, .. } = self.births;
        let Some((link, at)) = places.get(place) else { return };
        let Some(surface) = self.robot.links()[*link as usize].surface.as_ref() else { return };
        let first = DRAWS * number as u64;
        let log_uniform = |[low, high]: &[f64; 2], draw: u64| {
            (low + (high - low) * self.random.uniform(first + draw)).exp()
        };
        let radius = log_uniform(log_radius, RADIUS_DRAW);
        let stiffness = log_uniform(log_stiffness, STIFFNESS_DRAW);
        let aside = if apart > 0.0 {
            let [along, beside] = self.random.moderate(first + ASIDE_DRAW);
            tangent(&at.normal, along * apart, beside * apart)
        } else {
            Vector3::zeros()
        };
        let centre = at.point + at.normal * radius + aside;
        let (touch, distance) = if apart == 0.0 {
            (*at, radius)
        } else if self.motion == Motion::Curvature {
            let near = surface.closest_point_near(&centre, at.triangle);
            let (distance, normal) = signed(&near, &centre);
            (SurfacePoint { normal, ..near.into() }, distance)
        } else {
            (surface.closest_point_near(&(at.point + aside), at.triangle).into(), radius)
        };
        particles.link[k] = *link;
        particles.centre[k] = self.instant.pose(*link as usize).transform_point(&centre);
        particles.distance[k] = distance;
        particles.log_weight[k] = 0.0;
        particles.stiffness[k] = stiffness;
        particles.cross_variance[k] = 0.0;
        put(particles, k, &touch);
        // First without friction, whose limit is the force's.
        particles.force[k] = 0.0;
        let bare = self.response_model.apply(self.instant, particles, k);
        let force = self.births.force(bare.gain, bare.product);
        let deviation = DOUBT * force;
        if *sampled {
            let [draw, _] = self.random.normals(first + FORCE_DRAW);
            particles.force[k] = force + draw * deviation;
            (particles.force_variance[k], particles.stiffness_variance[k]) = (0.0, 0.0);
        } else {
            particles.force[k] = force;
            particles.force_variance[k] = deviation.powi(2);
            particles.stiffness_variance[k] = (DOUBT * stiffness).powi(2);
        }
        if self.response_model.force_model.deviation_across(particles.force[k]).is_some() {
            self.response_model.apply(self.instant, particles, k);
        }
    }
}

impl Births {
    /// The force that explains the measured torque best, within the range.
    fn force(&self, gain: f64, product: f64) -> f64 {
        let best = if gain > 0.0 { product / gain } else { 0.0 };
        best.clamp(self.force[0], self.force[1])
    }
}

fn hidden(robot: &Robot, wanted: &[usize], options: &FilterOptions) -> Error {
    let names: Vec<&str> = wanted.iter().map(|&index| robot.links()[index].name.as_str()).collect();
    let argument = if options.links.is_some() { "links" } else { "robot" };
    Error::input(argument, format!("all of the surface of {} lies inside other parts of the same link; a particle filter needs a part \
         of it exposed",
        names.join(", ")
    ))
}

/// Random numbers that a birth uses at most, and which for what; normal ones take two.
const DRAWS: u64 = 8;
const PLACE_DRAW: u64 = 0;
const RADIUS_DRAW: u64 = 1;
const STIFFNESS_DRAW: u64 = 2;
const ASIDE_DRAW: u64 = 4;
const FORCE_DRAW: u64 = 6;
