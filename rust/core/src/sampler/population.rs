//! All hypotheses of one number of contacts.

use std::sync::atomic::AtomicBool;

use nalgebra::Vector3;

use super::hypothesis::{Contact, ContactModel, Hypothesis, One};
use super::measurements::Measurements;
use super::neighbours::Neighbours;
use super::order::Orders;
use super::path::ContactPath;
use super::sums::Prior;
use crate::error::{Error, Result};
use crate::math::random::Stream;
use crate::particle::FilterOptions;
use crate::posterior::parallel::Course;
use crate::posterior::tempering::{Samples, Tempering, Travelled};
use crate::posterior::{Clusters, ContactSample, ContactSamples};
use crate::robot::Robot;
use crate::surface::SurfacePoint;
use crate::torque::Frames;

/// What hypotheses are made of and judged by.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scene<'a> {
    pub robot: &'a Robot,
    pub measurements: &'a Measurements,
    pub options: &'a FilterOptions,
    pub models: &'a [ContactModel],
    pub places: &'a [(u32, SurfacePoint)],
    pub neighbours: &'a Neighbours,
}

impl<'a> Scene<'a> {
    pub fn path<const N: usize>(self) -> ContactPath<'a, N> {
        let Scene { robot, measurements, options, models, places, neighbours } = self;
        ContactPath {
            robot,
            measurements,
            models,
            places,
            neighbours,
            prior: Prior { force: options.force_range, stiffness: options.stiffness_range },
            force_model: options.force_model,
            log_radius: options.radius_range.map(f64::ln),
            nothing_before: false,
        }
    }
}

/// Hypotheses of some number of contacts.
pub(super) trait Population: std::fmt::Debug + Send + Sync {
    /// How many contacts each has.
    fn contacts(&self) -> usize;

    /// Contacts begin, or others than `before`: the first of those that are there again come in that order (world frame).
    fn begin(&mut self, before: &[Vector3<f64>]);

    /// Takes the newest measurement into all hypotheses and moves them; or all measurements, where they are spread `anew` over the
    /// surface.
    fn update(
        &mut self,
        scene: Scene<'_>,
        anew: bool,
        tempering: Tempering,
        random: Stream,
        course: Course<'_>,
    ) -> Travelled;

    /// Logarithm of how many times as likely all torques are as without a contact, of measurements that count nothing.
    fn log_evidence(&self) -> f64;

    /// Adds to it.
    fn add_log_evidence(&mut self, log: f64);

    /// The least squared torques that a hypothesis leaves over.
    fn misfit(&self) -> f64;

    /// Logarithm of the greatest likelihood of a hypothesis, but for a constant of the measurements.
    fn greatest_log(&self) -> f64;

    /// They sum to one.
    fn weights(&self) -> &[f64];

    /// One contact of one hypothesis, and its model.
    fn sample(&self, hypothesis: usize, contact: usize) -> Option<(ContactModel, ContactSample)>;

    /// Finds the modes of one contact.
    fn find(&self, contact: usize, clusters: &mut Clusters, robot: &Robot, frames: &Frames);
}

#[derive(Debug)]
struct Hypotheses<const N: usize> {
    samples: Samples<Hypothesis<N>>,
    log_evidence: f64,
    orders: Orders<N>,
}

/// So many hypotheses of so many contacts.
///
/// # Errors
/// [`Error::Memory`] where there is no space for so many; [`Error::Input`] where nothing could touch the robot.
pub(super) fn population(
    contacts: usize,
    hypotheses: usize,
    scene: Scene<'_>,
) -> Result<Box<dyn Population>> {
    Ok(match contacts {
        1 => Box::new(Hypotheses::<1>::new(hypotheses, scene)?),
        2 => Box::new(Hypotheses::<2>::new(hypotheses, scene)?),
        3 => Box::new(Hypotheses::<3>::new(hypotheses, scene)?),
        _ => Box::new(Hypotheses::<4>::new(hypotheses, scene)?),
    })
}

