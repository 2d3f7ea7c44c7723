//! Modes of a posterior: clusters of weighted samples on the surface: neighbouring cells of a grid in each link's frame.

use nalgebra::{Matrix3, Vector3};

use super::contact_sample::ContactSamples;
use super::memory::{filled, space};
use super::mode::Mode;
use super::moments::Moments;
use crate::error::Result;
use crate::robot::{LinkIndex, Robot};
use crate::torque::Frames;

/// Edge of a cell [m].
const CELL: f64 = 0.015;
/// Cells lighter than this share of the heaviest join no clusters.
const LIGHT: f64 = 0.02;
/// Modes that are reported at most.
pub(crate) const MOST_MODES: usize = 8;
const EMPTY: u32 = u32::MAX;
/// Words of 64 bits for heavy cells: many times as many bits as there are cells mostly.
const HEAVY_WORDS: usize = 1024;
/// Steps uphill to where a mode is densest.
const CLIMB: usize = 8;

#[derive(Debug, Clone)]
struct Cell {
    weight: f64,
    /// Weighted sum of points, link frame [m].
    sum: Vector3<f64>,
    /// Of the cluster, at its root.
    cluster: Moments,
}

/// Buffers for finding modes.
#[derive(Debug, Clone)]
pub(crate) struct Clusters {
    /// A table of the cells by their keys, of which so many slots are in use, a power of two: a short one stays near the processor.
    slots: Vec<u32>,
    used: usize,
    /// By a part of their keys' hashes, whether there may be cells that are heavy enough for a cluster: most neighbours are none, which a
    /// bit tells without a search.
    heavy: Vec<u64>,
    /// One a cell. What is searched through stands by itself: cells are large.
    keys: Vec<u64>,
    /// Another cell of the cluster, in the end its root; itself at the root.
    parents: Vec<u32>,
    cells: Vec<Cell>,
    roots: Vec<u32>,
    /// Cells of one cluster.
    members: Vec<u32>,
    /// One a link of the robot.
    links: Vec<Moments>,
    pub found: Vec<Mode>,
    /// Mean spread within modes [m].
    pub spread: f64,
}

impl Clusters {
    /// Memory that one sample takes at most [bytes].
    pub const SIZE: usize =
        std::mem::size_of::<Cell>() + std::mem::size_of::<u64>() + 7 * std::mem::size_of::<u32>();

    /// # Errors
    /// [`Error::Memory`](crate::Error::Memory) where there is no space for so many samples.
    pub fn new(samples: usize, links: usize) -> Result<Self> {
        Ok(Clusters {
            slots: filled(EMPTY, slots_for(samples))?,
            used: 0,
            heavy: vec![0; HEAVY_WORDS],
            keys: space(samples)?,
            parents: space(samples)?,
            cells: space(samples)?,
            roots: space(samples)?,
            members: space(samples)?,
            links: vec![Moments::default(); links],
            found: Vec::with_capacity(MOST_MODES),
            spread: 0.0,
        })
    }

    /// Probability that the contact is on a link: the weight of the samples there.
    pub fn on_link(&self, link: usize) -> f64 {
        probability(self.links[link].weight)
    }

    /// Second moment of all samples about a point, world frame [m^2].
    pub fn covariance(&self, frames: &Frames, point: &Vector3<f64>) -> Matrix3<f64> {
        let mut sum = Matrix3::zeros();
        for &link in &frames.wanted {
            let pose = &frames.links[link].pose;
            let local = pose.inverse_transform_point(point);
            sum += pose.rotation * self.links[link].about(&local) * pose.rotation.transpose();
        }
        sum
    }

    /// Finds the modes of weighted samples (the weights sum to one), best first.
    pub fn find(&mut self, robot: &Robot, frames: &Frames, samples: &impl ContactSamples, weights: &[f64]) {
        self.used = slots_for(weights.len());
        self.slots[..self.used].fill(EMPTY);
        self.keys.clear();
        self.parents.clear();
        self.cells.clear();
        self.links.fill(Moments::default());
        for (k, &weight) in weights.iter().enumerate() {
            if weight > 0.0 {
                let sample = samples.sample(k);
                let cell = self.cell(key(sample.link, &cell_of(&sample.point)));
                let cell = &mut self.cells[cell];
                cell.weight += weight;
                cell.sum += sample.point * weight;
                cell.cluster.add(&sample, weight);
            }
        }
        for (key, cell) in self.keys.iter().zip(&self.cells) {
            self.links[link_of(*key)].join(&cell.cluster);
        }
        self.connect();
        self.rank();
        self.found.clear();
        let (mut spread, mut reported) = (0.0, 0.0);
        for index in 0..self.roots.len().min(MOST_MODES) {
            let mode = self.describe(robot, frames, self.roots[index]);
            spread += mode.probability * mode.spread;
            reported += mode.probability;
            self.found.push(mode);
        }
        self.spread = if reported > 0.0 { spread / reported } else { 0.0 };
    }

