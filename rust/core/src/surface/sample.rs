//! Points uniform by area over the exposed surface.

use nalgebra::Vector3;

use super::answers::{ClosestPoint, SurfacePoint};
use super::mesh::Mesh;
use super::part::Solid;
use super::primitive::Placed;

use crate::math::random::Stream;

/// Attempts per point asked for, before giving up on a surface that is almost all hidden.
const ATTEMPTS: u64 = 1000;

/// Tables of cumulative areas.
#[derive(Debug, Clone)]
pub(super) struct Sampler {
    /// Of the parts.
    parts: Vec<f64>,
    /// Of each mesh part's triangles; empty for primitives.
    triangles: Vec<Vec<f64>>,
    /// Nearer than this is on a face, not inside (m).
    tolerance: f64,
}

impl Sampler {
    pub fn new(solids: &[Solid], size: f64) -> Self {
        let triangles: Vec<Vec<f64>> = solids
            .iter()
            .map(|solid| match solid {
                Solid::Mesh { mesh, .. } => cumulate((0..mesh.triangles.len()).map(|id| area(mesh, id))),
                Solid::Exact(_) => Vec::new(),
            })
            .collect();
        let parts = cumulate(solids.iter().zip(&triangles).map(|(solid, triangles)| match solid {
            Solid::Mesh { .. } => triangles.last().copied().unwrap_or(0.0),
            Solid::Exact(Placed { shape, .. }) => shape.area(),
        }));
        Sampler { parts, triangles, tolerance: 1e-9 * size }
    }

    pub fn area(&self) -> f64 {
        self.parts.last().copied().unwrap_or(0.0)
    }

    /// Share of the area that is exposed, from a few thousand points.
    pub fn exposed_share(&self, solids: &[Solid]) -> f64 {
        let mut points = vec![];
        let mut sampling = Sampling::new(self, solids, 4000, 0);
        sampling.draw(u64::MAX, &mut points);
        points.len() as f64 / sampling.attempt.max(1) as f64
    }

    /// Whether a point of a part, which holds `triangle` where that is a mesh, is inside another one.
    pub fn hides(&self, solids: &[Solid], point: &Vector3<f64>, triangle: Option<u32>) -> bool {
        solids.iter().any(|solid| {
            let own = triangle.is_some_and(|triangle| solid.holds(triangle).is_some());
            !own && solid.contains(point, self.tolerance)
        })
    }

    fn exposed(&self, solids: &[Solid], part: usize, sample: &SurfacePoint) -> bool {
        solids.iter().enumerate().all(|(other, solid)| {
            if other == part || !solid.closed() {
                return true;
            }
            let mut nearest = ClosestPoint::NONE;
            solid.closest_point(&sample.point, None, &mut nearest);
            if nearest.distance > self.tolerance {
                return !solid.contains(&sample.point, self.tolerance);
            }
            // On a face of both: hidden if the faces look at each other; if they coincide the first part counts.
            let facing = nearest.normal.dot(&sample.normal);
            facing > -0.999 && (facing < 0.999 || part < other)
        })
    }
}

/// A draw of points that can be made in parts.
///
/// ```
/// use contactsense::robot::Robot;
///
/// let robot = Robot::example_arm();
/// let surface = robot.links()[0].surface.as_ref().expect("every link of this arm has one");
/// let (mut sampling, mut points) = (surface.sampling(100, 7), vec![]);
/// // A few at a time: between them there is time for other work.
/// while sampling.draw(16, &mut points) {}
/// assert_eq!(points, surface.sample(100, 7));
/// ```
pub struct Sampling<'a> {
    sampler: &'a Sampler,
    solids: &'a [Solid],
    random: Stream,
    attempt: u64,
    most_attempts: u64,
    missing: usize,
}

impl<'a> Sampling<'a> {
    pub(super) fn new(sampler: &'a Sampler, solids: &'a [Solid], n: usize, seed: u64) -> Self {
        let most_attempts = ATTEMPTS.saturating_mul(n as u64 + 10);
        Sampling { sampler, solids, random: Stream::new(seed), attempt: 0, most_attempts, missing: n }
    }

    /// Appends the points of the next `attempts` attempts; whether there may be more to come.
    pub fn draw(&mut self, attempts: u64, points: &mut Vec<SurfacePoint>) -> bool {
        let (sampler, solids) = (self.sampler, self.solids);
        let end = self.attempt.saturating_add(attempts).min(self.most_attempts);
        while self.missing > 0 && self.attempt < end {
            let u = [0, 1, 2, 3].map(|k| self.random.uniform(self.attempt * 4 + k));
            self.attempt += 1;
            let part = pick(&sampler.parts, u[0]);
            let point = match &solids[part] {
                Solid::Mesh { mesh, first } => {
                    let id = pick(&sampler.triangles[part], u[1]);
                    on_triangle(mesh, *first, id, u[2], u[3])
                }
                Solid::Exact(placed) => placed.sample([u[1], u[2], u[3]]),
            };
            if solids.len() == 1 || sampler.exposed(solids, part, &point) {
                points.push(point);
                self.missing -= 1;
            }
        }
        self.missing > 0 && self.attempt < self.most_attempts
    }
}

fn cumulate(values: impl Iterator<Item = f64>) -> Vec<f64> {
    values
        .scan(0.0, |sum, value| {
            *sum += value;
            Some(*sum)
        })
        .collect()
}

/// Index drawn in proportion to the steps of `cumulative`.
fn pick(cumulative: &[f64], u: f64) -> usize {
    let at = u * cumulative.last().copied().unwrap_or(0.0);
    cumulative.partition_point(|&sum| sum <= at).min(cumulative.len().saturating_sub(1))
}

fn area(mesh: &Mesh, id: usize) -> f64 {
    let [a, b, c] = mesh.triangles[id].map(|v| mesh.vertices[v as usize]);
    0.5 * (b - a).cross(&(c - a)).norm()
}

fn on_triangle(mesh: &Mesh, first: usize, id: usize, u: f64, v: f64) -> SurfacePoint {
    let [a, b, c] = mesh.triangles[id].map(|v| mesh.vertices[v as usize]);
    let root = u.sqrt();
    SurfacePoint {
        point: a + ((b - a) * (1.0 - v) + (c - a) * v) * root,
        normal: mesh.normals[id],
        triangle: Some((first + id) as u32),
    }
}
