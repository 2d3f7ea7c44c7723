//! From what the measurements before the newest one say to what they say with it: the model that the kernel is given.

use nalgebra::Vector3;

use super::hypothesis::Hypothesis;
use super::measurements::{Measurement, Measurements};
use super::sums::{Prior, Sums};
use crate::math::random::Stream;
use crate::particle::{signed, tangent};
use crate::posterior::tempering::{Logs, Path};
use crate::robot::Robot;
use crate::surface::{Surface, SurfacePoint};
use crate::torque::{directions, ForceModel, Frame, LinkTarget, NormalFit};

/// Standard deviation of a move along the surface: its logarithm is uniform between those of these (m).
const STEPS: [f64; 2] = [2e-4, 5e-2];
/// Of a move of the logarithm of the radius.
const RADIUS_STEP: f64 = 0.6;
/// Shares of moves along the surface alone and of the radius alone; the others are both.
const ALONE: [f64; 2] = [0.4, 0.6];

/// The model of an obstacle that stays.
pub(super) struct ObstaclePath<'a> {
    pub robot: &'a Robot,
    pub measurements: &'a Measurements,
    pub prior: Prior,
    pub force_model: ForceModel,
    pub log_radius: [f64; 2],
}

/// A contact at one pose.
struct Touch {
    point: Vector3<f64>,
    normal: Vector3<f64>,
    triangle: Option<u32>,
    deeper: f64,
    sums: Sums,
}

impl ObstaclePath<'_> {
    fn surface(&self, link: u32) -> Option<&Surface> {
        self.robot.links()[link as usize].surface.as_deref()
    }

    /// A hypothesis of all measurements; none where its link has no surface.
    pub fn make(&self, link: u32, place: SurfacePoint, log_radius: f64) -> Option<Hypothesis> {
        let surface = self.surface(link)?;
        let radius = log_radius.exp();
        let centre =
            self.measurements.first[link as usize].transform_point(&(place.point + place.normal * radius));
        let mut made = Hypothesis {
            link,
            place,
            log_radius,
            centre,
            now: Sums::default(),
            point: place.point,
            normal: place.normal,
            triangle: place.triangle,
            deeper: 0.0,
            logs: Logs { start: 0.0, added: 0.0 },
            marginal: self.prior.integrate(&Sums::default()),
        };
        let mut before = Sums::default();
        for measurement in self.measurements.iter() {
            let touch = self.touch(surface, &made, measurement, made.triangle);
            if measurement.before {
                before += &touch.sums;
            }
            if measurement.now {
                made.now += &touch.sums;
            }
            (made.point, made.normal) = (touch.point, touch.normal);
            (made.triangle, made.deeper) = (touch.triangle, touch.deeper);
        }
        self.set_logs(&mut made, self.prior.integrate(&before).log);
        Some(made)
    }

    /// Takes the newest measurement into a hypothesis that knows those before it.
    pub fn follow(&self, hypothesis: &mut Hypothesis) {
        let Some(surface) = self.surface(hypothesis.link) else { return };
        if let Some(dropped) = self.measurements.dropped() {
            let touch = self.touch(surface, hypothesis, dropped, hypothesis.place.triangle);
            hypothesis.now -= &touch.sums;
        }
        let touch = self.touch(surface, hypothesis, self.measurements.newest(), hypothesis.triangle);
        hypothesis.now += &touch.sums;
        (hypothesis.point, hypothesis.normal) = (touch.point, touch.normal);
        (hypothesis.triangle, hypothesis.deeper) = (touch.triangle, touch.deeper);
        self.set_logs(hypothesis, hypothesis.marginal.log);
    }

    /// `start`: the logarithm of the likelihood before the newest measurement.
    fn set_logs(&self, hypothesis: &mut Hypothesis, start: f64) {
        hypothesis.marginal = self.prior.integrate(&hypothesis.now);
        let end = hypothesis.marginal.log;
        // From a density of zero no way leads back.
        let added = if start == f64::NEG_INFINITY { 0.0 } else { end - start };
        hypothesis.logs = Logs { start, added };
    }

    fn touch(
        &self,
        surface: &Surface,
        hypothesis: &Hypothesis,
        measurement: &Measurement,
        triangle: Option<u32>,
    ) -> Touch {
        let link = hypothesis.link as usize;
        let (frame, target) = (&measurement.links[link], measurement.target.on(link));
        let local = frame.pose.inverse_transform_point(&hypothesis.centre);
        let near = surface.closest_point_near(&local, triangle);
        let (distance, normal) = signed(&near, &local);
        let deeper = hypothesis.log_radius.exp() - distance;
        let fit = self.fit(frame, target, measurement.target.squared, &near.point, &normal);
        Touch { point: near.point, normal, triangle: near.triangle, deeper, sums: Sums::of(&fit, deeper) }
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
        let [least, greatest] = self.prior.force;
        let force = if gain > 0.0 { (product / gain).clamp(least, greatest) } else { least };
        match self.force_model.deviation_across(force) {
            Some(deviation) => {
                let (gram, products) = frame.responses(point, &directions(normal), target);
                NormalFit::without_friction(&gram, &products, squared, deviation * deviation)
            }
            None => NormalFit { gain, product, target: squared, penalty: 0.0 },
        }
    }
}

impl Path for ObstaclePath<'_> {
    type Sample = Hypothesis;

    fn logs(&self, sample: &Hypothesis) -> Logs {
        sample.logs
    }

    fn propose(&self, sample: &Hypothesis, random: &Stream, first: u64) -> Option<Hypothesis> {
        let surface = self.surface(sample.link)?;
        let kind = random.uniform(first);
        let mut place = sample.place;
        if !(ALONE[0]..ALONE[1]).contains(&kind) {
            let scale = STEPS[0] * (STEPS[1] / STEPS[0]).powf(random.uniform(first + 1));
            let [along, beside] = random.normals(first + 2);
            let aside = tangent(&place.normal, along * scale, beside * scale);
            let near = surface.closest_point_near(&(place.point + aside), place.triangle);
            if surface.hides(&near.point, near.triangle) {
                return None;
            }
            place = SurfacePoint { point: near.point, normal: near.normal, triangle: near.triangle };
        }
        let mut log_radius = sample.log_radius;
        if kind >= ALONE[0] {
            log_radius += RADIUS_STEP * random.normals(first + 4)[0];
            let [least, greatest] = self.log_radius;
            if !(least..=greatest).contains(&log_radius) {
                return None;
            }
        }
        self.make(sample.link, place, log_radius)
    }
}
