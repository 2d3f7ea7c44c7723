//! The posterior of one contact over the surface, worked out in steps of bounded work: a control loop does one a tick.

mod lines;
mod refinement;
mod same_place;

use std::sync::Arc;

use lines::{Line, HITS};
use refinement::PLACES;
use same_place::SamePlace;

use super::leaves::Leaf;
use super::measurement::Measurement;
use super::measurements::{Logs, Measurements};
use super::options::MapOptions;
use super::surface_samples::SurfaceSamples;
use crate::error::Result;
use crate::posterior::parallel::Course;
use crate::posterior::resampling::normalise;
use crate::posterior::Clusters;
use crate::robot::{Kinematics, Robot};
use crate::surface::RayHit;
use crate::torque::{ForcePrior, PushLikelihood, SensorMount, LANES};

/// Likelihoods of blocks that a step works out at most, about.
const STEP: usize = 96;
/// Pieces that are divided at a level at most, and how many levels there are: work is bounded.
const MOST_DIVIDED: usize = 64;
const MOST_LEVELS: usize = 12;
/// Pieces with less than this share of the weightiest one's are not divided, and those with less than this are left out.
const DIVIDED: f64 = 0.02;
const KEPT: f64 = 1e-4;
/// Share of the posterior that a region does not show.
const SEEN: f64 = 1e-3;
/// A contact whose log-likelihood is so much less than the greatest is impossible, however small its piece.
const IMPOSSIBLE: f64 = 60.0;
/// Pieces of surface are taken as flat: a contact of a force f on a piece of edge s, which is curved, errs by this times s f.
const CURVED: f64 = 0.05;
/// Errors of the torque by the size of pieces do not matter once they are less than this share of the noise.
const FINE: f64 = 0.3;
/// A posterior that is spread over so many pieces needs no finer ones.
const ENOUGH: f64 = 60.0;

/// What the next step does.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    /// Weighs samples of the link that is `rank`th in `likely`, from a block on.
    Samples {
        rank: usize,
        block: usize,
    },
    /// Makes the first pieces of the samples.
    Collect,
    /// Divides the pieces in `order` from one on.
    Pieces {
        next: usize,
    },
    /// Looks for places on the best force's line, from one of `likely` on.
    Line {
        next: usize,
    },
    Spreads {
        next: usize,
    },
    Clusters,
    Done,
}

