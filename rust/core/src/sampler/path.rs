//! From what the measurements before the newest one say to what they say with it: the model that the kernel is given.

use nalgebra::Vector3;

use super::hypothesis::{Claim, ContactModel, Forces, Hypothesis, Touch};
use super::measurements::{Measurement, Measurements};
use super::sums::{Marginal, Prior, Sums};
use crate::math::random::Stream;
use crate::particle::{signed, tangent};
use crate::posterior::tempering::{Logs, Path, Wanted};
use crate::robot::Robot;
use crate::surface::{Surface, SurfacePoint};
use crate::torque::{directions, ForceModel, Frame, LinkTarget, NormalFit};

/// Share of moves by a difference of two other hypotheses on the link, which has the scale and the direction of what is not known yet
/// (differential evolution; ter Braak 2006); and of those the share that take the whole of it, the others take a part.
const LIKE_OTHERS: f64 = 0.7;
const WHOLE_DIFFERENCES: f64 = 0.2;
/// So many others are looked at for two on the link.
const PAIR_DRAWS: u64 = 16;
/// Standard deviation of other moves along the surface: its logarithm is uniform between those of these (m).
const STEPS: [f64; 2] = [2e-4, 5e-2];
/// Of a move of the logarithm of the radius.
const RADIUS_STEP: f64 = 0.6;
/// Shares of those along the surface alone and of the radius alone, added up; the rest are both.
const ALONE: [f64; 2] = [0.4, 0.6];
/// Share of moves that take another model.
const MODEL_MOVES: f64 = 0.2;

/// The model of a contact.
pub(super) struct ContactPath<'a> {
    pub robot: &'a Robot,
    pub measurements: &'a Measurements,
    pub models: &'a [ContactModel],
    pub prior: Prior,
    pub force_model: ForceModel,
    pub log_radius: [f64; 2],
}

impl ContactPath<'_> {
    fn surface(&self, link: u32) -> Option<&Surface> {
        self.robot.links()[link as usize].surface.as_deref()
    }

    /// A hypothesis of all measurements; none where its link has no surface or it is surely not wanted.
    pub fn make(&self, claim: Claim, wanted: Option<Wanted>) -> Option<Hypothesis> {
        let surface = self.surface(claim.link)?;
        let place = &claim.place;
        let away = match claim.model {
            ContactModel::Obstacle => place.normal * claim.log_radius.exp(),
            ContactModel::Person | ContactModel::Both => Vector3::zeros(),
        };
        let anchor = self.measurements.first[claim.link as usize].transform_point(&(place.point + away));
        let mut touch = Touch {
            point: place.point,
            normal: place.normal,
            triangle: place.triangle,
            forces: Forces::default(),
            sums: Sums::default(),
        };
        let (mut before, mut now) = (Sums::default(), Sums::default());
        let mut newest = touch;
        for (number, measurement) in self.measurements.scattered().enumerate() {
            touch = self.touch(surface, &claim, &anchor, measurement, touch.triangle);
            let Measurement { before: share_before, now: share_now, .. } = *measurement;
            before.add(share_before, &touch.sums);
            now.add(share_now, &touch.sums);
            if number == 0 {
                newest = touch;
            }
            // Not each time: to look costs a part of what it saves.
            let look = (number + 1).is_power_of_two();
            if wanted.is_some_and(|wanted| look && !wanted.takes(self.most(&before, &now))) {
                return None;
            }
        }
        let start = self.prior.integrate(&before).log;
        let (marginal, logs) = self.marginal(&now, start);
        Some(Hypothesis { claim, anchor, now, touch: newest, logs, marginal })
    }

    /// What the densities can be at most, whatever other measurements say.
    fn most(&self, before: &Sums, now: &Sums) -> Logs {
        let [rows_before, rows_now] = self.measurements.rows;
        let (start, end) = (self.prior.most(before, rows_before), self.prior.most(now, rows_now));
        Logs { start, added: end - start }
    }

    /// Takes the newest measurement into a hypothesis that knows those before it.
    pub fn follow(&self, hypothesis: &mut Hypothesis) {
        let Hypothesis { claim, anchor, .. } = hypothesis;
        let Some(surface) = self.surface(claim.link) else { return };
        if let Some(dropped) = self.measurements.dropped() {
            let touch = self.touch(surface, claim, anchor, dropped, claim.place.triangle);
            hypothesis.now.add(-dropped.before, &touch.sums);
        }
        let newest = self.measurements.newest();
        hypothesis.touch = self.touch(surface, claim, anchor, newest, hypothesis.touch.triangle);
        hypothesis.now.scale(self.measurements.kept);
        hypothesis.now.add(1.0, &hypothesis.touch.sums);
        (hypothesis.marginal, hypothesis.logs) = self.marginal(&hypothesis.now, hypothesis.marginal.log);
    }

    /// `start`: the logarithm of the likelihood before the newest measurement.
    fn marginal(&self, now: &Sums, start: f64) -> (Marginal, Logs) {
        let marginal = self.prior.integrate(now);
        let end = marginal.log;
        // From a density of zero no way leads back.
        let added = if start == f64::NEG_INFINITY { 0.0 } else { end - start };
        (marginal, Logs { start, added })
    }

    fn touch(
        &self,
        surface: &Surface,
        claim: &Claim,
        anchor: &Vector3<f64>,
        measurement: &Measurement,
        triangle: Option<u32>,
    ) -> Touch {
        let mut touch = self.contact(surface, claim, anchor, measurement, triangle);
        touch.sums.rows = measurement.rows;
        touch
    }

    fn contact(
        &self,
        surface: &Surface,
        claim: &Claim,
        anchor: &Vector3<f64>,
        measurement: &Measurement,
        triangle: Option<u32>,
    ) -> Touch {
        let link = claim.link as usize;
        let (frame, target) = (&measurement.links[link], measurement.target.on(link));
        let squared = measurement.target.squared;
        let place = &claim.place;
        let at_first = |forces, sums| Touch {
            point: place.point,
            normal: place.normal,
            triangle: place.triangle,
            forces,
            sums,
        };
        match claim.model {
            ContactModel::Obstacle => {
                let local = frame.pose.inverse_transform_point(anchor);
                let near = surface.closest_point_near(&local, triangle);
                let (distance, normal) = signed(&near, &local);
                let deeper = claim.log_radius.exp() - distance;
                let fit = self.fit(frame, target, squared, &near.point, &normal);
                let forces = Forces { first: -normal, spring: -normal * deeper, ..Forces::default() };
                let sums = Sums::along(&fit, deeper);
                Touch { point: near.point, normal, triangle: near.triangle, forces, sums }
            }
            ContactModel::Person => {
                let fit = self.fit(frame, target, squared, &place.point, &place.normal);
                let (sums, force) = Sums::free(&fit, &self.prior);
                at_first(Forces { known: -place.normal * force, ..Forces::default() }, sums)
            }
            ContactModel::Both => {
                let first = &self.measurements.first[link];
                let inward = -(frame.pose.rotation.transpose() * (first.rotation * place.normal));
                let stretch = frame.pose.inverse_transform_point(anchor) - place.point;
                let (gram, products) =
                    frame.responses(&place.point, &[inward, stretch, Vector3::zeros()], target);
                let gain = [gram[(0, 0)], gram[(0, 1)], gram[(1, 1)]];
                let sums = Sums::of_two(gain, [products[0], products[1]], squared);
                at_first(Forces { first: inward, spring: stretch, ..Forces::default() }, sums)
            }
        }
    }

    fn fit(
        &self,
        frame: &Frame,
        target: &LinkTarget,
        squared: f64,
        point: &Vector3<f64>,
        normal: &Vector3<f64>,
    ) -> NormalFit {
        let (gain, product) = frame.response(point, normal, target);
        let bare = NormalFit { gain, product, target: squared, penalty: 0.0 };
        match self.force_model.deviation_across(self.prior.force_of(&bare)) {
            Some(deviation) => {
                let (gram, products) = frame.responses(point, &directions(normal), target);
                NormalFit::without_friction(&gram, &products, squared, deviation * deviation)
            }
            None => bare,
        }
    }
}

