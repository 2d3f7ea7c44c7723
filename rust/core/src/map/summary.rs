//! What a posterior over the surface says in short: the contact, its region, and whether the noise explains what is left.

use super::estimate::MapEstimate;
use super::surface_posterior::SurfacePosterior;
use crate::math::chi_square::upper_limit;
use crate::posterior::{ContactEstimate, MOST_MODES};
use crate::torque::{BestForce, ForceModel};

/// Share of the posterior that a region holds.
const REGION: f64 = 0.9;
/// A row that a contact's link does not move and that exceeds so many standard deviations is no noise, however many rows agree.
const NO_NOISE: f64 = 6.0;
/// Share that three standard deviations of a point hold.
const NEARLY_ALL: f64 = 0.99;
/// Radius that holds it of a normal distribution along a line, in standard deviations (in two directions it is 1.52).
const RADIUS: f64 = 1.645;

/// The estimate, and memory to find it.
#[derive(Debug, Clone)]
pub(crate) struct Summary {
    friction: ForceModel,
    /// Distances from the contact (m), with weights.
    distances: Vec<(f64, f64)>,
    left: Vec<f64>,
    found: MapEstimate,
    point_std: f64,
}

impl Summary {
    /// For so many rows of a measurement, and links that are looked on.
    pub fn new(rows: usize, links: usize, friction: f64, posterior: &SurfacePosterior) -> Self {
        Summary {
            friction: ForceModel::FrictionCone(friction),
            distances: Vec::with_capacity(posterior.most_pieces()),
            left: vec![0.0; rows],
            point_std: 0.0,
            found: MapEstimate {
                estimate: ContactEstimate::new(links, MOST_MODES),
                region_radius: None,
                log_evidence: 0.0,
                explained: true,
                residual: 0.0,
                effective_samples: 0.0,
            },
        }
    }

    /// The estimate that was read last.
    pub fn estimate(&self) -> &MapEstimate {
        &self.found
    }

    /// Standard deviation of the point (m): root mean square of the posterior's distance from it, or a third of the radius that holds
    /// nearly all of the posterior if that is more, since a small share of it may be far away.
    pub fn point_std(&self) -> f64 {
        self.point_std
    }

    /// Reads a posterior that is complete.
    pub fn read(&mut self, posterior: &SurfacePosterior) -> &MapEstimate {
        let measurement = posterior.newest();
        let frames = measurement.frames();
        let found = &mut self.found;
        found.estimate.set(&posterior.clusters, frames, 0.0);
        found.effective_samples = posterior.effective;
        found.log_evidence = posterior.log_evidence();
        let rows = self.left.len();
        let (mut misfit, mut largest) = (f64::INFINITY, 0.0);
        for mode in &found.estimate.modes {
            let frame = &frames.links[mode.link.get()];
            let mode = mode.in_link_frame(&frame.pose);
            let (link, normal) = (mode.link.get(), mode.pushed_normal());
            let target = measurement.target().on(link);
            let best = BestForce::of(frame, target, self.friction, &mode.point, &normal);
            let left = measurement.left_over(link, &mode.point, &best.force, &mut self.left);
            if left < misfit {
                (misfit, largest) = (left, measurement.largest_elsewhere(link));
            }
        }
        found.residual = if misfit.is_finite() { (misfit / rows as f64).sqrt() } else { 0.0 };
        found.explained = misfit <= upper_limit(rows) && largest <= NO_NOISE;
        found.region_radius = found.estimate.contact.map(|contact| contact.point).map(|point| {
            self.distances.clear();
            for (leaf, weight) in posterior.leaves.iter().zip(&posterior.weights) {
                let place = frames.links[leaf.link].pose.transform_point(&leaf.place.point);
                self.distances.push(((place - point).norm().hypot(RADIUS * leaf.spread), *weight));
            }
            let [region, nearly_all] = held_within(&mut self.distances, [REGION, NEARLY_ALL]);
            let spread = found.estimate.covariance.map_or(0.0, |covariance| covariance.trace().sqrt());
            self.point_std = spread.max(nearly_all / 3.0);
            region
        });
        &self.found
    }
}

/// The distances within which these shares of the weight are, in ascending order, of distances with weights (m).
fn held_within(distances: &mut [(f64, f64)], shares: [f64; 2]) -> [f64; 2] {
    distances.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let mut held = 0.0;
    let mut known = distances.iter().map(|(distance, weight)| {
        held += weight;
        (*distance, held)
    });
    let farthest = distances.last().map_or(0.0, |last| last.0);
    let mut last = (0.0, 0.0);
    shares.map(|share| {
        while last.1 < share {
            match known.next() {
                Some(next) => last = next,
                None => return farthest,
            }
        }
        last.0
    })
}
