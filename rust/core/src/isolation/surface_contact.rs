//! The contact that explains a torque best by the posterior over all surface, beside what closed forms found (algorithms D4, D6).

use std::sync::Arc;

use nalgebra::Vector3;

use super::contact_evidence::ContactEvidence;
use super::posterior::{ContactPosterior, LinkProbability};
use super::result::{Contact, ContactPlace, Isolation};
use super::torque_now::TorqueNow;
use super::wrench::LINE_UNKNOWNS;
use crate::error::Result;
use crate::map::{MapOptions, Measurement, Summary, SurfacePosterior, GREATEST_FORCE};
use crate::posterior::{Mode, MOST_MODES};
use crate::robot::{LinkIndex, Robot};
use crate::sensor::SensorTree;
use crate::spatial::vector::stack;
use crate::torque::{best_cone_force, directions, BestForce, ForceModel, TorqueNoise};

/// Redundant torques agree with one force but for this share only where torques have no noise: then a closed form is exact.
const EXACT: f64 = 1e-6;
/// A closed form that explains the torques better by so much, in squared standard deviations, shows a place that the samples
/// have missed: 99.9 % of a chi-square of the five unknowns of a force on a line of action.
const LOST: f64 = 20.5;
/// A normal force is determined if it exceeds so many standard deviations.
const DETERMINED: f64 = 2.0;
/// A force across the normal is likely if it does not exceed so many of its standard deviations beforehand: 99 % of a
/// chi-square of two unknowns, squared.
const LIKELY: f64 = 3.0;
/// A force at the posterior's middle is not told where it is so many times as large as the mean over the posterior.
const TYPICAL: f64 = 2.0;
/// A closed form gives a contact's point if that is not farther from the posterior's than its region's radius, or this (m).
const AGREES: f64 = 0.01;

/// The posterior of one contact, and what it says of a torque.
#[derive(Debug, Clone)]
pub(crate) struct SurfaceContact {
    robot: Arc<Robot>,
    /// That are looked on.
    links: Vec<LinkIndex>,
    posterior: SurfacePosterior,
    summary: Summary,
    noise: TorqueNoise,
    friction: f64,
    locate_within: f64,
    /// Standard deviations with the errors that grow with a contact's torque (Nm, N).
    in_contact: Vec<f64>,
    left: Vec<f64>,
    /// Where the contact can be by the last posterior that was worked out: points, forces and normals in the links' frames.
    place: Option<Mode>,
    modes: Vec<Mode>,
    /// For the force, on one link alone.
    now: Measurement,
}

impl SurfaceContact {
    /// Of torques with the noise of `noise`, and wrenches of sensors as `evidence` has them; none where no link is left to look on
    /// that is not behind a wanted sensor.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the option.
    pub fn new(
        robot: Arc<Robot>,
        options: &MapOptions,
        (tree, evidence): (&SensorTree, &ContactEvidence),
        noise: TorqueNoise,
        locate_within: f64,
    ) -> Result<Option<Self>> {
        if !robot.has_contact_links() {
            return Ok(None);
        }
        let mut links = options.check(&robot)?;
        links.retain(|link| !evidence.is_wanted(tree, *link));
        if links.is_empty() {
            return Ok(None);
        }
        let sensors = evidence.mounts(&robot, tree);
        let posterior = SurfacePosterior::new(robot.clone(), options, &links, &sensors)?;
        let now = Measurement::new(&robot, links.clone(), &sensors);
        let rows = now.rows();
        Ok(Some(SurfaceContact {
            summary: Summary::new(rows, links.len(), options.friction, &posterior),
            links: links.into_iter().map(LinkIndex::new).collect(),
            posterior,
            noise: evidence.noise(noise),
            locate_within,
            in_contact: vec![1.0; rows],
            left: vec![0.0; rows],
            place: None,
            modes: Vec::with_capacity(MOST_MODES),
            now,
            friction: options.friction,
            robot,
        }))
    }

    /// How many rows a measurement has.
    pub fn rows(&self) -> usize {
        self.now.rows()
    }

    /// Another contact: forgets the torques, but not the place until there is another one.
    pub fn begin(&mut self) {
        self.posterior.forget();
    }

    /// No contact.
    pub fn forget(&mut self) {
        self.posterior.forget();
        self.place = None;
    }

    /// Takes in a torque of the contact; one that is not kept counts until the next.
    pub fn measure(&mut self, now: &TorqueNow<'_>, keep: bool) {
        let Self { posterior, noise, in_contact, .. } = self;
        noise.set_deviations_beside(now.deviation, now.torque, in_contact);
        posterior.measure(now.kinematics, now.torque, in_contact, keep);
    }

