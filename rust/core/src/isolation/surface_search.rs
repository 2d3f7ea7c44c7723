//! Where two contacts may be if the torques leave three and more components of their wrenches open.
//!
//! Points sampled on both bodies are paired; for a pair of points the torques determine the forces. Pairs that agree
//! with the torques and push most squarely on the surfaces start an exact solution.

use nalgebra::{Matrix3, SMatrix, Vector3};

use super::found::Scene;
use super::pair::{Open, PairEstimate};
use super::result::Candidate;
use super::wrench_rows::LEVER;
use crate::robot::{LinkIndex, Robot};
use crate::surface::SurfacePoint;

/// Pairs of samples, and how many samples a body has.
pub(super) const PAIRS: usize = 4900;
const LEAST: f64 = 28.0;
const MOST: f64 = 180.0;
/// Starts that are followed to an exact solution.
pub(super) const STARTS: usize = 8;
/// A pair of points stands for its neighbours: the square of how far around, in areas per sample.
const SPACING: f64 = 0.05;
/// Tangent of the steepest angle between force and normal that still counts; steeper ones cost no more.
const STEEP: f64 = 3.0;
/// Cost of a squared tangent of one: large ones are friction that hardly occurs.
const OBLIQUE: f64 = 1.0;
/// Forces of one direction are spread evenly over sizes: their density falls with this power of the squared size.
const SIZE: i32 = 2;
/// Pairs that cost so much more than the best have no weight.
const UNLIKELY: f64 = 12.0;
/// Exact solutions are sought from likely pairs within about this distance of the mean (m).
const REACH: f64 = 0.05;
/// Pairs whose missing moment points so far along their arm are not looked at [variances].
const WORTH: f64 = 2.0;
const SEED: u64 = 1;

/// A sampled contact, from the kinematics' origin in world axes.
#[derive(Debug, Clone, Copy)]
struct Place {
    link: LinkIndex,
    point: Vector3<f64>,
    normal: Vector3<f64>,
    /// Normal matrix and right side of what the torques say of a force here (on the second body), or the moment that
    /// is missing if all force is here (first body).
    matrix: Matrix3<f64>,
    vector: Vector3<f64>,
    square: f64,
}

/// Two sampled contacts, one on each body.
#[derive(Debug, Clone, Copy)]
struct PlacePair {
    places: [usize; 2],
    on_second: Vector3<f64>,
    cost: f64,
}

/// Samples of all links and space for the search.
#[derive(Debug, Clone)]
pub(super) struct SurfaceSearch {
    samples: Vec<Vec<SurfacePoint>>,
    places: [Vec<Place>; 2],
    /// All pairs that are not unlikely.
    pairs: Vec<PlacePair>,
    /// Rank and index of the best pairs.
    best: Vec<(f64, usize)>,
    /// Mean points of all pairs, weighted by their likelihood, from the kinematics' origin.
    pub means: [Vector3<f64>; 2],
}

impl SurfaceSearch {
    pub fn new(robot: &Robot) -> Self {
        let sample = |link: &crate::robot::Link| {
            link.surface.as_ref().map_or_else(Vec::new, |surface| surface.sample(MOST as usize, SEED))
        };
        Self {
            samples: robot.links().iter().map(sample).collect(),
            places: [Vec::with_capacity(MOST as usize), Vec::with_capacity(MOST as usize)],
            pairs: Vec::with_capacity(2 * PAIRS),
            best: Vec::with_capacity(STARTS + 1),
            means: [Vector3::zeros(); 2],
        }
    }

