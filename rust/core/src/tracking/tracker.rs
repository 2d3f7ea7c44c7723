//! Follows a contact from its onset to its end, and fuses what its torques say of the place (algorithm D4).

use std::sync::Arc;

use nalgebra::Vector3;

use super::evidence::TickEvidence;
use super::identities::Identities;
use crate::error::Result;
use crate::isolation::{Contact, ContactPlace, ContactPosterior, Isolation, LinkProbability};
use crate::map::{MapOptions, Measurement, Summary, SurfacePosterior};
use crate::posterior::{Mode, MOST_MODES};
use crate::robot::{LinkIndex, Robot};
use crate::spatial::vector::stack;
use crate::torque::{best_cone_force, directions, BestForce, ForceModel, TorqueNoise};

/// Time between two measurements of a contact that are kept (s), and the same as a share of the contact's age: so they are
/// spread over all of it.
const INTERVAL: f64 = 0.025;
const INTERVAL_SHARE: f64 = 0.25;
/// A torque that is less than this share of the strongest one of the contact, in standard deviations, tells little.
const STRONG: f64 = 0.6;
/// One that is so many times as large tells more at once.
const GROWN: f64 = 1.3;
/// A torque that is left out counts with so many times its standard deviation.
const LEFT_OUT: f64 = 1e6;
/// Redundant torques agree with one force but for this share only where torques have no noise: then a closed form is exact.
const EXACT: f64 = 1e-6;
/// A closed form that explains the torques better by so much, in squared standard deviations, shows a place that the samples
/// have missed: 99.9 % of a chi-square of the five unknowns of a force on a line of action.
const LOST: f64 = 20.5;
/// A normal force is determined if it exceeds so many standard deviations.
const DETERMINED: f64 = 2.0;
/// A closed form gives a contact's point if that is not farther from the posterior's than its region's radius, or this (m).
const AGREES: f64 = 0.01;

/// Follows contacts.
#[derive(Debug, Clone)]
pub(crate) struct ContactTracker {
    robot: Arc<Robot>,
    /// That are looked on.
    links: Vec<LinkIndex>,
    posterior: SurfacePosterior,
    summary: Summary,
    noise: TorqueNoise,
    friction: f64,
    locate_within: f64,
    /// Standard deviations of a tick's torque without contact, and with the errors that grow with a contact's (Nm, N).
    deviation: Vec<f64>,
    in_contact: Vec<f64>,
    left: Vec<f64>,
    identities: Identities,
    /// Where the contact can be by the last posterior that was worked out: points, forces and normals in the links' frames.
    place: Option<Mode>,
    modes: Vec<Mode>,
    /// For the force of a tick, on one link alone.
    now: Measurement,
    /// Of the onset, and of the last measurement (s); none without contact.
    since: Option<f64>,
    measured: f64,
    /// Norm of the torque over its standard deviations: of this tick, the greatest of the measurements, and of those that
    /// the place is from.
    strength: f64,
    strongest: f64,
    concluded: f64,
}

impl ContactTracker {
    /// # Errors
    /// [`crate::Error::Input`] names the option.
    pub fn new(robot: Arc<Robot>, samples: usize, noise: TorqueNoise, locate_within: f64) -> Result<Self> {
        let options = MapOptions { samples, ..MapOptions::default() };
        let wanted = options.check(&robot)?;
        let posterior = SurfacePosterior::new(robot.clone(), &options, &wanted)?;
        Ok(ContactTracker {
            summary: Summary::new(&robot, wanted.len(), options.friction, &posterior),
            links: wanted.iter().copied().map(LinkIndex::new).collect(),
            posterior,
            noise,
            locate_within,
            deviation: vec![1.0; robot.nv()],
            in_contact: vec![1.0; robot.nv()],
            left: vec![0.0; robot.nv()],
            identities: Identities::new(),
            place: None,
            modes: Vec::with_capacity(MOST_MODES),
            now: Measurement::new(&robot, wanted),
            friction: options.friction,
            since: None,
            measured: 0.0,
            strength: 0.0,
            strongest: 0.0,
            concluded: 0.0,
            robot,
        })
    }