    /// Whether there is no work left.
    pub fn is_done(&self) -> bool {
        self.posterior.is_done()
    }

    /// A part of the work; true where that completes the posterior.
    pub fn step(&mut self) -> bool {
        if self.posterior.is_done() || !self.posterior.step() {
            return false;
        }
        let found = self.summary.read(&self.posterior);
        let frames = self.posterior.newest().frames();
        let local = |mode: &Mode| mode.in_link_frame(&frames.links[mode.link.get()].pose);
        self.place = found.estimate.contact.as_ref().map(local);
        self.modes.clear();
        self.modes.extend(found.estimate.modes.iter().map(local));
        true
    }

    /// Whether the last posterior is of another place than the one before.
    pub fn is_elsewhere(&self) -> bool {
        self.posterior.is_elsewhere()
    }

    /// The force at a place on a link, in its frame (N); none where the torques do not determine it.
    fn force(&mut self, now: &TorqueNow<'_>, place: &Mode) -> Option<Vector3<f64>> {
        let link = place.link.get();
        self.now.set_on(link, &self.robot, now.kinematics, now.torque, now.deviation);
        let (frame, target) = (&self.now.frames().links[link], self.now.target().on(link));
        let outward = place.pushed_normal();
        let model = ForceModel::FrictionCone(self.friction);
        let best = BestForce::beside_friction(frame, target, model, &place.point, &outward)?;
        if best.normal <= DETERMINED * best.variance.sqrt() {
            return None;
        }
        let directions = directions(&outward);
        let (gram, products) = frame.responses(&place.point, &directions, target);
        let parts = best_cone_force(&gram, &products, self.friction).force;
        // Torques that hardly tell apart two forces can be explained by large ones that cancel.
        let likely = LIKELY * model.deviation_across(best.normal).unwrap_or_default();
        if parts.y.hypot(parts.z) > likely {
            return Some(best.force);
        }
        Some(directions[0] * parts.x + directions[1] * parts.y + directions[2] * parts.z)
    }

    /// Squared norm of what a force at a point of a link leaves over of a torque, in standard deviations (in the link's
    /// frame).
    fn misfit(
        &mut self,
        now: &TorqueNow<'_>,
        link: LinkIndex,
        point: &Vector3<f64>,
        force: &Vector3<f64>,
    ) -> f64 {
        let Self { now: own, robot, noise, in_contact, left, .. } = self;
        noise.set_deviations_beside(now.deviation, now.torque, in_contact);
        own.set_on(link.get(), robot, now.kinematics, now.torque, in_contact);
        own.left_over(link.get(), point, force, left)
    }

    /// Judges what closed forms found of a torque: the point of a contact that they do not determine stays open unless the
    /// posterior is sure of it.
    pub fn judge(&mut self, now: &TorqueNow<'_>, isolation: &mut Isolation) {
        let found = match &isolation.contacts[..] {
            [] => return,
            [found] if !found.located => Some(found.clone()),
            _ => None,
        };
        let exact = |contact: &Contact| contact.verified;
        if isolation.contacts.iter().all(exact) && is_exact(isolation.residual, now.torque) {
            return;
        }
        self.forget();
        self.measure(now, true);
        while !self.is_done() {
            self.step();
        }
        if !self.summary.estimate().explained {
            return;
        }
        self.answer(now, false, isolation);
        let Isolation { contacts, .. } = isolation;
        if let (Some(found), [contact]) = (found, &mut contacts[..]) {
            if !contact.located {
                let link = if found.wrench.is_some() { found.link } else { contact.link };
                *contact = Contact { link, posterior: contact.posterior.take(), ..found };
            }
        }
    }

