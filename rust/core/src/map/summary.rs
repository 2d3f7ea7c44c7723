//! What a posterior over the surface says in short: the contact, its region, and whether the noise explains what is left.

use super::estimate::MapEstimate;
use super::options::{GREATEST_FORCE, LEAST_FORCE};
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
    doubtful: bool,
}

impl Summary {
    /// For so many rows of a measurement, and links that are looked on.
    pub fn new(rows: usize, links: usize, friction: f64, posterior: &SurfacePosterior) -> Self {
        Summary {
            friction: ForceModel::FrictionCone(friction),
            distances: Vec::with_capacity(posterior.most_pieces()),
            left: vec![0.0; rows],
            point_std: 0.0,
            doubtful: false,
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

    /// Whether the torques do not speak for the contact: they are as likely without one, or a row that the contact's link does not
    /// move is far beyond its noise.
    pub fn is_doubtful(&self) -> bool {
        self.doubtful
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
        // What no single push explains is never sure.
        found.estimate.ambiguous |= !found.explained;
        let elsewhere =
            found.estimate.contact.as_ref().map(|mode| measurement.largest_elsewhere(mode.link.get()));
        self.doubtful = found.log_evidence < 0.0 || elsewhere.is_some_and(|largest| largest > NO_NOISE);
        found.region_radius = found.estimate.contact.map(|contact| contact.point).map(|point| {
            self.distances.clear();
            for (leaf, weight) in posterior.leaves.iter().zip(&posterior.weights) {
                let place = frames.links[leaf.link].pose.transform_point(&leaf.place.point);
                let apart = (place - point).norm_squared() + (RADIUS * leaf.spread).powi(2);
                self.distances.push((apart.sqrt(), *weight));
            }
            let [region, nearly_all] = held_within(&mut self.distances, [REGION, NEARLY_ALL]);
            let spread = found.estimate.covariance.map_or(0.0, |covariance| covariance.trace().sqrt());
            self.point_std = spread.max(nearly_all / 3.0);
            region
        });
        &self.found
    }
}

impl Summary {
    /// Gives each mode, in place of the mean force over it, the force that explains the torques best at its point; the mean
    /// stays where that is none of the prior.
    pub fn set_forces_at_points(&mut self, posterior: &SurfacePosterior) -> &MapEstimate {
        let (friction, measurement) = (self.friction, posterior.newest());
        let ContactEstimate { contact, modes, .. } = &mut self.found.estimate;
        for mode in modes.iter_mut().chain(contact) {
            let frame = &measurement.frames().links[mode.link.get()];
            let local = mode.in_link_frame(&frame.pose);
            let target = measurement.target().on(mode.link.get());
            let best =
                BestForce::beside_friction(frame, target, friction, &local.point, &local.pushed_normal());
            if let Some(best) = best.filter(|best| (LEAST_FORCE..=GREATEST_FORCE).contains(&best.normal)) {
                mode.force = frame.pose.rotation * best.force;
            }
        }
        &self.found
    }
}

/// The distances within which these shares of the weight are, in ascending order, of distances with weights (m).
fn held_within(distances: &mut [(f64, f64)], shares: [f64; 2]) -> [f64; 2] {
    let (mut first, mut before) = (0, 0.0);
    shares.map(|share| {
        // The half where the share is reached is halved again.
        let mut end = distances.len();
        while end - first > 1 {
            let middle = (end - first) / 2;
            let (nearer, _, _) =
                distances[first..end].select_nth_unstable_by(middle, |a, b| a.0.total_cmp(&b.0));
            let held = before + nearer.iter().map(|(_, weight)| weight).sum::<f64>();
            if held < share {
                (first, before) = (first + middle, held);
            } else {
                end = first + middle;
            }
        }
        distances.get(first).map_or(0.0, |found| found.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_held_within_the_same_distances_as_by_sorting() {
        for count in [1, 2, 3, 10, 101] {
            // In no order, some alike.
            let mut distances: Vec<(f64, f64)> =
                (0..count).map(|k| (f64::from(k * 37 % 23), 1.0 + f64::from(k % 5))).collect();
            let total: f64 = distances.iter().map(|(_, weight)| weight).sum();
            distances.iter_mut().for_each(|(_, weight)| *weight /= total);
            let mut sorted = distances.clone();
            sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
            for shares in [[0.5, 0.9], [0.9, 0.99], [0.0, 2.0]] {
                let expected = shares.map(|share| {
                    let mut held = 0.0;
                    let reached = sorted.iter().find(|(_, weight)| {
                        held += weight;
                        held >= share
                    });
                    reached.or(sorted.last()).expect("one").0
                });
                assert_eq!(held_within(&mut distances, shares), expected, "{count} {shares:?}");
            }
        }
        assert_eq!(held_within(&mut [], [0.5, 0.9]), [0.0, 0.0]);
    }
}
