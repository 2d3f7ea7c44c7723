//! Where two contacts may be if the torques leave three and more components of their wrenches open.
//!
//! Points sampled on both bodies are paired; for a pair of points the torques determine the forces. Pairs that agree
//! with the torques and push most squarely on the surfaces start an exact solution.

use nalgebra::{Matrix3, SMatrix, Vector3};

use super::open_part::close_near;
use super::pair::{Open, PairEstimate};
use super::rows::LEVER;
use super::several::Scene;
use crate::robot::Robot;
use crate::surface::SurfacePoint;

/// Samples of one body.
const SAMPLES: usize = 24;
/// Starts that are followed to an exact solution.
pub(super) const STARTS: usize = 8;
/// A pair of points stands for its neighbours, this far around [m].
const SPACING: f64 = 0.05;
/// Tangent of the steepest angle between force and normal that still counts; steeper ones cost no more.
const STEEP: f64 = 3.0;
const SEED: u64 = 1;

/// A sampled contact, from the kinematics' origin in world axes.
#[derive(Debug, Clone, Copy)]
struct Place {
    point: Vector3<f64>,
    normal: Vector3<f64>,
    /// Normal matrix and right side of what the torques say of a force here (on the second body), or the moment that
    /// is missing if all force is here (first body).
    matrix: Matrix3<f64>,
    vector: Vector3<f64>,
    square: f64,
}

/// Samples of all links and space for the search.
#[derive(Debug, Clone)]
pub(super) struct SurfaceSearch {
    samples: Vec<Vec<SurfacePoint>>,
    places: [Vec<Place>; 2],
    /// Cost and force on the second body of the best pairs.
    best: Vec<(f64, usize, usize, Vector3<f64>)>,
}

impl SurfaceSearch {
    pub fn new(robot: &Robot) -> Self {
        let sample = |link: &crate::robot::Link| {
            link.surface.as_ref().map_or_else(Vec::new, |surface| surface.sample(SAMPLES, SEED))
        };
        Self {
            samples: robot.links().iter().map(sample).collect(),
            places: [Vec::with_capacity(SAMPLES), Vec::with_capacity(SAMPLES)],
            best: Vec::with_capacity(STARTS + 1),
        }
    }

    /// No samples: a placeholder that costs no memory.
    pub fn empty() -> Self {
        Self { samples: Vec::new(), places: [Vec::new(), Vec::new()], best: Vec::new() }
    }

    /// Calls `each` with ways to close the deficit, likeliest first.
    pub fn search(
        &mut self,
        scene: Scene,
        pair: &PairEstimate,
        mut each: impl FnMut(&Open),
    ) {
        for side in 0..2 {
            self.place(scene, pair.bodies[side], side);
        }
        let total = pair.total();
        let force = total.fixed_rows::<3>(0).into_owned();
        let moment = total.fixed_rows::<3>(3) / LEVER;
        self.fill_first(&force, &moment.into_owned());
        self.fill_second(pair);
        self.rank(&force);
        for (_, _, j, on_second) in &self.best {
            let place = &self.places[1][*j];
            let open = shares(pair, &place.point, on_second);
            if let Some(open) = close_near(pair, open) {
                each(&open);
            }
        }
    }

    fn place(&mut self, scene: Scene, body: usize, side: usize) {
        let Scene { robot, kinematics, region } = scene;
        let places = &mut self.places[side];
        places.clear();
        let links = region.links_of(robot, body).count().max(1);
        for link in region.links_of(robot, body) {
            let pose = kinematics.link_pose(robot, link);
            for sample in self.samples[link].iter().take(SAMPLES / links) {
                places.push(Place {
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

    /// The best pairs of places: what the torques leave unexplained, and how steeply the forces meet the surfaces.
    fn rank(&mut self, total: &Vector3<f64>) {
        self.best.clear();
        for (i, first) in self.places[0].iter().enumerate() {
            for (j, second) in self.places[1].iter().enumerate() {
                // Moments about the first point: arm x f = missing.
                let arm = second.point - first.point;
                let square = arm.norm_squared();
                let matrix = second.matrix + Matrix3::from_diagonal_element(square) - arm * arm.transpose();
                let rhs = second.vector - arm.cross(&first.vector);
                let Some(inverse) = matrix.try_inverse() else { continue };
                let on_second = inverse * rhs;
                let left = (second.square + first.square - rhs.dot(&on_second)).max(0.0);
                let on_first = total - on_second;
                let size = on_first.norm_squared() + on_second.norm_squared();
                let cost = left / (size * SPACING * SPACING)
                    + steepness(&on_first, &first.normal)
                    + steepness(&on_second, &second.normal);
                if !cost.is_finite() {
                    continue;
                }
                let rank = self.best.partition_point(|(other, ..)| *other <= cost);
                if rank < STARTS {
                    self.best.insert(rank, (cost, i, j, on_second));
                    self.best.truncate(STARTS);
                }
            }
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
