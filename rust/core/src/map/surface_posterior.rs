//! The posterior of one contact over the surface, worked out in steps of bounded work: a control loop does one a tick.

mod refinement;

use std::sync::Arc;

use super::leaves::Leaf;
use super::measurement::Measurement;
use super::options::MapOptions;
use super::surface_samples::SurfaceSamples;
use crate::error::Result;
use crate::posterior::resampling::normalise;
use crate::posterior::Clusters;
use crate::robot::{Kinematics, Robot};
use crate::torque::{ForcePrior, PlaceBlock, LANES};

/// More measurements of one contact than this are not kept.
const MOST_MEASUREMENTS: usize = 4;
/// Likelihoods of blocks that a step works out at most, about.
const STEP: usize = 96;
/// Pieces that are divided at a level at most, and how many levels there are: work is bounded.
const MOST_DIVIDED: usize = 64;
const MOST_LEVELS: usize = 12;
/// Pieces with less than this share of the weightiest one's are not divided, and those with less than this are left out.
const DIVIDED: f64 = 0.02;
const KEPT: f64 = 1e-4;
/// A contact anywhere on a piece of surface of edge s is off by this times s in each direction, root mean square: s / sqrt(12).
const PATCH: f64 = 0.289;
/// Errors of the torque by the size of pieces do not matter once they are less than this share of the noise.
const FINE: f64 = 0.3;
/// A posterior that is spread over so many pieces needs no finer ones.
const ENOUGH: f64 = 60.0;

/// What the next step does.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    /// Weighs samples from a block of a link on, whose entry in the columns this is.
    Samples {
        link: usize,
        block: usize,
        entry: usize,
    },
    /// Divides the pieces in `order` from one on.
    Pieces {
        next: usize,
    },
    Forces {
        next: usize,
    },
    Done,
}

/// Samples, the measurements of one contact, and the pieces of surface that hold its posterior.
#[derive(Debug, Clone)]
pub(crate) struct SurfacePosterior {
    robot: Arc<Robot>,
    pub(super) prior: ForcePrior,
    pub(super) samples: SurfaceSamples,
    /// Newest last.
    measurements: Vec<Measurement>,
    count: usize,
    /// By sample, padded to blocks: log-likelihoods of a contact that pushes and of one that pulls.
    pub(super) log_push: Vec<f64>,
    pub(super) log_pull: Vec<f64>,
    pub(super) leaves: Vec<Leaf>,
    log_weights: Vec<f64>,
    pub(super) weights: Vec<f64>,
    order: Vec<u32>,
    /// By link and side: its best piece.
    sides: Vec<Option<usize>>,
    pub(super) clusters: Clusters,
    stage: Stage,
    level: usize,
    /// Edge of the smallest pieces (m).
    edge: f64,
    /// Logarithm of the sum of all pieces' weights.
    log_pieces: f64,
    pub(super) effective: f64,
}

impl SurfacePosterior {
    /// # Errors
    /// [`crate::Error::Input`] names the option.
    pub fn new(robot: Arc<Robot>, options: &MapOptions, wanted: &[usize]) -> Result<Self> {
        let samples = SurfaceSamples::new(&robot, wanted, options.samples)?;
        let padded: usize = samples.links.iter().map(|link| link.blocks.len() * LANES).sum();
        let most = 2 * samples.count + MOST_LEVELS * 2 * MOST_DIVIDED * LANES;
        Ok(SurfacePosterior {
            prior: options.prior(),
            measurements: vec![Measurement::new(&robot, wanted.to_vec()); MOST_MEASUREMENTS],
            count: 0,
            log_push: vec![0.0; padded],
            log_pull: vec![0.0; padded],
            leaves: Vec::with_capacity(most),
            log_weights: Vec::with_capacity(most),
            weights: Vec::with_capacity(most),
            order: Vec::with_capacity(most),
            sides: vec![None; 2 * robot.links().len()],
            clusters: Clusters::new(most, robot.links().len())?,
            stage: Stage::Done,
            level: 0,
            edge: 0.0,
            log_pieces: 0.0,
            effective: 0.0,
            samples,
            robot,
        })
    }