    /// Index of the cell with a key, made where there is none.
    fn cell(&mut self, key: u64) -> usize {
        let mask = self.used - 1;
        let mut slot = hash(key) & mask;
        loop {
            match self.slots[slot] {
                EMPTY => {
                    let index = self.cells.len();
                    self.slots[slot] = index as u32;
                    self.keys.push(key);
                    self.parents.push(index as u32);
                    self.cells.push(Cell { weight: 0.0, sum: Vector3::zeros(), cluster: Moments::default() });
                    return index;
                }
                index if self.keys[index as usize] == key => return index as usize,
                _ => slot = (slot + 1) & mask,
            }
        }
    }

    fn known(&self, key: u64) -> Option<usize> {
        let mask = self.used - 1;
        let mut slot = hash(key) & mask;
        loop {
            match self.slots[slot] {
                EMPTY => return None,
                index if self.keys[index as usize] == key => return Some(index as usize),
                _ => slot = (slot + 1) & mask,
            }
        }
    }

    /// Offsets to one half of the neighbours, of those that may be heavy.
    fn heavy_neighbours(&self, key: u64) -> impl Iterator<Item = u64> {
        let mut may_be = 0_u32;
        for (k, offset) in NEIGHBOURS.iter().enumerate() {
            // Without a branch: which ones are there is not to be guessed.
            let (word, bit) = heavy_bit(mixed(key.wrapping_add(*offset)));
            may_be |= ((self.heavy[word] >> bit & 1) as u32) << k;
        }
        std::iter::from_fn(move || {
            let k = may_be.trailing_zeros();
            may_be &= may_be.wrapping_sub(1);
            NEIGHBOURS.get(k as usize).copied()
        })
    }

    /// The cluster's root; halves the path to it, so that a long chain of cells is not walked twice.
    fn root(&mut self, mut cell: u32) -> u32 {
        while self.parents[cell as usize] != cell {
            let above = self.parents[cell as usize];
            self.parents[cell as usize] = self.parents[above as usize];
            cell = above;
        }
        cell
    }

    /// Joins cells that touch, gathers their moments at the roots, and lets each cell name its root.
    fn connect(&mut self) {
        let heaviest = self.cells.iter().map(|cell| cell.weight).fold(0.0, f64::max);
        let cutoff = LIGHT * heaviest;
        self.heavy.fill(0);
        for (cell, key) in self.cells.iter().zip(&self.keys) {
            if cell.weight >= cutoff {
                let (word, bit) = heavy_bit(mixed(*key));
                self.heavy[word] |= 1 << bit;
            }
        }
        for index in 0..self.cells.len() {
            if self.cells[index].weight < cutoff {
                continue;
            }
            let key = self.keys[index];
            // Half of the neighbours: the others find this one.
            for offset in self.heavy_neighbours(key) {
                let Some(other) = self.known(key.wrapping_add(offset)) else { continue };
                if self.cells[other].weight < cutoff {
                    continue;
                }
                let (a, b) = (self.root(index as u32), self.root(other as u32));
                if a != b {
                    // The heavier cell is the root, so that a root is its cluster's heaviest.
                    let (root, child) = if self.cells[a as usize].weight >= self.cells[b as usize].weight {
                        (a, b)
                    } else {
                        (b, a)
                    };
                    self.parents[child as usize] = root;
                    let joined = self.cells[child as usize].cluster;
                    self.cells[root as usize].cluster.join(&joined);
                }
            }
        }
        for index in 0..self.cells.len() as u32 {
            self.parents[index as usize] = self.root(index);
        }
    }

    fn rank(&mut self) {
        self.roots.clear();
        for index in 0..self.cells.len() as u32 {
            if self.parents[index as usize] == index {
                self.roots.push(index);
            }
        }
        let cells = &self.cells;
        let weight = |index: &u32| cells[*index as usize].cluster.weight;
        let reported = MOST_MODES.min(self.roots.len());
        if reported > 0 && reported < self.roots.len() {
            self.roots
                .select_nth_unstable_by(reported - 1, |a, b| weight(b).total_cmp(&weight(a)).then(a.cmp(b)));
        }
        self.roots[..reported].sort_unstable_by(|a, b| weight(b).total_cmp(&weight(a)).then(a.cmp(b)));
    }

