//! What is believed of the contact before the motion: obstacles that stay, each as probable as every other.

use nalgebra::Vector3;

use super::obstacle::Obstacle;
use super::prediction::Prediction;
use super::sharpening::sharpen;
use crate::error::{Error, Result};
use crate::math::random::Stream;
use crate::particle::{signed, tangent, FilterOptions};
use crate::posterior::resampling::systematic;
use crate::posterior::{ContactEstimate, Mode};
use crate::robot::{LinkIndex, Robot};
use crate::surface::SurfacePoint;
use crate::torque::TorqueNoise;

/// How many obstacles stand for a posterior: enough for a few modes with their spreads, and few enough that the time, which
/// grows with their square, stays below a tenth of a second.
const OBSTACLES: usize = 192;
/// Places drawn around the modes of an estimate, of which those are kept that explain the torque.
const PLACES: usize = 1024;
/// Standard deviation of the logarithm of a stiffness that an estimate is sure of, and of one that it is not: the
/// stiffnesses that the filter draws at first are spread over two decades.
const LOG_STIFFNESS: [f64; 2] = [0.3, 1.0];
/// Weaker contacts are not followed, nor are those that would need more to explain the torque (N).
const FORCES: [f64; 2] = [0.1, 500.0];
/// An obstacle touches where it should if it does within this (m); its radius is halved so often until it does.
const SAME_POINT: f64 = 1e-3;
const SHRINKINGS: usize = 8;
/// Random numbers of a place or an obstacle, and which for what; normal ones take two.
const RADIUS: u64 = 0;
const STIFFNESS: u64 = 2;
const ASIDE: u64 = 4;
/// Streams of random numbers.
const MODES: u64 = 0;
const AROUND: u64 = 1;
const CHOSEN: u64 = 2;
const RADII: u64 = 3;

/// A place where the contact may be, as the particles of a filter are; world frame.
///
/// ```
/// use contactsense::nalgebra::Vector3;
/// use contactsense::next_motion::ContactHypothesis;
/// use contactsense::robot::Robot;
///
/// let robot = Robot::example_arm();
/// let hypothesis = ContactHypothesis {
///     link: robot.link("link_7")?,
///     point: Vector3::new(0.1, 0.0, 1.2),
///     normal: Vector3::x(),
///     force: 10.0,
///     stiffness: 3e3,
///     weight: 1.0,
/// };
/// assert!(hypothesis.weight > 0.0);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactHypothesis {
    /// Which link.
    pub link: LinkIndex,
    /// On the link's surface (m).
    pub point: Vector3<f64>,
    /// Outward.
    pub normal: Vector3<f64>,
    /// Along the inward normal (N); places that do not push are left out.
    pub force: f64,
    /// Of the contact (N/m).
    pub stiffness: f64,
    /// In proportion to its probability.
    pub weight: f64,
}

/// A contact before the motion.
struct Place {
    link: usize,
    /// Link frame.
    at: SurfacePoint,
    force: f64,
    stiffness: f64,
    /// Squared norm of the torque that no force there explains, each joint over its noise.
    misfit: f64,
}

/// Makes obstacles at a pose.
pub(super) struct Believed<'a> {
    pub robot: &'a Robot,
    /// At that pose.
    pub here: &'a Prediction<'a>,
    pub noise: &'a TorqueNoise,
    /// The external torque measured there (Nm), if it is known.
    pub torque: Option<&'a [f64]>,
    pub random: Stream,
}

