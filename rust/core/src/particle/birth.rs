//! Particles anew, uniform by area over the surface.

use std::mem::size_of;

use super::columns::Columns;
use super::instant::Instant;
use super::memory::space;
use super::options::{FilterOptions, Likelihood};
use crate::error::{Error, Result};
use crate::math::random::Stream;
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
    pub spacing: f64,
    log_stiffness: [f64; 2],
    log_radius: [f64; 2],
    force: [f64; 2],
    stiffness_variance: f64,
}

impl Births {
    /// # Errors
    /// [`Error::Input`] where none of the surface is exposed.
    pub fn new(robot: &Robot, wanted: &[usize], options: &FilterOptions) -> Result<Self> {
        let surface = |index: usize| robot.links()[index].surface.as_ref();
        let areas: Vec<f64> = wanted
            .iter()
            .map(|&index| surface(index).map_or(0.0, |surface| surface.exposed_area()))
            .collect();
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
        Ok(Births {
            spacing: (area / places.len() as f64).sqrt(),
            places,
            log_stiffness: options.stiffness_range.map(f64::ln),
            log_radius: options.radius_range.map(f64::ln),
            force: options.force_range,
            stiffness_variance: match options.likelihood {
                Likelihood::Gaussian => DOUBT * DOUBT,
                Likelihood::Exponential => 0.0,
            },
        })
    }

    /// Makes all particles anew, the first ones at the first places.
    pub fn spread(&self, instant: &Instant, random: &Stream, particles: &mut Columns) {
        let count = particles.len();
        for k in 0..count {
            // Every place once where there are as many; otherwise evenly among the links.
            let place = (k as u128 * self.places.len() as u128 / count as u128) as usize;
            self.make(instant, random, particles, k, place);
        }
    }

    /// Makes particle k anew, at a place chosen at random.
    pub fn anywhere(&self, instant: &Instant, random: &Stream, particles: &mut Columns, k: usize) {
        let place = (random.uniform(DRAWS * k as u64) * self.places.len() as f64) as usize;
        self.make(instant, random, particles, k, place);
    }

    fn make(&self, instant: &Instant, random: &Stream, particles: &mut Columns, k: usize, place: usize) {
        let Some((link, place)) = self.places.get(place) else { return };
        let log_uniform = |[low, high]: [f64; 2], draw: u64| {
            (low + (high - low) * random.uniform(DRAWS * k as u64 + draw)).exp()
        };
        let radius = log_uniform(self.log_radius, 1);
        let stiffness = log_uniform(self.log_stiffness, 2);
        particles.link[k] = *link;
        particles.triangle[k] = place.triangle;
        particles.point[k] = place.point;
        particles.normal[k] = place.normal;
        particles.centre[k] =
            instant.pose(*link as usize).transform_point(&(place.point + place.normal * radius));
        particles.distance[k] = radius;
        particles.force[k] = self.force[0];
        particles.stiffness[k] = stiffness;
        particles.force_variance[k] = 0.0;
        particles.cross_variance[k] = 0.0;
        particles.stiffness_variance[k] = self.stiffness_variance * stiffness * stiffness;
        particles.log_weight[k] = 0.0;
        particles.spread[k] = self.spacing;
        particles.fresh[k] = true;
    }

    /// The force that explains the measured torque best, within the range, and its variance.
    #[inline]
    pub fn force(&self, gain: f64, product: f64) -> (f64, f64) {
        let best = if gain > 0.0 { product / gain } else { 0.0 };
        let force = best.clamp(self.force[0], self.force[1]);
        (force, (DOUBT * force).powi(2))
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

/// Random numbers a birth uses at most.
const DRAWS: u64 = 4;