    /// Pieces that there are at most.
    pub fn most_pieces(&self) -> usize {
        self.leaves.capacity()
    }

    /// Forgets all measurements: another contact.
    pub fn forget(&mut self) {
        self.count = 0;
        self.stage = Stage::Done;
    }

    /// Takes in a measurement of the contact, in place of the oldest one where there are as many as are kept. Work that is
    /// not done is given up.
    pub fn measure(&mut self, kinematics: &Kinematics, torque: &[f64], deviation: &[f64]) {
        if self.count == MOST_MEASUREMENTS {
            self.measurements.rotate_left(1);
            self.count -= 1;
        }
        self.measurements[self.count].set(&self.robot, kinematics, torque, deviation);
        self.count += 1;
        self.start();
    }

    /// The newest measurement, weighed by its stated noise once the work is done.
    pub fn newest(&self) -> &Measurement {
        &self.measurements[self.count.saturating_sub(1)]
    }

    /// Whether there is work left.
    pub fn is_done(&self) -> bool {
        self.stage == Stage::Done
    }

    /// Logarithm of how many times as likely the torques are with a contact as without.
    pub fn log_evidence(&self) -> f64 {
        self.log_pieces - self.samples.area.ln() - self.without_contact()
    }

    fn start(&mut self) {
        self.edge = self.samples.spacing();
        self.level = 0;
        let force = self.rough_force();
        self.blur(PATCH * self.edge * force);
        self.stage = Stage::Samples { link: 0, block: 0, entry: 0 };
    }

    /// A part of the work; the posterior is complete where it returns true.
    pub fn step(&mut self) -> bool {
        self.stage = match self.stage {
            Stage::Samples { link, block, entry } => self.weigh_samples(link, block, entry),
            Stage::Pieces { next } => self.divide(next),
            Stage::Forces { next } => self.find_forces(next),
            Stage::Done => Stage::Done,
        };
        self.is_done()
    }