    /// Puts the posterior's answer in place of what closed forms found, where one contact explains the torques. `outdated`: the
    /// torques have grown since the posterior was worked out, and tell more than it knows.
    pub fn answer(&mut self, now: &TorqueNow<'_>, outdated: bool, isolation: &mut Isolation) {
        let Some(place) = self.place else { return };
        let found = self.summary.estimate();
        let (explained, region_radius) = (found.explained, found.region_radius.unwrap_or(f64::INFINITY));
        let several = isolation.contacts.len() > 1;
        // Where the torques do not speak for the posterior's contact, what detection leaves holds.
        let detected = !isolation.contacts.is_empty() && !isolation.link_candidates.contains(&place.link);
        if (several && !explained)
            || (detected && self.summary.is_doubtful())
            || (outdated && !isolation.contacts.is_empty())
        {
            return;
        }
        let point = now.kinematics.link_pose(&self.robot, place.link).transform_point(&place.point);
        let closed_form = isolation.contacts.first().filter(|contact| !several && contact.located).cloned();
        let agrees = |contact: &Contact| {
            let near = |other: ContactPlace| (other.point - point).norm() <= region_radius.max(AGREES);
            contact.link == place.link && contact.place.is_some_and(near)
        };
        let contradicted = closed_form.as_ref().filter(|contact| !agrees(contact));
        if contradicted.is_some_and(|other| self.is_better(other, now, &place, isolation.residual)) {
            return;
        }
        // Two answers that both explain the torques: neither is sure.
        let sure = contradicted.is_none() && explained && region_radius <= self.locate_within;
        let kept = closed_form.filter(agrees).map(|mut contact| {
            // Other places explain the torques nearly as well.
            let exact = is_exact(isolation.residual, now.torque);
            if let Some(place) = contact.place.as_mut().filter(|_| !exact) {
                place.std = place.std.max(self.summary.point_std());
            }
            contact
        });
        let mut contact = kept.unwrap_or_else(|| self.contact(now, &place, explained));
        let exact = contact.verified && is_exact(isolation.residual, now.torque);
        if !sure && !exact && contact.force().is_some_and(|force| depends_on_place(&force, &place)) {
            contact.wrench = None;
        }
        contact.located = sure;
        contact.posterior = Some(self.describe(now, &place, region_radius, isolation));
        isolation.contacts.clear();
        isolation.contacts.push(contact);
    }

    /// Whether a closed form's contact is exact, or explains the torques far better than the posterior's place: one that the samples
    /// have missed.
    fn is_better(&mut self, other: &Contact, now: &TorqueNow<'_>, place: &Mode, residual: f64) -> bool {
        if other.verified && is_exact(residual, now.torque) {
            return true;
        }
        let force = self.force(now, place).unwrap_or_default();
        let own = self.misfit(now, place.link, &place.point, &force);
        let pose = now.kinematics.link_pose(&self.robot, other.link);
        let at = other.place.map_or(Vector3::zeros(), |place| place.point_local);
        let push = pose.inverse_transform_vector(&other.force().unwrap_or_default());
        own > LOST + self.misfit(now, other.link, &at, &push)
    }

    /// The contact at the posterior's place.
    fn contact(&mut self, now: &TorqueNow<'_>, place: &Mode, explained: bool) -> Contact {
        let pose = now.kinematics.link_pose(&self.robot, place.link);
        let point = pose.transform_point(&place.point);
        let force = self.force(now, place).map(|force| pose.rotation * force);
        Contact {
            place: Some(ContactPlace {
                point,
                point_local: place.point,
                normal: pose.rotation * place.normal,
                std: self.summary.point_std(),
            }),
            wrench: force.map(|force| stack(&force, &(point - pose.translation).cross(&force))),
            verified: explained && self.feels(place.link) > LINE_UNKNOWNS,
            ..Contact::unlocated(place.link)
        }
    }

    /// How many rows feel a link.
    fn feels(&self, link: LinkIndex) -> usize {
        self.now.frames().links[link.get()].rows().len()
    }

    /// Lists modes and probabilities of links in the answer.
    fn describe(
        &self,
        now: &TorqueNow<'_>,
        place: &Mode,
        region_radius: f64,
        isolation: &mut Isolation,
    ) -> ContactPosterior {
        let found = &self.summary.estimate().estimate;
        isolation.modes.clear();
        let modes = self.modes.iter();
        isolation
            .modes
            .extend(modes.map(|mode| mode.in_world_frame(&now.kinematics.link_pose(&self.robot, mode.link))));
        isolation.link_probabilities.clear();
        let links = self.links.iter().zip(&found.link_probabilities);
        isolation
            .link_probabilities
            .extend(links.map(|(&link, &probability)| LinkProbability { link, probability }));
        let own = isolation.link_probabilities.iter().find(|other| other.link == place.link);
        ContactPosterior {
            probability: own.map_or(0.0, |own| own.probability),
            covariance: found.covariance.unwrap_or_default(),
            region_radius,
            modes: 0..isolation.modes.len(),
            link_probabilities: 0..isolation.link_probabilities.len(),
        }
    }
}

/// Whether a force at the posterior's middle says little of those at other places that are as likely: there it has a shorter
/// lever than elsewhere, and is larger.
fn depends_on_place(force: &Vector3<f64>, place: &Mode) -> bool {
    force.norm() > (TYPICAL * place.force.norm()).min(GREATEST_FORCE)
}

/// Whether what contacts leave over of a torque is rounding.
pub(super) fn is_exact(residual: f64, torque: &[f64]) -> bool {
    residual < EXACT * torque.iter().map(|torque| torque * torque).sum::<f64>().sqrt()
}