impl Believed<'_> {
    /// Obstacles drawn from weighted hypotheses, such as the particles of a filter.
    ///
    /// # Errors
    /// [`Error::Input`] names `particles`.
    pub fn of_hypotheses(&self, hypotheses: &[ContactHypothesis]) -> Result<Vec<Obstacle>> {
        let (mut places, mut weights) = (vec![], vec![]);
        let deviation = self.deviation();
        for (row, hypothesis) in hypotheses.iter().enumerate() {
            self.check(hypothesis)
                .map_err(|problem| Error::input("particles", format!("row {row}: {problem}")))?;
            let link = hypothesis.link.get();
            let pose = self.here.pose(link);
            let at = SurfacePoint {
                point: pose.inverse_transform_point(&hypothesis.point),
                normal: pose.inverse_transform_vector(&hypothesis.normal).normalize(),
                triangle: None,
            };
            let misfit = self.torque.map_or(0.0, |torque| self.here.fit(link, &at, torque, &deviation).1);
            let ContactHypothesis { force, stiffness, weight, .. } = *hypothesis;
            places.push(Place { link, at, force, stiffness, misfit });
            weights.push(weight);
        }
        Ok(self.obstacles(&places, &mut weights))
    }

    fn check(&self, hypothesis: &ContactHypothesis) -> std::result::Result<(), &'static str> {
        let ContactHypothesis { link, point, normal, force, stiffness, weight } = hypothesis;
        if self.robot.links().get(link.get()).is_none_or(|link| link.surface.is_none()) {
            return Err("the link has no surface");
        }
        let size = normal.norm();
        if !(point.norm().is_finite() && size > 0.5 && size < 2.0) {
            return Err("the point must be finite and the normal a unit vector");
        }
        if !(force.is_finite() && stiffness.is_finite() && *stiffness >= 0.0) {
            return Err("force and stiffness must be finite, and the stiffness not negative");
        }
        if !(weight.is_finite() && *weight >= 0.0) {
            return Err("the weight must be finite and not negative");
        }
        Ok(())
    }

    /// Obstacles drawn around the modes of an estimate, on the surface as far apart as the modes are spread.
    pub fn of_estimate(&self, estimate: &ContactEstimate) -> Vec<Obstacle> {
        let total: f64 = estimate.modes.iter().map(|mode| mode.probability).sum();
        if !(total > 0.0 && total.is_finite()) {
            return vec![];
        }
        let weights: Vec<f64> = estimate.modes.iter().map(|mode| mode.probability / total).collect();
        let mut chosen = vec![0; PLACES];
        systematic(&weights, self.random.fork(MODES).uniform(0), &mut chosen);
        let log_stiffness = LOG_STIFFNESS[usize::from(estimate.ambiguous)];
        let deviation = self.deviation();
        let place = |(k, mode): (usize, &u32)| {
            self.around(&estimate.modes[*mode as usize], log_stiffness, &deviation, k as u64)
        };
        let places: Vec<Place> = chosen.iter().enumerate().filter_map(place).collect();
        let mut weights = vec![1.0; places.len()];
        self.obstacles(&places, &mut weights)
    }

    /// Of the torque that was measured; at rest where it is not known.
    fn deviation(&self) -> Vec<f64> {
        let mut deviation = self.noise.at_rest().to_vec();
        if let Some(torque) = self.torque {
            self.noise.set_deviations(torque, &mut deviation);
        }
        deviation
    }

    /// A random place near a mode, with the force that explains the torque best: the measured one, else that of the mode.
    fn around(&self, mode: &Mode, log_stiffness: f64, deviation: &[f64], k: u64) -> Option<Place> {
        let link = mode.link.get();
        let surface = self.here.surface(link)?;
        let random = self.random.fork(AROUND).fork(k);
        let local = mode.in_link_frame(self.here.pose(link));
        let normal = local.pushed_normal();
        // The spread is of both directions of the surface.
        let [along, beside] =
            random.normals(ASIDE).map(|x| x * mode.spread * std::f64::consts::FRAC_1_SQRT_2);
        let near = surface.closest_point(&(local.point + tangent(&normal, along, beside)));
        if surface.hides(&near.point, near.triangle) {
            return None;
        }
        let at = near.into();
        let (force, misfit) = match self.torque {
            Some(torque) => self.here.fit(link, &at, torque, deviation),
            None => {
                let pushed = normal * local.force.dot(&normal);
                let torque = self.here.torque(link, &local.point, &pushed);
                (self.here.fit(link, &at, &torque, deviation).0, 0.0)
            }
        };
        let [low, high] = FilterOptions::default().stiffness_range;
        let stiffness = match mode.stiffness {
            Some(stiffness) => stiffness * (log_stiffness * random.normals(STIFFNESS)[0]).exp(),
            None => low * (high / low).powf(random.uniform(STIFFNESS)),
        };
        Some(Place { link, at, force, stiffness: stiffness.clamp(low, high), misfit })
    }

    /// Equally probable obstacles at weighted places.
    fn obstacles(&self, places: &[Place], weights: &mut [f64]) -> Vec<Obstacle> {
        for (weight, place) in weights.iter_mut().zip(places) {
            if !(FORCES[0]..=FORCES[1]).contains(&place.force) {
                *weight = 0.0;
            }
        }
        let misfits: Vec<f64> = places.iter().map(|place| place.misfit).collect();
        if !sharpen(weights, &misfits, self.robot.nv()) {
            return vec![];
        }
        let mut chosen = vec![0; OBSTACLES];
        systematic(weights, self.random.fork(CHOSEN).uniform(0), &mut chosen);
        let make = |(k, place): (usize, &u32)| self.obstacle(&places[*place as usize], k as u64);
        chosen.iter().enumerate().filter_map(make).collect()
    }

    /// Obstacle `k` at a place, of a radius that is drawn as the filter draws it.
    fn obstacle(&self, place: &Place, k: u64) -> Option<Obstacle> {
        let Place { link, at, force, stiffness, .. } = place;
        let surface = self.here.surface(*link)?;
        let [low, high] = FilterOptions::default().radius_range;
        let mut radius = low * (high / low).powf(self.random.fork(RADII).fork(k).uniform(RADIUS));
        let triangle = at.triangle.or_else(|| surface.closest_point(&at.point).triangle);
        let mut local = at.point + at.normal * radius;
        let mut near = surface.closest_point_from(&local, triangle);
        // A larger obstacle would touch the link elsewhere first.
        for _ in 0..SHRINKINGS {
            if (near.point - at.point).norm() < SAME_POINT {
                break;
            }
            radius *= 0.5;
            local = at.point + at.normal * radius;
            near = surface.closest_point_from(&local, triangle);
        }
        let pose = self.here.pose(*link);
        Some(Obstacle {
            link: *link,
            point: pose.transform_point(&at.point),
            centre: pose.transform_point(&local),
            distance: signed(&near, &local).0,
            triangle: near.triangle,
            force: *force,
            stiffness: *stiffness,
        })
    }
}
