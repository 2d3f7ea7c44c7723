//! The posterior of one contact over all of a robot's surface (algorithm D4).

use std::sync::Arc;

use nalgebra::Vector3;

use super::estimate::MapEstimate;
use super::leaves::Leaf;
use super::measurement::Measurement;
use super::options::MapOptions;
use super::surface_samples::SurfaceSamples;
use crate::error::Result;
use crate::posterior::resampling::normalise;
use crate::posterior::{Clusters, ContactEstimate, MOST_MODES};
use crate::robot::Robot;
use crate::torque::{ForcePrior, PlaceBlock, TorqueNoise, LANES};

/// Pieces that are divided at a level at most, and how often pieces are divided at most: work is bounded.
const MOST_DIVIDED: usize = 64;
const MOST_LEVELS: usize = 12;
/// Pieces with less than this share of the largest one's weight are not divided, and those with less than this are left out.
const DIVIDED: f64 = 0.02;
const KEPT: f64 = 1e-5;
/// A contact anywhere on a piece of surface of edge s is off by this times s in each direction, root mean square: s / sqrt(12).
const PATCH: f64 = 0.289;
/// Errors of the torque by the size of pieces do not matter once they are less than this share of the noise.
const FINE: f64 = 0.3;
/// A posterior that is spread over so many pieces needs no finer ones.
const ENOUGH: f64 = 60.0;
/// Share of the posterior that a region holds.
const REGION: f64 = 0.9;
/// More measurements of one contact than this are not kept.
const MOST_MEASUREMENTS: usize = 8;

/// Says where on a robot a contact is, and how certain that is: the posterior over samples of all surface.
///
/// Every sample is a contact of unknown force: along the inward normal with a logarithm that is uniform, across it by friction.
/// Where the posterior is narrower than the samples are apart, they are divided on the true surface.
///
/// An evaluation allocates nothing, and its work is bounded.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::map::{ContactMap, MapOptions};
/// use contactsense::robot::Robot;
///
/// let robot = Arc::new(Robot::example_arm());
/// let q = [0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.0];
/// // The torque of a push of 20 N on the side of the last link.
/// let link = robot.link("link_7")?;
/// let pose = robot.link_pose(&q, link)?;
/// let point = pose.transform_point(&[0.05, 0.0, 0.1].into());
/// let force = pose.rotation * nalgebra::Vector3::new(-20.0, 0.0, 0.0);
/// let jacobian = robot.jacobian(&q, link, Some(point.into()))?;
/// let tau_ext = jacobian.rows(0, 3).transpose() * force;
///
/// let mut map = ContactMap::new(robot, &MapOptions::default())?;
/// let contact = map.evaluate(&q, tau_ext.as_slice())?.estimate.contact.expect("there is one");
/// assert_eq!(contact.link, link);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ContactMap {
    robot: Arc<Robot>,
    noise: TorqueNoise,
    prior: ForcePrior,
    wanted: Vec<usize>,
    samples: SurfaceSamples,
    measurements: Vec<Measurement>,
    /// How many there are of the contact.
    count: usize,
    /// By sample, padded to blocks: log-likelihoods of a contact that pushes and one that pulls, relative to none.
    log_push: Vec<f64>,
    log_pull: Vec<f64>,
    /// Logarithm of the sum of the samples' weights.
    log_total: f64,
    leaves: Vec<Leaf>,
    log_weights: Vec<f64>,
    weights: Vec<f64>,
    order: Vec<u32>,
    distances: Vec<(f64, f64)>,
    clusters: Clusters,
    found: MapEstimate,
}

