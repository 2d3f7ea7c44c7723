//! The weighted particles, and memory for the next ones.

use std::mem::size_of;

use super::birth::{Births, PLACE};
use super::columns::Columns;
use crate::error::Result;
use crate::posterior::memory::{filled, space};
use crate::posterior::parallel::Course;
use crate::posterior::resampling::{normalise, systematic};
use crate::posterior::{Clusters, Evidence};

/// Memory that one particle takes [bytes].
const PARTICLE: usize = 2 * Columns::SIZE + Clusters::SIZE + PLACE + size_of::<f64>() + size_of::<u32>();

/// All particles and their weights, which sum to one.
#[derive(Debug, Clone)]
pub(super) struct Cloud {
    pub births: Births,
    pub particles: Columns,
    pub weights: Vec<f64>,
    /// Which particle each is a copy of.
    pub parents: Vec<u32>,
    evidence: Evidence,
    spare: Columns,
}

impl Cloud {
    /// Whether there is memory for so many particles and all that goes with them, before any of it is filled.
    ///
    /// # Errors
    /// [`Error::Memory`](crate::Error::Memory) where there is not.
    pub fn check_memory(count: usize) -> Result<()> {
        space::<[u8; PARTICLE]>(count).map(drop)
    }

    /// As many as told, not born yet.
    pub fn new(births: Births, count: usize) -> Result<Self> {
        Ok(Cloud {
            births,
            particles: Columns::new(count)?,
            weights: filled(1.0 / count as f64, count)?,
            parents: filled(0, count)?,
            evidence: Evidence::of(count),
            spare: Columns::new(count)?,
        })
    }

    /// Makes all particles as they were at the start.
    pub fn clear(&mut self) {
        self.particles.clear();
        self.level();
    }

    /// Sets the weights from their logarithms; returns how many particles are effective, and the logarithm of the likelihood
    /// of what was weighed, given all that was weighed before.
    pub fn normalise(&mut self, course: Course<'_>) -> (f64, f64) {
        let weighed = normalise(&mut self.particles.log_weight, &mut self.weights, course);
        (weighed.effective, self.evidence.take_in(&weighed))
    }

    /// Gives all particles the same weight.
    pub fn level(&mut self) {
        self.evidence = Evidence::of(self.particles.len());
        self.weights.fill(1.0 / self.particles.len() as f64);
    }

    /// What draws copies while the particles are read.
    pub fn copying(&mut self) -> (Copying<'_>, &Columns, &[f64]) {
        let Self { particles, weights, parents, spare, .. } = self;
        (Copying { particles, weights, parents, spare }, particles, weights)
    }

    /// Replaces the particles by so many copies that were drawn; what is behind them is of no use.
    pub fn take_copies(&mut self, kept: usize) {
        std::mem::swap(&mut self.particles, &mut self.spare);
        self.particles.log_weight[..kept].fill(0.0);
    }
}

/// Draws copies of particles by their weights.
pub(super) struct Copying<'a> {
    particles: &'a Columns,
    weights: &'a [f64],
    parents: &'a mut [u32],
    spare: &'a mut Columns,
}

impl Copying<'_> {
    /// So many, with an offset in [0, 1).
    pub fn draw(self, kept: usize, offset: f64) {
        let parents = &mut self.parents[..kept];
        systematic(self.weights, offset, parents);
        self.spare.gather(self.particles, parents);
    }
}
