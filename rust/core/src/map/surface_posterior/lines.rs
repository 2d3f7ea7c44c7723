//! Other places on the line of action of the force that explains the torques best: a force acts the same anywhere on its line.

use std::ops::RangeInclusive;
use std::sync::Arc;

use nalgebra::Vector3;

use super::{Leaf, Stage, SurfacePosterior, STEP};
use crate::surface::{RayHit, Surface, SurfacePoint};
use crate::torque::{BestForce, PlaceBlock, LANES};

/// At the first of these levels the best piece has been moved to where the torques are likeliest; at the last its force has the
/// right line, unless there were enough large pieces.
pub(super) const LEVELS: RangeInclusive<usize> = 1..=3;
/// Crossings with one link that are looked at.
pub(super) const HITS: usize = 32;
/// What it takes to cast a line on a link, and to look at a hit, in likelihoods of blocks.
const CAST: usize = 8;
const LOOK: usize = 4;

/// A line of action, world frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    start: Vector3<f64>,
    /// Of unit length.
    along: Vector3<f64>,
}

impl SurfacePosterior {
    /// Adds places on the line of the best piece's force to the pieces, link by link from the one that is `next` in `likely`.
    pub(super) fn follow_line(&mut self, mut next: usize) -> Stage {
        if next == 0 {
            self.line = self.best_line();
        }
        let mut work = 0;
        if let Some(line) = self.line {
            while let Some(&(_, link)) = self.likely.get(next) {
                if work >= STEP {
                    return Stage::Line { next };
                }
                work += CAST + LOOK * self.measurements.all().len() * self.follow_on(link, &line);
                next += 1;
            }
        }
        self.weigh_leaves();
        self.choose_pieces()
    }

    /// The line of action of the force that explains the torques best on the weightiest piece.
    fn best_line(&self) -> Option<Line> {
        let Leaf { link, place, pulls, .. } = &self.leaves[self.best_leaf()?];
        let measurement = self.newest();
        let (frame, target) = (&measurement.frames().links[*link], measurement.target().on(*link));
        let pushed = if *pulls { -place.normal } else { place.normal };
        let force = BestForce::of(frame, target, self.prior.force_model(), &place.point, &pushed).force;
        let along = frame.pose.rotation * force.try_normalize(f64::MIN_POSITIVE)?;
        Some(Line { start: frame.pose.transform_point(&place.point), along })
    }

    /// Looks at the places where the line crosses a link; returns their number.
    fn follow_on(&mut self, samples: usize, line: &Line) -> usize {
        let link = self.samples.links[samples].link;
        let Some(surface) = self.robot.links()[link].surface.as_ref() else { return 0 };
        let pose = &self.newest().frames().links[link].pose;
        let (start, along) =
            (pose.inverse_transform_point(&line.start), pose.inverse_transform_vector(&line.along));
        let (centre, radius) = surface.bounding_sphere();
        if (centre - start).cross(&along).norm() > radius {
            return 0;
        }
        let from = start + along * ((centre - start).dot(&along) - 2.0 * radius);
        let mut hits = std::mem::take(&mut self.hits);
        hits.clear();
        surface.cast_line_into(&from, &along, f64::NEG_INFINITY, &mut hits);
        hits.iter().for_each(|hit| self.add_place(samples, hit, &along));
        let looked_at = hits.len();
        self.hits = hits;
        looked_at
    }

    /// A push where the line enters, a pull where it leaves: a piece moves there, or the sample that it is on is added.
    fn add_place(&mut self, samples: usize, hit: &RayHit, along: &Vector3<f64>) {
        let samples = &self.samples.links[samples];
        let (link, pulls) = (samples.link, hit.normal.dot(along) > 0.0);
        let hidden = |surface: &Arc<Surface>| surface.hides(&hit.point, hit.triangle);
        if self.robot.links()[link].surface.as_ref().is_none_or(hidden) {
            return;
        }
        let squared = |place: &SurfacePoint| (place.point - hit.point).norm_squared();
        let is_on =
            |leaf: &Leaf| leaf.link == link && leaf.pulls == pulls && squared(&leaf.place) < leaf.area;
        let nearest = |a: &usize, b: &usize| {
            squared(&self.leaves[*a].place).total_cmp(&squared(&self.leaves[*b].place))
        };
        let known = (0..self.leaves.len()).filter(|k| is_on(&self.leaves[*k])).min_by(nearest);
        let area = known.map(|known| self.leaves[known].area).or_else(|| {
            let faces = samples.places.iter().zip(&samples.areas);
            let faces = faces.filter(|(place, _)| place.normal.dot(&hit.normal) > 0.0);
            let nearest = faces.min_by(|a, b| squared(a.0).total_cmp(&squared(b.0)));
            nearest.map(|(_, area)| *area)
        });
        let Some(area) = area else { return };
        let place = SurfacePoint { point: hit.point, normal: hit.normal, triangle: hit.triangle };
        let block = PlaceBlock::new(&[(place.point, place.normal, area); LANES]);
        let found = self.measurements.likelihood(&self.prior, link, &block);
        let (log, force) = (found.log[usize::from(pulls)][0], found.force[usize::from(pulls)][0]);
        let log_weight = log + self.measurements.without_contact() + self.samples.log_prior(link, area);
        let piece = Leaf { link, place, area, pulls, log_weight, force, spread: Leaf::width(area) };
        match known {
            Some(known) if log_weight > self.leaves[known].log_weight => self.leaves[known] = piece,
            Some(_) => {}
            None if self.leaves.len() < self.leaves.capacity() => self.leaves.push(piece),
            None => {}
        }
    }
}