    fn describe(&mut self, robot: &Robot, frames: &Frames, root: u32) -> Mode {
        let link = link_of(self.keys[root as usize]);
        let spread = self.cells[root as usize].cluster.spread();
        let densest = self.climb(root, spread);
        let moments = &self.cells[root as usize].cluster;
        let pose = &frames.links[link].pose;
        let mut point = densest;
        let mut normal = moments.normal / moments.weight;
        if let Some(surface) = robot.links()[link].surface.as_ref() {
            let mut near = surface.closest_point(&densest);
            if surface.hides(&near.point, near.triangle) {
                // Nothing touches the link there. From outside, the nearest point of all is never hidden.
                near = surface.closest_point(&(densest + normal.normalize() * (spread + CELL)));
            }
            point = near.point;
            if normal.norm() < 0.7 {
                normal = near.normal; // the mode goes around an edge or the link
            }
        }
        let normal = pose.rotation * normal.normalize();
        Mode {
            link: LinkIndex::new(link),
            point: pose.transform_point(&point),
            force: pose.rotation * (moments.force / moments.weight),
            normal,
            stiffness: (moments.stiffness > 0.0).then(|| moments.stiffness / moments.weight),
            probability: probability(moments.weight),
            spread,
        }
    }

    /// Where a cluster is densest: mean shift over its cells (Cheng 1995), from the heaviest. The kernel is as wide as
    /// the cluster, so that a compact one gives its mean.
    fn climb(&mut self, root: u32, spread: f64) -> Vector3<f64> {
        let Self { parents, cells, members, .. } = self;
        let start = &cells[root as usize];
        if spread < CELL {
            return start.cluster.point / start.cluster.weight;
        }
        members.clear();
        members.extend((0..parents.len() as u32).filter(|cell| parents[*cell as usize] == root));
        let mut at = start.sum / start.weight;
        for _ in 0..CLIMB {
            let (mut sum, mut total) = (Vector3::zeros(), 0.0);
            for cell in members.iter().map(|member| &cells[*member as usize]) {
                let mean = cell.sum / cell.weight;
                let weight = cell.weight * (-0.5 * (mean - at).norm_squared() / (spread * spread)).exp();
                sum += mean * weight;
                total += weight;
            }
            at = sum / total;
        }
        at
    }
}

/// Slots for as many cells at most, so that half of them are empty.
fn slots_for(cells: usize) -> usize {
    (2 * cells).next_power_of_two()
}

fn cell_of(point: &Vector3<f64>) -> [u64; 3] {
    // 2^15 cells either way are 490 m; farther out they fall together.
    [0, 1, 2].map(|k| ((point[k] * (1.0 / CELL)).clamp(-32_000.0, 32_000.0) + 32_768.0) as u64)
}

fn key(link: usize, [x, y, z]: &[u64; 3]) -> u64 {
    (link as u64) << 48 | x << 32 | y << 16 | z
}

fn link_of(key: u64) -> usize {
    (key >> 48) as usize
}

fn hash(key: u64) -> usize {
    (mixed(key) >> 24) as usize
}

/// A sum of weights as a probability: rounding takes those that sum to one a little beyond it.
fn probability(weight: f64) -> f64 {
    weight.min(1.0)
}

fn mixed(key: u64) -> u64 {
    key.wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

/// Word of a mixed key in the bits of heavy cells, and bit in the word.
fn heavy_bit(mixed: u64) -> (usize, u32) {
    let at = mixed >> (64 - (HEAVY_WORDS * 64).ilog2());
    ((at >> 6) as usize, (at & 63) as u32)
}

/// Offsets of keys to one half of the 26 neighbours.
const NEIGHBOURS: [u64; 13] = {
    let (x, y, z) = (1u64 << 32, 1u64 << 16, 1u64);
    [
        z,
        y,
        y.wrapping_add(z),
        y.wrapping_sub(z),
        x,
        x.wrapping_add(z),
        x.wrapping_sub(z),
        x.wrapping_add(y),
        x.wrapping_sub(y),
        x.wrapping_add(y).wrapping_add(z),
        x.wrapping_add(y).wrapping_sub(z),
        x.wrapping_sub(y).wrapping_add(z),
        x.wrapping_sub(y).wrapping_sub(z),
    ]
};
