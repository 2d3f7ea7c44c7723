//! Samples of a link's surface in groups, so that most of them need not be looked at.

use std::f64::consts::PI;

use nalgebra::Vector3;

use crate::surface::Surface;

/// How densely a surface is sampled.
#[derive(Debug, Clone, Copy)]
pub(super) struct Density {
    /// Largest hole between samples that is aimed at (m).
    pub hole: f64,
    /// Most samples.
    pub most: usize,
}

/// Holes as large as the usual clearance.
pub(super) const USUAL: Density = Density { hole: 0.01, most: 5000 };
/// Of links that are near others by design.
pub(super) const FINE: Density = Density { hole: 0.003, most: 40_000 };
/// Least number of samples of a surface.
const FEWEST: usize = 200;
/// Samples of a group, on average.
const GROUP: usize = 40;

/// Samples near each other, in the link's frame.
#[derive(Debug, Clone)]
pub(super) struct Group {
    pub center: Vector3<f64>,
    pub radius: f64,
    pub points: Vec<Vector3<f64>>,
}

/// All samples of a surface.
#[derive(Debug, Clone)]
pub(super) struct Cover {
    pub groups: Vec<Group>,
    /// Distance from any point of the surface to the nearest sample that is not exceeded, usually (m).
    pub hole: f64,
}

impl Cover {
    pub fn new(surface: &Surface, wanted: Density) -> Self {
        let area = surface.exposed_area();
        // The largest empty circle among `n` random points of an area `A` has about the area `A ln n / n`.
        let hole = |n: usize| (area * (n as f64).ln() / (PI * n as f64)).sqrt();
        let mut count = FEWEST;
        while count < wanted.most && hole(count) > wanted.hole {
            count = (count + count / 4).min(wanted.most);
        }
        let points: Vec<Vector3<f64>> =
            surface.sample(count, 0).into_iter().map(|sample| sample.point).collect();
        Cover { groups: groups(points, count / GROUP), hole: hole(count) }
    }
}

/// Groups around points that are each as far as possible from the ones before (Gonzalez 1985).
fn groups(points: Vec<Vector3<f64>>, count: usize) -> Vec<Group> {
    let Some(&first) = points.first() else { return vec![] };
    let mut centers = vec![first];
    let mut nearest: Vec<(f64, usize)> = points.iter().map(|p| ((p - first).norm_squared(), 0)).collect();
    while centers.len() < count {
        let far = (0..points.len()).max_by(|a, b| nearest[*a].0.total_cmp(&nearest[*b].0)).unwrap_or(0);
        let center = points[far];
        for (point, near) in points.iter().zip(&mut nearest) {
            let squared = (point - center).norm_squared();
            if squared < near.0 {
                *near = (squared, centers.len());
            }
        }
        centers.push(center);
    }
    let mut groups: Vec<Group> =
        centers.into_iter().map(|center| Group { center, radius: 0.0, points: vec![] }).collect();
    for (point, (squared, group)) in points.into_iter().zip(nearest) {
        let group = &mut groups[group];
        group.radius = group.radius.max(squared.sqrt());
        group.points.push(point);
    }
    groups.retain(|group| !group.points.is_empty());
    groups
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;

    #[test]
    fn every_point_of_the_surface_is_near_a_sample_of_a_group() {
        let robot = Robot::example_arm();
        let surface = robot.links()[2].surface.as_deref().expect("it has one");
        let cover = Cover::new(surface, USUAL);
        assert!(cover.hole < 1.1 * USUAL.hole);
        for group in &cover.groups {
            assert!(group.points.iter().all(|point| (point - group.center).norm() <= group.radius + 1e-12));
        }
        let samples: Vec<_> = cover.groups.iter().flat_map(|group| &group.points).collect();
        for sample in surface.sample(500, 1) {
            let nearest =
                samples.iter().map(|point| (*point - sample.point).norm()).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1.5 * cover.hole);
        }
    }
}