impl ContactMap {
    /// A map of a robot.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the option.
    pub fn new(robot: Arc<Robot>, options: &MapOptions) -> Result<Self> {
        let wanted = options.check(&robot)?;
        let noise = options.noise.of(&robot)?;
        let samples = SurfaceSamples::new(&robot, &wanted, options.samples)?;
        let padded: usize = samples.links.iter().map(|link| link.blocks.len() * LANES).sum();
        let most = 2 * samples.count + MOST_LEVELS * MOST_DIVIDED * LANES;
        let links = robot.links().len();
        let measurement = Measurement::new(&robot, wanted.clone());
        Ok(ContactMap {
            noise,
            prior: options.prior(),
            measurements: vec![measurement; MOST_MEASUREMENTS],
            count: 0,
            log_push: vec![0.0; padded],
            log_pull: vec![0.0; padded],
            log_total: 0.0,
            leaves: Vec::with_capacity(most),
            log_weights: Vec::with_capacity(most),
            weights: Vec::with_capacity(most),
            order: Vec::with_capacity(most),
            distances: Vec::with_capacity(most),
            clusters: Clusters::new(most, links)?,
            found: MapEstimate {
                estimate: ContactEstimate::new(wanted.len(), MOST_MODES),
                region_radius: None,
                log_evidence: 0.0,
                explained: true,
                residual: 0.0,
                effective_samples: 0.0,
            },
            samples,
            wanted,
            robot,
        })
    }

    /// The posterior of one contact from a configuration `q` `(nq,)` and the external torque `tau_ext` `(nv,)` there (Nm; N for
    /// sliding joints and a base's linear part).
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the argument; the map is unchanged.
    pub fn evaluate(&mut self, q: &[f64], tau_ext: &[f64]) -> Result<&MapEstimate> {
        self.robot.check_configuration(q)?;
        self.robot.check_tangent("tau_ext", tau_ext)?;
        self.measurements[0].set(&self.robot, q, tau_ext, &self.noise);
        self.count = 1;
        self.solve();
        Ok(&self.found)
    }

    /// What the last evaluation said.
    pub fn estimate(&self) -> &MapEstimate {
        &self.found
    }

    /// Indices of the links that are looked on.
    pub fn links(&self) -> &[usize] {
        &self.wanted
    }

    /// How many samples there are.
    pub fn samples(&self) -> usize {
        self.samples.count
    }