    /// The force of the contact that explains the torques best, of a few samples of each link (N).
    fn rough_force(&mut self) -> f64 {
        self.blur(0.0);
        let mut best = (f64::NEG_INFINITY, 0.0);
        for samples in &self.samples.links {
            let Some(block) = samples.blocks.first() else { continue };
            let found = self.newest().likelihood(&self.prior, samples.link, block);
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
        self.measurements[..self.count].iter_mut().for_each(|measurement| measurement.blur(error));
    }

    /// Log-likelihoods of contacts that push and that pull: the mean over the measurements, which are correlated and together
    /// count as one (algorithm D4).
    #[inline]
    fn log_likelihood(&self, link: usize, block: &PlaceBlock) -> [[f64; LANES]; 2] {
        let mut logs = [[0.0; LANES]; 2];
        let share = 1.0 / self.count as f64;
        for measurement in &self.measurements[..self.count] {
            let found = measurement.likelihood(&self.prior, link, block);
            for (sum, found) in logs.iter_mut().zip([found.log_push, found.log_pull]) {
                sum.iter_mut().zip(found).for_each(|(sum, log)| *sum += share * log);
            }
        }
        logs
    }

    /// Mean log-likelihood without contact, at the present weights.
    fn without_contact(&self) -> f64 {
        let known = &self.measurements[..self.count];
        known.iter().map(Measurement::without_contact).sum::<f64>() / self.count.max(1) as f64
    }

    fn weigh_samples(&mut self, mut link: usize, mut block: usize, mut entry: usize) -> Stage {
        let mut work = 0;
        while let Some(samples) = self.samples.links.get(link) {
            if work >= STEP {
                return Stage::Samples { link, block, entry };
            }
            let Some(places) = samples.blocks.get(block) else {
                (link, block) = (link + 1, 0);
                continue;
            };
            let [push, pull] = self.log_likelihood(samples.link, places);
            self.log_push[entry..entry + LANES].copy_from_slice(&push);
            self.log_pull[entry..entry + LANES].copy_from_slice(&pull);
            (block, entry, work) = (block + 1, entry + LANES, work + self.count);
        }
        self.take_samples();
        self.next_level()
    }

    /// The samples that have a share of the posterior are its first pieces, and the best one of each link and side: a sample is
    /// coarse, and which link it is may only show on smaller pieces.
    fn take_samples(&mut self) {
        self.leaves.clear();
        let greatest = self.log_push.iter().chain(&self.log_pull).copied().fold(f64::NEG_INFINITY, f64::max);
        let without = self.without_contact();
        let mut entry = 0;
        for samples in &self.samples.links {
            let count = samples.places.len();
            for (logs, pulls) in [(&self.log_push, false), (&self.log_pull, true)] {
                let own = &logs[entry..entry + count];
                let floor = own.iter().copied().fold(f64::NEG_INFINITY, f64::max).min(greatest + KEPT.ln());
                for (k, (place, &area)) in samples.places.iter().zip(&samples.areas).enumerate() {
                    if own[k] >= floor {
                        let log_weight = own[k] + without + area.ln();
                        let place = *place;
                        self.leaves.push(Leaf {
                            link: samples.link,
                            place,
                            area,
                            pulls,
                            log_weight,
                            force: 0.0,
                        });
                    }
                }
            }
            entry += samples.blocks.len() * LANES;
        }
    }

    /// Whether smaller pieces are needed, and which are divided.
    fn next_level(&mut self) -> Stage {
        self.weigh_leaves();
        let best = (0..self.leaves.len()).max_by(|&a, &b| self.weights[a].total_cmp(&self.weights[b]));
        let Some(best) = best.filter(|_| self.level < MOST_LEVELS) else { return self.finish() };
        let force = self.force_at(best);
        let newest = self.newest().stated().iter().copied();
        let noise = newest.fold(f64::INFINITY, f64::min);
        if self.effective > ENOUGH || PATCH * self.edge * force < FINE * noise {
            return self.finish();
        }
        self.level += 1;
        self.edge *= 0.5;
        self.blur(PATCH * self.edge * force);
        self.choose(best);
        Stage::Pieces { next: 0 }
    }

    fn weigh_leaves(&mut self) {
        self.log_weights.clear();
        self.log_weights.extend(self.leaves.iter().map(|leaf| leaf.log_weight));
        self.weights.clear();
        self.weights.resize(self.leaves.len(), 0.0);
        let weighed = normalise(&mut self.log_weights, &mut self.weights);
        (self.effective, self.log_pieces) = (weighed.effective, weighed.log_sum);
    }

    /// Weights and noise are final; the forces are not known yet.
    fn finish(&mut self) -> Stage {
        self.blur(0.0);
        Stage::Forces { next: 0 }
    }

    fn find_forces(&mut self, mut next: usize) -> Stage {
        let mut work = 0;
        while next < self.leaves.len() {
            if work >= STEP {
                return Stage::Forces { next };
            }
            if self.weights[next] > KEPT {
                let force = self.force_at(next);
                let leaf = &mut self.leaves[next];
                leaf.force = if leaf.pulls { -force } else { force };
                work += 1;
            }
            next += 1;
        }
        let frames = self.measurements[self.count - 1].frames();
        self.clusters.find(&self.robot, frames, &self.leaves, &self.weights);
        Stage::Done
    }

    /// Size of the normal force at a piece by the newest measurement (N).
    fn force_at(&self, leaf: usize) -> f64 {
        let Leaf { link, place, pulls, .. } = &self.leaves[leaf];
        let block = PlaceBlock::new(&[(place.point, place.normal); LANES]);
        let found = self.newest().likelihood(&self.prior, *link, &block);
        if *pulls {
            found.pull[0]
        } else {
            found.push[0]
        }
    }
}