    /// Finds the likeliest pairs of places, to be asked for by [`SurfaceSearch::start`].
    pub fn search(&mut self, scene: Scene, pair: &PairEstimate, pairs: usize) {
        let areas = pair.bodies.map(|body| self.area(scene, body));
        let share = (areas[0] / areas[1]).sqrt().clamp(LEAST / MOST, MOST / LEAST);
        let mean = (pairs.min(PAIRS) as f64).sqrt();
        let counts = [mean * share.sqrt(), mean / share.sqrt()];
        let mut spacing = 0.0;
        for side in 0..2 {
            self.place(scene, pair.bodies[side], side, counts[side]);
            spacing += SPACING * areas[side] / counts[side];
        }
        let total = pair.total();
        let force = total.fixed_rows::<3>(0).into_owned();
        let moment = total.fixed_rows::<3>(3) / LEVER;
        self.fill_first(&force, &moment);
        self.fill_second(pair);
        self.weigh(&force, spacing, pair.deficit);
        self.rank();
    }

    /// The `rank`-th likeliest pair of places and the open part of the wrenches there.
    pub fn start(&self, scene: Scene, pair: &PairEstimate, rank: usize) -> Option<([Candidate; 2], Open)> {
        let PlacePair { places: [first, second], on_second, .. } = &self.pairs[self.best.get(rank)?.1];
        let (first, second) = (&self.places[0][*first], &self.places[1][*second]);
        let candidate = |place: &Place| Candidate {
            link: place.link,
            point: place.point + scene.kinematics.origin,
            normal: place.normal,
            pushing: true,
            distance: 0.0,
        };
        Some(([candidate(first), candidate(second)], shares(pair, &second.point, on_second)))
    }

    fn area(&self, scene: Scene, body: usize) -> f64 {
        let surfaces = scene.region.links_of(scene.robot, body).map(|link| &scene.robot[link].surface);
        surfaces.flatten().map(|surface| surface.area()).sum::<f64>().max(f64::MIN_POSITIVE)
    }

    /// About `count` samples of a body, as many of each link as its area has.
    fn place(&mut self, scene: Scene, body: usize, side: usize, count: f64) {
        let Scene { robot, kinematics, region } = scene;
        let total = self.area(scene, body);
        let places = &mut self.places[side];
        places.clear();
        for link in region.links_of(robot, body) {
            let pose = kinematics.link_pose(robot, link);
            let area = robot[link].surface.as_ref().map_or(0.0, |surface| surface.area());
            let share = (count * area / total).round() as usize;
            for sample in self.samples[link.get()].iter().take(share.max(1)) {
                if places.len() == places.capacity() {
                    return;
                }
                places.push(Place {
                    link,
                    point: pose.transform_point(&sample.point) - kinematics.origin,
                    normal: pose.rotation * sample.normal,
                    matrix: Matrix3::zeros(),
                    vector: Vector3::zeros(),
                    square: 0.0,
                });
            }
        }
    }

    fn fill_first(&mut self, force: &Vector3<f64>, moment: &Vector3<f64>) {
        for place in &mut self.places[0] {
            place.vector = moment - place.point.cross(force);
            place.square = place.vector.norm_squared();
        }
    }

    fn fill_second(&mut self, pair: &PairEstimate) {
        let [_, second] = pair.scaled(&[0.0; 6]);
        for place in &mut self.places[1] {
            let lever = scaled_lever(&place.point);
            (place.matrix, place.vector, place.square) = (Matrix3::zeros(), Vector3::zeros(), 0.0);
            for column in pair.basis.column_iter().skip(pair.deficit) {
                let row: Vector3<f64> = lever.tr_mul(&column);
                let value = column.dot(&second);
                // In moments, as the sum of the moments is.
                place.matrix += row * row.transpose() / (LEVER * LEVER);
                place.vector += row * value / (LEVER * LEVER);
                place.square += value * value / (LEVER * LEVER);
            }
        }
    }