    /// A tick with contact: takes in its evidence, and puts the posterior's answer in place of what closed forms found, where
    /// one contact explains the torques.
    pub fn follow(&mut self, evidence: &TickEvidence<'_>, isolation: &mut Isolation) {
        self.take_in(evidence);
        if !self.posterior.is_done() && self.posterior.step() {
            self.conclude();
        }
        self.answer(evidence, isolation);
        self.identities.name(&mut isolation.contacts, evidence.time);
    }

    /// A tick without contact.
    pub fn rest(&mut self) {
        if self.since.take().is_some() {
            self.posterior.forget();
            self.identities.end();
            self.place = None;
        }
    }

    /// Forgets all contacts.
    pub fn reset(&mut self) {
        self.rest();
        self.identities.reset();
    }

    /// Keeps a measurement from time to time.
    fn take_in(&mut self, evidence: &TickEvidence<'_>) {
        let age = evidence.time - *self.since.get_or_insert(evidence.time);
        let interval = INTERVAL.max(INTERVAL_SHARE * age);
        let first = age == 0.0;
        self.weigh(evidence);
        let shares =
            evidence.torque.iter().zip(&self.deviation).map(|(torque, deviation)| torque / deviation);
        let strength = shares.map(|share| share * share).sum::<f64>().sqrt();
        self.strength = strength;
        let due = evidence.time - self.measured >= interval || strength > GROWN * self.strongest;
        if !first && (!self.posterior.is_done() || !due || strength < STRONG * self.strongest) {
            return;
        }
        if first || self.strongest < STRONG * strength {
            self.posterior.forget();
        }
        self.strongest = if first { strength } else { self.strongest.max(strength) };
        self.measured = evidence.time;
        let Self { posterior, noise, deviation, in_contact, .. } = self;
        noise.set_deviations_beside(deviation, evidence.torque, in_contact);
        posterior.measure(evidence.kinematics, evidence.torque, in_contact);
    }

    /// Standard deviations without contact.
    fn weigh(&mut self, evidence: &TickEvidence<'_>) {
        for (k, deviation) in self.deviation.iter_mut().enumerate() {
            let factor = if evidence.left_out[k] { LEFT_OUT } else { 1.0 };
            *deviation = evidence.deviation[k] * factor;
        }
    }

    fn conclude(&mut self) {
        self.concluded = self.strongest;
        let found = self.summary.read(&self.posterior);
        let frames = self.posterior.newest().frames();
        let local = |mode: &Mode| mode.in_link_frame(&frames.links[mode.link.get()].pose);
        self.place = found.estimate.contact.as_ref().map(local);
        self.modes.clear();
        self.modes.extend(found.estimate.modes.iter().map(local));
    }

    /// The force of a tick at a place on a link, in its frame (N); none where the torques do not determine it.
    fn force(&mut self, evidence: &TickEvidence<'_>, place: &Mode) -> Option<Vector3<f64>> {
        let link = place.link.get();
        self.now.set_on(link, &self.robot, evidence.kinematics, evidence.newest, &self.deviation);
        let (frame, target) = (&self.now.frames().links[link], self.now.target().on(link));
        let outward = place.pushed_normal();
        let best =
            BestForce::of(frame, target, ForceModel::FrictionCone(self.friction), &place.point, &outward);
        if best.normal <= DETERMINED * best.variance.sqrt() {
            return None;
        }
        let directions = directions(&outward);
        let (gram, products) = frame.responses(&place.point, &directions, target);
        let parts = best_cone_force(&gram, &products, self.friction).force;
        Some(directions[0] * parts.x + directions[1] * parts.y + directions[2] * parts.z)
    }