impl<const N: usize> Hypotheses<N> {
    fn new(count: usize, scene: Scene<'_>) -> Result<Self> {
        let path = scene.path::<N>();
        let first = path.make([path.claim(scene.models[0], 0, 0.0); N], None);
        let first =
            first.ok_or_else(|| Error::input("robot", "has no surface where anything could touch it"))?;
        Ok(Hypotheses { samples: Samples::new(count, first)?, log_evidence: 0.0, orders: Orders::after(&[]) })
    }
}

/// Where each contact was first, world frame.
fn first_points<const N: usize>(measurements: &Measurements, contacts: &[Contact; N]) -> [Vector3<f64>; N] {
    contacts.map(|contact| {
        measurements.first[contact.claim.link as usize].transform_point(&contact.claim.place.point)
    })
}

impl<const N: usize> Population for Hypotheses<N> {
    fn contacts(&self) -> usize {
        N
    }

    fn begin(&mut self, before: &[Vector3<f64>]) {
        self.orders = Orders::after(before);
        self.log_evidence = 0.0;
    }

    fn update(
        &mut self,
        scene: Scene<'_>,
        anew: bool,
        tempering: Tempering,
        random: Stream,
        course: Course<'_>,
    ) -> Travelled {
        let path = ContactPath { nothing_before: anew, ..scene.path::<N>() };
        let count = self.samples.all.len();
        if anew {
            self.samples.restart();
        }
        let work = |start: usize, hypotheses: &mut [Hypothesis<N>]| {
            for (k, hypothesis) in hypotheses.iter_mut().enumerate() {
                if !anew {
                    path.follow(hypothesis);
                    continue;
                }
                let number = start + k;
                let model = path.models[number % path.models.len()];
                let draw = |row: usize| random.uniform((row * count + number) as u64);
                let claims = std::array::from_fn(|contact| {
                    let places = path.places.len();
                    // The first contact of all is spread evenly.
                    let place = match contact {
                        0 => number * places / count,
                        _ => (draw(2 * contact + 1) * places as f64) as usize,
                    };
                    path.claim(model, place, draw(2 * contact))
                });
                if let Some(made) = path.make(claims, None) {
                    *hypothesis = made;
                }
            }
        };
        // Each measurement is taken into all hypotheses, whatever is to end.
        let never = AtomicBool::new(false);
        Course { stop: &never, ..course }.for_each(&mut self.samples.all[..], 0, &work);
        let travelled = self.samples.travel(&path, tempering, random.fork(1), course);
        if N > 1 {
            let Self { samples, orders, .. } = self;
            let points = |hypothesis: &Hypothesis<N>| first_points(scene.measurements, &hypothesis.contacts);
            orders.settle(&mut samples.all, &samples.weights, points, Hypothesis::reorder);
        }
        travelled
    }

    fn log_evidence(&self) -> f64 {
        self.log_evidence
    }

    fn add_log_evidence(&mut self, log: f64) {
        self.log_evidence += log;
    }

    fn misfit(&self) -> f64 {
        self.samples.all.iter().map(|hypothesis| hypothesis.marginal.misfit).fold(f64::INFINITY, f64::min)
    }

    fn greatest_log(&self) -> f64 {
        self.samples.all.iter().map(|hypothesis| hypothesis.marginal.log).fold(f64::NEG_INFINITY, f64::max)
    }

    fn weights(&self) -> &[f64] {
        &self.samples.weights
    }

    fn sample(&self, hypothesis: usize, contact: usize) -> Option<(ContactModel, ContactSample)> {
        let held = self.samples.all.get(hypothesis)?.contacts.get(contact)?;
        Some((held.claim.model, One { all: &self.samples.all, contact }.sample(hypothesis)))
    }

    fn find(&self, contact: usize, clusters: &mut Clusters, robot: &Robot, frames: &Frames) {
        clusters.find(robot, frames, &One { all: &self.samples.all, contact }, &self.samples.weights);
    }
}