impl Path for ContactPath<'_> {
    type Sample = Hypothesis;

    fn logs(&self, sample: &Hypothesis) -> Logs {
        sample.logs
    }

    fn propose(
        &self,
        sample: &Hypothesis,
        others: &[Hypothesis],
        wanted: Wanted,
        random: &Stream,
        first: u64,
    ) -> Option<Hypothesis> {
        let draw = |k: u64| random.uniform(first + k);
        let mut claim = sample.claim;
        if self.models.len() > 1 && draw(0) < MODEL_MOVES {
            claim.model = self.models[(draw(1) * self.models.len() as f64) as usize];
        }
        let (aside, of_radius) = if draw(2) < LIKE_OTHERS {
            let (one, other) = pair(others, claim.link, |k| draw(8 + k))?;
            let share = if draw(3) < WHOLE_DIFFERENCES { 1.0 } else { draw(4) };
            ((one.place.point - other.place.point) * share, (one.log_radius - other.log_radius) * share)
        } else {
            let scale = STEPS[0] * (STEPS[1] / STEPS[0]).powf(draw(3));
            let [along, beside] = random.normals(first + 4);
            let aside = tangent(&claim.place.normal, along * scale, beside * scale);
            let of_radius = RADIUS_STEP * random.normals(first + 6)[0];
            match draw(8) {
                x if x < ALONE[0] => (aside, 0.0),
                x if x < ALONE[1] => (Vector3::zeros(), of_radius),
                _ => (aside, of_radius),
            }
        };
        claim.log_radius += of_radius;
        let [least, greatest] = self.log_radius;
        if !(least..=greatest).contains(&claim.log_radius) {
            return None;
        }
        if aside != Vector3::zeros() {
            let surface = self.surface(claim.link)?;
            let near = surface.closest_point_near(&(claim.place.point + aside), claim.place.triangle);
            if surface.hides(&near.point, near.triangle) {
                return None;
            }
            claim.place = SurfacePoint { point: near.point, normal: near.normal, triangle: near.triangle };
        }
        self.make(claim, Some(wanted))
    }
}

/// Two of the others on a link, by chance.
fn pair(others: &[Hypothesis], link: u32, draw: impl Fn(u64) -> f64) -> Option<(&Claim, &Claim)> {
    let mut found = (0..PAIR_DRAWS)
        .map(|k| &others[(draw(k) * others.len() as f64) as usize].claim)
        .filter(|claim| claim.link == link);
    Some((found.next()?, found.next()?))
}
