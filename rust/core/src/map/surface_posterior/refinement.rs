//! Smaller pieces of surface where the posterior is narrower than samples are apart.

use nalgebra::Vector3;

use super::{Leaf, Stage, SurfacePosterior, DIVIDED, MOST_DIVIDED, STEP};
use crate::surface::{Surface, SurfacePoint};
use crate::torque::{PlaceBlock, PlaceStep, LANES, PIECE};

/// The best piece of another link or side is divided too where its weight's logarithm is less than this below the best: that
/// of its middle may be far below that of its best point.
const RIVAL: f64 = 30.0;
/// So many places of a link and side are followed, at least this far apart (edges of a piece): a line of action may enter a link
/// more than once.
pub(super) const PLACES: usize = 3;
const APART: f64 = 3.0;
/// Moves of a piece before it is divided, and the shares of a step that are tried: the surface is curved.
const UPHILL: usize = 2;
const SHARES: [f64; LANES] = [1.0, 0.5, 0.25, 0.0];
/// What it takes to find the four parts of a piece on the surface, in likelihoods of blocks.
const PROJECTION: usize = 4;

impl SurfacePosterior {
    /// The pieces to divide: the weightiest, and the best one of each link and side that smaller pieces may still favour.
    pub(super) fn choose(&mut self, best: usize) {
        let Self { leaves, weights, order, sides, .. } = self;
        let floor = DIVIDED * weights[best];
        order.clear();
        order.extend((0..leaves.len() as u32).filter(|k| weights[*k as usize] > floor));
        if order.len() > MOST_DIVIDED {
            let weight = |k: &u32| weights[*k as usize];
            order.select_nth_unstable_by(MOST_DIVIDED, |a, b| weight(b).total_cmp(&weight(a)).then(a.cmp(b)));
            order.truncate(MOST_DIVIDED);
        }
        sides.fill([None; PLACES]);
        for rank in 0..PLACES {
            for (k, leaf) in leaves.iter().enumerate() {
                let places = &mut sides[2 * leaf.link + usize::from(leaf.pulls)];
                let beside = |other: &Option<usize>| {
                    let near = |other: usize| (leaves[other].place.point - leaf.place.point).norm();
                    other.is_some_and(|other| near(other) < APART * self.edge)
                };
                let known = places[..rank].iter().any(|other| other.is_none() || beside(other));
                let place = &mut places[rank];
                if !known && place.is_none_or(|other: usize| leaves[other].log_weight < leaf.log_weight) {
                    *place = Some(k);
                }
            }
        }
        let least = leaves[best].log_weight - RIVAL;
        let rivals = sides
            .iter()
            .flatten()
            .flatten()
            .filter(|k| weights[**k] <= floor && leaves[**k].log_weight > least);
        order.extend(rivals.take(MOST_DIVIDED).map(|k| *k as u32));
    }

    /// Divides pieces into four each, on the true surface.
    pub(super) fn divide(&mut self, mut next: usize) -> Stage {
        let without = self.measurements.without_contact();
        let mut work = 0;
        while let Some(&index) = self.order.get(next) {
            if work >= STEP {
                return Stage::Pieces { next };
            }
            (next, work) = (next + 1, work + self.measurements.all().len() + PROJECTION);
            let mut leaf = self.leaves[index as usize];
            let best = self.sides[2 * leaf.link + usize::from(leaf.pulls)].contains(&Some(index as usize));
            if best {
                leaf.place = self.uphill(&leaf);
                work += PROJECTION;
            }
            let Some(surface) = self.robot.links()[leaf.link].surface.as_ref() else { continue };
            let area = 0.25 * leaf.area;
            let (places, block) = projected(surface, leaf.quarters(), area, leaf.place.triangle);
            let found = self.measurements.likelihood(&self.prior, leaf.link, &block);
            let side = usize::from(leaf.pulls);
            let parts = places.into_iter().zip(found.log[side]).zip(found.force[side]);
            for (k, ((place, log), force)) in parts.enumerate() {
                let hidden = surface.hides(&place.point, place.triangle);
                let prior = self.samples.log_prior(leaf.link, area);
                let log_weight = if hidden { f64::NEG_INFINITY } else { log + without + prior };
                let part = Leaf { place, area, log_weight, force, spread: Leaf::width(area), ..leaf };
                if k == 0 {
                    self.leaves[index as usize] = part;
                } else {
                    self.leaves.push(part);
                }
            }
        }
        self.next_level()
    }

    /// The place of a piece, moved on the surface to where the torques are likelier by up to its own size: pieces do not cover
    /// the surface exactly, and the best point may lie between them.
    fn uphill(&self, leaf: &Leaf) -> SurfacePoint {
        let Some(surface) = self.robot.links()[leaf.link].surface.as_ref() else { return leaf.place };
        let (mut place, reach) = (leaf.place, leaf.area.sqrt());
        for _ in 0..UPHILL {
            let Some(step) = self.step_from(leaf, &place, reach) else { break };
            let tried = SHARES.map(|share| place.point + step * share);
            let (places, block) = projected(surface, tried, leaf.area, place.triangle);
            let logs =
                self.measurements.likelihood(&self.prior, leaf.link, &block).log[usize::from(leaf.pulls)];
            // The last share is none.
            let best = (0..LANES).fold(LANES - 1, |best, k| if logs[k] > logs[best] { k } else { best });
            if best == LANES - 1 || surface.hides(&places[best].point, places[best].triangle) {
                break;
            }
            place = places[best];
        }
        place
    }

    /// The step to where the torques are likeliest, at most `reach` (m).
    fn step_from(&self, leaf: &Leaf, place: &SurfacePoint, reach: f64) -> Option<Vector3<f64>> {
        self.normal_equations(leaf, place).displacement(reach).map(|step| step.cap_magnitude(reach))
    }

    /// Root mean square of a contact's distance from the place of a piece that it is on (m).
    pub(super) fn spread(&self, leaf: usize) -> f64 {
        let leaf = &self.leaves[leaf];
        self.normal_equations(leaf, &leaf.place).spread(PIECE * leaf.area.sqrt())
    }

    fn normal_equations(&self, leaf: &Leaf, place: &SurfacePoint) -> PlaceStep {
        let mut step = PlaceStep::at(&place.point, &place.normal);
        let known = self.measurements.all();
        for measurement in known {
            let (frames, target) = (measurement.frames(), measurement.target());
            let (frame, target) = (&frames.links[leaf.link], target.on(leaf.link));
            self.prior.add_to(&mut step, frame, target, leaf.pulls, 1.0 / known.len() as f64);
        }
        step
    }
}

/// Pieces of an area (m^2) about the points of the surface nearest to these, around a triangle.
fn projected(
    surface: &Surface,
    points: [Vector3<f64>; LANES],
    area: f64,
    triangle: Option<u32>,
) -> ([SurfacePoint; LANES], PlaceBlock) {
    let places = points.map(|point| SurfacePoint::from(surface.closest_point_near(&point, triangle)));
    (places, PlaceBlock::new(&places.map(|place| (place.point, place.normal, area))))
}