/// Samples, the measurements of one contact, and the pieces of surface that hold its posterior.
#[derive(Debug, Clone)]
pub(crate) struct SurfacePosterior {
    robot: Arc<Robot>,
    pub(super) prior: ForcePrior,
    pub(super) samples: SurfaceSamples,
    measurements: Measurements,
    /// What the measurements say of each block of samples: the newest, then all.
    pub(super) found: Vec<PushLikelihood>,
    /// What the older ones say.
    older: Vec<Logs>,
    same_place: SamePlace,
    /// Whether the older measurements were of another place.
    is_elsewhere: bool,
    /// Links of the samples, those first whose joints feel most, and that half of the squared norm over its noise, of the newest
    /// measurement and of the older ones: no contact there has a log-likelihood above it.
    likely: Vec<([f64; 2], usize)>,
    /// Those of them where a contact is possible.
    possible: Vec<usize>,
    /// Logarithms of the greatest likelihoods of the samples so far: of the newest, and of the older ones.
    greatest: [f64; 2],
    pub(super) leaves: Vec<Leaf>,
    log_weights: Vec<f64>,
    pub(super) weights: Vec<f64>,
    order: Vec<u32>,
    /// By link and side: its best pieces.
    sides: Vec<[Option<usize>; PLACES]>,
    line: Option<Line>,
    hits: Vec<RayHit>,
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
    pub fn new(
        robot: Arc<Robot>,
        options: &MapOptions,
        wanted: &[usize],
        sensors: &[SensorMount],
    ) -> Result<Self> {
        let samples = SurfaceSamples::new(&robot, wanted, options.samples)?;
        let blocks = samples.links.iter().map(|link| link.blocks.len()).sum();
        let most = 2 * samples.count + MOST_LEVELS * 2 * MOST_DIVIDED * LANES;
        Ok(SurfacePosterior {
            prior: options.prior(),
            measurements: Measurements::new(&robot, wanted, sensors),
            found: vec![PushLikelihood::none(0.0); blocks],
            older: vec![Logs::default(); blocks],
            same_place: SamePlace::new(),
            is_elsewhere: false,
            likely: Vec::with_capacity(samples.links.len()),
            possible: Vec::with_capacity(samples.links.len()),
            greatest: [f64::NEG_INFINITY; 2],
            leaves: Vec::with_capacity(most),
            log_weights: Vec::with_capacity(most),
            weights: Vec::with_capacity(most),
            order: Vec::with_capacity(most),
            sides: vec![[None; PLACES]; 2 * robot.links().len()],
            line: None,
            hits: Vec::with_capacity(HITS),
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
        self.measurements.forget();
        self.stage = Stage::Done;
    }

    /// Takes in a measurement of the contact, in place of the last one if that is not kept, and of the oldest one where there are as
    /// many as are kept. Work that is not done is given up.
    pub fn measure(&mut self, kinematics: &Kinematics, torque: &[f64], deviation: &[f64], keep: bool) {
        self.measurements.take_in(&self.robot, kinematics, torque, deviation, keep);
        self.start();
    }

    /// The newest measurement, weighed by its stated noise once the work is done.
    pub fn newest(&self) -> &Measurement {
        self.measurements.newest()
    }

    /// Whether the newest measurement is of another place than the older ones, which have been forgotten.
    pub fn is_elsewhere(&self) -> bool {
        self.is_elsewhere
    }

    /// Whether there is work left.
    pub fn is_done(&self) -> bool {
        self.stage == Stage::Done
    }

    /// Logarithm of how many times as likely the torques are with a contact as without.
    pub fn log_evidence(&self) -> f64 {
        self.log_pieces - self.measurements.without_contact()
    }

    fn start(&mut self) {
        self.edge = self.samples.spacing();
        self.level = 0;
        let force = self.rough_force();
        self.possible.clear();
        self.possible.extend(self.samples.links.iter().map(|link| link.link));
        let Self { likely, samples, measurements, possible, .. } = self;
        measurements.blur(CURVED * self.edge * force, possible);
        let older = measurements.older();
        likely.clear();
        likely.extend(samples.links.iter().enumerate().map(|(k, link)| {
            let felt = |measurement: &Measurement| 0.5 * measurement.felt(link.link);
            let mean = older.iter().map(felt).sum::<f64>() / older.len() as f64;
            let of_older = if older.is_empty() { f64::NEG_INFINITY } else { mean };
            ([felt(measurements.newest()), of_older], k)
        }));
        likely.sort_unstable_by(|a, b| b.0[0].total_cmp(&a.0[0]).then(b.1.cmp(&a.1)));
        self.greatest = [f64::NEG_INFINITY; 2];
        self.same_place = SamePlace::new();
        self.is_elsewhere = false;
        self.stage = Stage::Samples { rank: 0, block: 0 };
    }

    /// A part of the work; the posterior is complete where it returns true.
    pub fn step(&mut self) -> bool {
        self.stage = match self.stage {
            Stage::Samples { rank, block } => self.weigh_samples(rank, block),
            Stage::Collect => self.take_samples(),
            Stage::Pieces { next } => self.divide(next),
            Stage::Line { next } => self.follow_line(next),
            Stage::Spreads { next } => self.find_spreads(next),
            Stage::Clusters => self.find_clusters(),
            Stage::Done => Stage::Done,
        };
        self.is_done()
    }

    /// The force of the contact that explains the torques best, of a few samples of each link (N).
    fn rough_force(&self) -> f64 {
        let mut best = (f64::NEG_INFINITY, 0.0);
        for samples in &self.samples.links {
            let Some(block) = samples.blocks.first() else { continue };
            let found = self.newest().likelihood(&self.prior, samples.link, block);
            for k in 0..LANES {
                for (log, force) in found.log.iter().zip(&found.force) {
                    if log[k] > best.0 {
                        best = (log[k], force[k]);
                    }
                }
            }
        }
        best.1
    }

    fn weigh_samples(&mut self, mut rank: usize, mut block: usize) -> Stage {
        let mut work = 0;
        while let Some(&(bounds, link)) = self.likely.get(rank) {
            if work >= STEP {
                return Stage::Samples { rank, block };
            }
            let samples = &self.samples.links[link];
            let own = samples.first..samples.first + samples.blocks.len();
            if block == 0 && (0..2).all(|k| bounds[k] < self.greatest[k] - IMPOSSIBLE) {
                self.found[own.clone()].fill(PushLikelihood::none(bounds[0]));
                self.older[own].fill([[bounds[1]; LANES]; 2]);
                rank += 1;
                continue;
            }
            let Some(places) = samples.blocks.get(block) else {
                (rank, block) = (rank + 1, 0);
                continue;
            };
            let Self { measurements, prior, .. } = self;
            let found = measurements.newest().likelihood(prior, samples.link, places);
            let older = measurements.older_likelihood(prior, samples.link, places);
            for (greatest, logs) in self.greatest.iter_mut().zip([&found.log, &older]) {
                *greatest = logs.iter().flatten().copied().fold(*greatest, f64::max);
            }
            if !measurements.older().is_empty() {
                self.same_place.add(&found.log, &older, &samples.priors[block * LANES..]);
            }
            (self.found[own.start + block], self.older[own.start + block]) = (found, older);
            (block, work) = (block + 1, work + self.measurements.all().len());
        }
        self.fuse();
        Stage::Collect
    }

    /// Makes what all measurements say of the samples of what the newest and the older ones say; the older ones are forgotten if
    /// they were of another place.
    fn fuse(&mut self) {
        if self.measurements.older().is_empty() {
            return;
        }
        if !self.same_place.is_likely() {
            self.is_elsewhere = true;
            return self.measurements.forget_older();
        }
        for (found, older) in self.found.iter_mut().zip(&self.older) {
            self.measurements.mix(&mut found.log, older);
        }
    }

    /// The samples that have a share of the posterior are its first pieces, and the best one of each link and side: a sample is
    /// coarse, and which link it is may only show on smaller pieces.
    fn take_samples(&mut self) -> Stage {
        let logs = self.found.iter().flat_map(|block| block.log.as_flattened());
        let greatest = logs.copied().fold(f64::NEG_INFINITY, f64::max);
        let Self { likely, samples, possible, measurements, .. } = self;
        let is_possible =
            |bounds: &[f64; 2]| measurements.together(bounds[0], bounds[1]) >= greatest - IMPOSSIBLE;
        likely.retain(|(bounds, _)| is_possible(bounds));
        possible.clear();
        possible.extend(likely.iter().map(|(_, link)| samples.links[*link].link));
        self.leaves.clear();
        let without = self.measurements.without_contact();
        for samples in &self.samples.links {
            let found = &self.found[samples.first..samples.first + samples.blocks.len()];
            for side in 0..2 {
                // Lanes that are left over at the end hold the last place once more.
                let best = found.iter().flat_map(|block| &block.log[side]).copied();
                let best = best.fold(f64::NEG_INFINITY, f64::max);
                if best < greatest - IMPOSSIBLE {
                    continue;
                }
                let floor = best.min(greatest + KEPT.ln());
                for (block, found) in found.iter().enumerate() {
                    let own = block * LANES..samples.places.len().min((block + 1) * LANES);
                    for (k, (&log, &force)) in own.zip(found.log[side].iter().zip(&found.force[side])) {
                        if log >= floor {
                            let area = samples.areas[k];
                            self.leaves.push(Leaf {
                                link: samples.link,
                                place: samples.places[k],
                                area,
                                pulls: side == 1,
                                log_weight: log + without + samples.log_priors[k],
                                force,
                                spread: Leaf::width(area),
                            });
                        }
                    }
                }
            }
        }
        self.next_level()
    }

    /// Whether smaller pieces are needed.
    fn next_level(&mut self) -> Stage {
        self.weigh_leaves();
        if lines::LEVELS.contains(&self.level) {
            return Stage::Line { next: 0 };
        }
        self.choose_pieces()
    }

    /// The pieces that are divided next.
    fn choose_pieces(&mut self) -> Stage {
        let Some(best) = self.best_leaf().filter(|_| self.level < MOST_LEVELS) else { return self.finish() };
        let force = self.leaves[best].force;
        let noise = self.newest().stated().iter().copied().fold(f64::INFINITY, f64::min);
        if self.effective > ENOUGH || CURVED * self.edge * force < FINE * noise {
            return self.finish();
        }
        self.level += 1;
        self.edge *= 0.5;
        self.measurements.blur(CURVED * self.edge * force, &self.possible);
        self.choose(best);
        Stage::Pieces { next: 0 }
    }

    /// The weightiest piece.
    fn best_leaf(&self) -> Option<usize> {
        (0..self.leaves.len()).max_by(|&a, &b| self.weights[a].total_cmp(&self.weights[b]))
    }

    fn weigh_leaves(&mut self) {
        self.log_weights.clear();
        self.log_weights.extend(self.leaves.iter().map(|leaf| leaf.log_weight));
        self.weights.clear();
        self.weights.resize(self.leaves.len(), 0.0);
        let weighed = normalise(&mut self.log_weights, &mut self.weights, Course::alone());
        (self.effective, self.log_pieces) = (weighed.effective, weighed.log_sum);
    }

    /// Weights and noise are final; how far a contact is from the middle of its piece is not known yet.
    fn finish(&mut self) -> Stage {
        self.measurements.blur(0.0, &self.possible);
        Stage::Spreads { next: 0 }
    }

    fn find_spreads(&mut self, mut next: usize) -> Stage {
        let mut work = 0;
        while next < self.leaves.len() {
            if work >= STEP {
                return Stage::Spreads { next };
            }
            // Where there are many, the distance between them counts.
            if self.effective < ENOUGH && self.weights[next] > SEEN {
                self.leaves[next].spread = self.spread(next);
                work += 1;
            }
            next += 1;
        }
        Stage::Clusters
    }

    fn find_clusters(&mut self) -> Stage {
        let frames = self.measurements.newest().frames();
        self.clusters.find(&self.robot, frames, &self.leaves, &self.weights);
        Stage::Done
    }
}