    /// By sample: its point in the world frame at the last evaluation (m), and the logarithm of its share of the posterior.
    pub fn log_posterior(&self) -> impl Iterator<Item = (Vector3<f64>, f64)> + '_ {
        let mut start = 0;
        self.samples.links.iter().flat_map(move |link| {
            let first = start;
            start += link.blocks.len() * LANES;
            let pose = &self.measurements[0].frames.links[link.link].pose;
            let places = link.places.iter().zip(&link.areas).enumerate();
            places.map(move |(k, (place, area))| {
                let log = log_sum(self.log_push[first + k], self.log_pull[first + k]) + area.ln();
                (pose.transform_point(&place.point), log - self.log_total)
            })
        })
    }

    fn solve(&mut self) {
        let spacing = self.samples.spacing();
        let force = self.rough_force();
        let mut edge = spacing;
        self.blur(PATCH * edge * force);
        self.weigh_samples();
        self.take_leaves();
        let greatest = self.leaves.iter().map(|leaf| leaf.log_weight).fold(f64::NEG_INFINITY, f64::max);
        self.log_total = greatest + self.leaves.iter().map(|leaf| (leaf.log_weight - greatest).exp()).sum::<f64>().ln();
        for _ in 0..MOST_LEVELS {
            let (effective, best) = self.weigh_leaves();
            let error = PATCH * edge * best;
            if effective > ENOUGH || error < FINE * self.least_deviation() {
                break;
            }
            edge *= 0.5;
            self.blur(PATCH * edge * best);
            self.divide();
        }
        self.report();
    }

    /// The force of the contact that explains the newest torque best, of a few samples of each link (N).
    fn rough_force(&mut self) -> f64 {
        self.blur(0.0);
        let mut best = (f64::NEG_INFINITY, 0.0);
        for samples in &self.samples.links {
            let Some(block) = samples.blocks.first() else { continue };
            let found = self.measurements[0].likelihood(&self.prior, samples.link, block);
            for k in 0..LANES {
                for (log, force) in [(found.log_push[k], found.push[k]), (found.log_pull[k], found.pull[k])] {
                    if log > best.0 {
                        best = (log, force);
                    }
                }
            }
        }
        best.1
    }

    fn blur(&mut self, error: f64) {
        self.measurements[..self.count].iter_mut().for_each(|measurement| measurement.blur(&self.robot, error));
    }

    /// Mean over the measurements: they are correlated, and together count as one (algorithm D4).
    fn mean_likelihood(&self, link: usize, block: &PlaceBlock) -> ([f64; LANES], [f64; LANES], [[f64; LANES]; 2]) {
        let (mut push, mut pull, mut force) = ([0.0; LANES], [0.0; LANES], [[0.0; LANES]; 2]);
        let share = 1.0 / self.count as f64;
        for measurement in &self.measurements[..self.count] {
            let found = measurement.likelihood(&self.prior, link, block);
            let without = measurement.without_contact();
            for k in 0..LANES {
                push[k] += share * (found.log_push[k] + without);
                pull[k] += share * (found.log_pull[k] + without);
            }
            force = [found.push, found.pull];
        }
        (push, pull, force)
    }

    fn weigh_samples(&mut self) {
        let mut start = 0;
        for which in 0..self.samples.links.len() {
            let link = self.samples.links[which].link;
            for block in 0..self.samples.links[which].blocks.len() {
                let (push, pull, _) = self.mean_likelihood(link, &self.samples.links[which].blocks[block]);
                self.log_push[start..start + LANES].copy_from_slice(&push);
                self.log_pull[start..start + LANES].copy_from_slice(&pull);
                start += LANES;
            }
        }
    }

    /// Samples that have a share of the posterior.
    fn take_leaves(&mut self) {
        self.leaves.clear();
        let greatest = self.log_push.iter().chain(&self.log_pull).copied().fold(f64::NEG_INFINITY, f64::max);
        let floor = greatest + KEPT.ln();
        let mut start = 0;
        for samples in &self.samples.links {
            for (k, (place, &area)) in samples.places.iter().zip(&samples.areas).enumerate() {
                for (log, pulls) in [(self.log_push[start + k], false), (self.log_pull[start + k], true)] {
                    if log > floor {
                        let log_weight = log + area.ln();
                        self.leaves.push(Leaf { link: samples.link, place: *place, area, pulls, log_weight, force: 0.0 });
                    }
                }
            }
            start += samples.blocks.len() * LANES;
        }
    }

    /// Weights of the leaves; returns how many are effective, and the force of the weightiest (N).
    fn weigh_leaves(&mut self) -> (f64, f64) {
        self.log_weights.clear();
        self.log_weights.extend(self.leaves.iter().map(|leaf| leaf.log_weight));
        self.weights.clear();
        self.weights.resize(self.leaves.len(), 0.0);
        let weighed = normalise(&mut self.log_weights, &mut self.weights);
        let best = (0..self.leaves.len()).max_by(|&a, &b| self.weights[a].total_cmp(&self.weights[b]));
        (weighed.effective, best.map_or(0.0, |best| self.force_at(best)))
    }

    /// Size of the force at a leaf (N).
    fn force_at(&self, leaf: usize) -> f64 {
        let Leaf { link, place, pulls, .. } = &self.leaves[leaf];
        let block = PlaceBlock::new(&[(place.point, place.normal); LANES]);
        let (_, _, force) = self.mean_likelihood(*link, &block);
        force[usize::from(*pulls)][0]
    }

    fn least_deviation(&self) -> f64 {
        let stated = self.measurements[..self.count].iter().flat_map(|measurement| &measurement.stated);
        stated.copied().fold(f64::INFINITY, f64::min)
    }

    /// Divides the weightiest leaves into four on the true surface each.
    fn divide(&mut self) {
        let greatest = self.weights.iter().copied().fold(0.0, f64::max);
        self.order.clear();
        let count = self.leaves.len();
        self.order.extend((0..count as u32).filter(|k| self.weights[*k as usize] > DIVIDED * greatest));
        if self.order.len() > MOST_DIVIDED {
            let weights = &self.weights;
            self.order.select_nth_unstable_by(MOST_DIVIDED, |a, b| {
                weights[*b as usize].total_cmp(&weights[*a as usize]).then(a.cmp(b))
            });
            self.order.truncate(MOST_DIVIDED);
        }
        for which in 0..self.order.len() {
            let index = self.order[which] as usize;
            let leaf = self.leaves[index];
            let Some(surface) = self.robot.links()[leaf.link].surface.as_ref() else { continue };
            let places = leaf.quarters().map(|middle| {
                let near = surface.closest_point_near(&middle, leaf.place.triangle);
                crate::surface::SurfacePoint { point: near.point, normal: near.normal, triangle: near.triangle }
            });
            let block = PlaceBlock::new(&places.map(|place| (place.point, place.normal)));
            let (push, pull, _) = self.mean_likelihood(leaf.link, &block);
            let logs = if leaf.pulls { pull } else { push };
            let area = 0.25 * leaf.area;
            for (k, (place, log)) in places.into_iter().zip(logs).enumerate() {
                let hidden = surface.hides(&place.point, place.triangle);
                let log_weight = if hidden { f64::NEG_INFINITY } else { log + area.ln() };
                let part = Leaf { place, area, log_weight, ..leaf };
                if k == 0 {
                    self.leaves[index] = part;
                } else {
                    self.leaves.push(part);
                }
            }
        }
    }

    fn report(&mut self) {
        let weighed_before = self.weigh_leaves();
        for leaf in 0..self.leaves.len() {
            if self.weights[leaf] > KEPT {
                let force = self.force_at(leaf);
                let leaf = &mut self.leaves[leaf];
                leaf.force = if leaf.pulls { -force } else { force };
            }
        }
        let frames = &self.measurements[self.count - 1].frames;
        self.clusters.find(&self.robot, frames, &self.leaves, &self.weights);
        self.found.estimate.set(&self.clusters, frames, 0.0);
        self.found.effective_samples = weighed_before.0;
        let greatest = self.leaves.iter().map(|leaf| leaf.log_weight).fold(f64::NEG_INFINITY, f64::max);
        let sum: f64 = self.leaves.iter().map(|leaf| (leaf.log_weight - greatest).exp()).sum();
        self.blur(0.0);
        let without = self.measurements[..self.count].iter().map(Measurement::without_contact).sum::<f64>();
        self.found.log_evidence = greatest + sum.ln() - self.samples.area.ln() - without / self.count as f64;
        self.found.region_radius = self.found.estimate.contact.map(|contact| contact.point).map(|point| self.radius(&point));
        self.found.residual = 0.0;
    }

    /// Radius about a point of the world that holds most of the posterior (m).
    fn radius(&mut self, point: &Vector3<f64>) -> f64 {
        let frames = &self.measurements[self.count - 1].frames;
        self.distances.clear();
        for (leaf, weight) in self.leaves.iter().zip(&self.weights) {
            let place = frames.links[leaf.link].pose.transform_point(&leaf.place.point);
            self.distances.push(((place - point).norm(), *weight));
        }
        self.distances.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let mut held = 0.0;
        for (distance, weight) in &self.distances {
            held += weight;
            if held >= REGION {
                return *distance;
            }
        }
        self.distances.last().map_or(0.0, |last| last.0)
    }
}

/// `ln(exp(a) + exp(b))`.
fn log_sum(a: f64, b: f64) -> f64 {
    let (low, high) = if a < b { (a, b) } else { (b, a) };
    high + (low - high).exp().ln_1p()
}