    /// Squared norm of what a force at a point of a link leaves over of a tick's torque, in standard deviations (in the link's
    /// frame).
    fn misfit(
        &mut self,
        evidence: &TickEvidence<'_>,
        link: LinkIndex,
        point: &Vector3<f64>,
        force: &Vector3<f64>,
    ) -> f64 {
        let Self { now, robot, noise, deviation, in_contact, left, .. } = self;
        noise.set_deviations_beside(deviation, evidence.newest, in_contact);
        now.set_on(link.get(), robot, evidence.kinematics, evidence.newest, in_contact);
        now.left_over(link.get(), point, force, left)
    }

    fn answer(&mut self, evidence: &TickEvidence<'_>, isolation: &mut Isolation) {
        let Some(place) = self.place else { return };
        let found = self.summary.estimate();
        let sensed = isolation.contacts.iter().any(|contact| contact.source.is_some());
        let several = isolation.contacts.len() > 1;
        if sensed || (several && !found.explained) {
            return;
        }
        // A torque that has grown since tells more than the posterior yet knows.
        let outdated = self.strength > GROWN * self.concluded;
        if outdated && !isolation.contacts.is_empty() {
            return;
        }
        let explained = found.explained;
        let pose = evidence.kinematics.link_pose(&self.robot, place.link);
        let point = pose.transform_point(&place.point);
        let region_radius = found.region_radius.unwrap_or(f64::INFINITY);
        let covariance = found.estimate.covariance.unwrap_or_default();
        let closed_form = isolation.contacts.first().filter(|contact| !several && contact.located).cloned();
        let agrees = |contact: &Contact| {
            let near = |other: ContactPlace| (other.point - point).norm() <= region_radius.max(AGREES);
            contact.link == place.link && contact.place.is_some_and(near)
        };
        let contradicted = closed_form.as_ref().filter(|contact| !agrees(contact));
        if let Some(other) = contradicted {
            let size = evidence.newest.iter().map(|torque| torque * torque).sum::<f64>().sqrt();
            if other.verified && isolation.residual < EXACT * size {
                return;
            }
            let force = self.force(evidence, &place).unwrap_or_default();
            let own = self.misfit(evidence, place.link, &place.point, &force);
            let pose = evidence.kinematics.link_pose(&self.robot, other.link);
            let at = other.place.map_or(Vector3::zeros(), |place| place.point_local);
            let push = pose.inverse_transform_vector(&other.force().unwrap_or_default());
            if own > LOST + self.misfit(evidence, other.link, &at, &push) {
                return;
            }
        }
        // Two answers that both explain the torques: neither is sure.
        let sure = contradicted.is_none() && region_radius <= self.locate_within;
        let mut contact = closed_form.filter(agrees).unwrap_or_else(|| {
            let force = self.force(evidence, &place).map(|force| pose.rotation * force);
            Contact {
                place: Some(ContactPlace {
                    point,
                    point_local: place.point,
                    normal: pose.rotation * place.normal,
                    std: covariance.trace().sqrt(),
                }),
                wrench: force.map(|force| stack(&force, &(point - pose.translation).cross(&force))),
                verified: explained && self.robot.chain(self.robot[place.link].body).len() > LINE_UNKNOWNS,
                ..Contact::unlocated(place.link)
            }
        });
        contact.located = sure;
        isolation.modes.clear();
        isolation.modes.extend(
            self.modes
                .iter()
                .map(|mode| mode.in_world_frame(&evidence.kinematics.link_pose(&self.robot, mode.link))),
        );
        isolation.link_probabilities.clear();
        let links = self.links.iter().zip(&self.summary.estimate().estimate.link_probabilities);
        isolation
            .link_probabilities
            .extend(links.map(|(&link, &probability)| LinkProbability { link, probability }));
        let own = isolation.link_probabilities.iter().find(|other| other.link == place.link);
        contact.posterior = Some(ContactPosterior {
            probability: own.map_or(0.0, |own| own.probability),
            covariance,
            region_radius,
            modes: 0..isolation.modes.len(),
            link_probabilities: 0..isolation.link_probabilities.len(),
        });
        isolation.contacts.clear();
        isolation.contacts.push(contact);
    }
}

/// Unknowns of a force on a line of action: a contact is checked only by torques beyond these.
const LINE_UNKNOWNS: usize = 5;