    /// All pairs of places, each with minus twice its log-likelihood: the points lie evenly on the surfaces, forces of
    /// all sizes and of all directions into the surface occur, oblique ones less; what the torques leave unexplained is
    /// to be expected of points `spacing` away.
    fn weigh(&mut self, total: &Vector3<f64>, spacing: f64, deficit: usize) {
        self.pairs.clear();
        let excess = 6 - deficit.min(6) as i32;
        let mut least = f64::INFINITY;
        for (i, first) in self.places[0].iter().enumerate() {
            for (j, second) in self.places[1].iter().enumerate() {
                // Moments about the first point: arm x f = missing.
                let arm = second.point - first.point;
                let square = arm.norm_squared();
                // No force turns about its own arm; forces are of the size that the missing moment asks for, or more.
                let along = arm.dot(&first.vector);
                let size = (first.square / square).max(0.5 * total.norm_squared());
                if along * along > WORTH * spacing * size * square {
                    continue;
                }
                let matrix = second.matrix + Matrix3::from_diagonal_element(square) - arm * arm.transpose();
                let rhs = second.vector - arm.cross(&first.vector);
                let Some(inverse) = matrix.try_inverse() else { continue };
                let on_second = inverse * rhs;
                let left = (second.square + first.square - rhs.dot(&on_second)).max(0.0);
                let on_first = total - on_second;
                let sizes = [on_first.norm_squared(), on_second.norm_squared()];
                let variance = spacing * (sizes[0] + sizes[1]);
                let volume = variance.powi(excess) * (sizes[0] * sizes[1]).powi(SIZE) / inverse.determinant();
                let cost = left / variance
                    + volume.ln()
                    + OBLIQUE * (steepness(&on_first, &first.normal) + steepness(&on_second, &second.normal));
                if cost.is_finite() && self.pairs.len() < self.pairs.capacity() {
                    least = least.min(cost);
                    self.pairs.push(PlacePair { places: [i, j], on_second, cost });
                }
            }
        }
        self.pairs.retain(|pair| pair.cost < least + UNLIKELY);
        let mut weights = 0.0;
        let mut sums = [Vector3::zeros(); 2];
        for pair in &mut self.pairs {
            pair.cost -= least;
            let weight = (-0.5 * pair.cost).exp();
            weights += weight;
            for (sum, (places, place)) in sums.iter_mut().zip(self.places.iter().zip(pair.places)) {
                *sum += places[place].point * weight;
            }
        }
        self.means = sums.map(|sum| sum / weights);
    }

    /// The pairs to start from: likely ones near the mean.
    fn rank(&mut self) {
        self.best.clear();
        for (index, pair) in self.pairs.iter().enumerate() {
            let far: f64 =
                (0..2).map(|i| (self.places[i][pair.places[i]].point - self.means[i]).norm_squared()).sum();
            let cost = pair.cost + far / (REACH * REACH);
            if self.best.len() == STARTS && self.best[STARTS - 1].0 <= cost {
                continue;
            }
            let rank = self.best.partition_point(|(other, _)| *other <= cost);
            self.best.insert(rank, (cost, index));
            self.best.truncate(STARTS);
        }
    }
}

/// Wrench of a force at a point, moment scaled by the lever: `[1; LEVER [point]x]`.
fn scaled_lever(point: &Vector3<f64>) -> SMatrix<f64, 6, 3> {
    let mut lever = SMatrix::<f64, 6, 3>::zeros();
    lever.fixed_view_mut::<3, 3>(0, 0).fill_with_identity();
    lever.fixed_view_mut::<3, 3>(3, 0).copy_from(&(point.cross_matrix() * LEVER));
    lever
}

/// The open part of the second wrench if it is `force` at `point`.
fn shares(pair: &PairEstimate, point: &Vector3<f64>, force: &Vector3<f64>) -> Open {
    let [_, second] = pair.scaled(&[0.0; 6]);
    let difference = scaled_lever(point) * force - second;
    let mut open = [0.0; 6];
    for (share, column) in open.iter_mut().zip(pair.basis.column_iter()).take(pair.deficit) {
        *share = column.dot(&difference);
    }
    open
}

/// Squared tangent of the angle between a pushing force and the inward normal.
pub(super) fn steepness(force: &Vector3<f64>, normal: &Vector3<f64>) -> f64 {
    let inward = -force.dot(normal);
    if inward <= 0.0 {
        return 2.0 * STEEP * STEEP;
    }
    (force.norm_squared() / (inward * inward) - 1.0).min(STEEP * STEEP)
}
