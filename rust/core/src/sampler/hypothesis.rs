//! One hypothesis of the contacts.

use nalgebra::Vector3;

use super::sums::{Marginal, Sums};
use crate::posterior::tempering::Logs;
use crate::posterior::{ContactSample, ContactSamples};
use crate::surface::SurfacePoint;

/// What a contact is with.
///
/// ```
/// use contactsense::sampler::{ContactModel, SamplerOptions};
///
/// let options = SamplerOptions { models: ContactModel::ALL.to_vec(), ..SamplerOptions::default() };
/// assert_eq!(options.models[0].name(), "obstacle");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactModel {
    /// A round obstacle that stays where it is: the point moves over the link, the force follows the depth.
    Obstacle,
    /// A person who follows the robot: the point stays on the link, the force changes as it likes.
    Person,
    /// What holds the link: the point stays on the link, and a spring ties it to where it was in the world.
    Both,
}

impl ContactModel {
    /// All there are.
    pub const ALL: [ContactModel; 3] = [ContactModel::Obstacle, ContactModel::Person, ContactModel::Both];

    /// In lower case.
    pub fn name(self) -> &'static str {
        match self {
            ContactModel::Obstacle => "obstacle",
            ContactModel::Person => "person",
            ContactModel::Both => "both",
        }
    }
}

/// What a hypothesis claims.
#[derive(Debug, Clone, Copy)]
pub(super) struct Claim {
    pub model: ContactModel,
    /// Index into the robot's links.
    pub link: u32,
    /// Where it touched first, link frame.
    pub place: SurfacePoint,
    /// Of the obstacle's radius there (m); no matter to other models.
    pub log_radius: f64,
}

/// The force of a contact at one pose, on the link in its frame: one that is known, one as many times as the force at the first touch
/// in N is, and one as many times as the stiffness in N/m is.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Forces {
    pub known: Vector3<f64>,
    pub first: Vector3<f64>,
    pub spring: Vector3<f64>,
}

/// A contact at one pose: point and outward normal, link frame, and the triangle that holds the point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch {
    pub point: Vector3<f64>,
    pub normal: Vector3<f64>,
    pub triangle: Option<u32>,
    pub forces: Forces,
}

impl Touch {
    /// Where a claim has it, without a force.
    pub fn of(claim: &Claim) -> Self {
        let SurfacePoint { point, normal, triangle } = claim.place;
        Touch { point, normal, triangle, forces: Forces::default() }
    }
}

/// One contact of a hypothesis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Contact {
    pub claim: Claim,
    /// World frame (m): the obstacle's centre, or where the point was first.
    pub anchor: Vector3<f64>,
    /// At the newest pose.
    pub touch: Touch,
}

/// Has contacts touch elsewhere.
pub(super) fn put<const N: usize>(contacts: &mut [Contact; N], touches: [Touch; N]) {
    contacts.iter_mut().zip(touches).for_each(|(contact, touch)| contact.touch = touch);
}

/// Claims of some contacts, and what the measurements say of them together.
#[derive(Debug, Clone)]
pub(super) struct Hypothesis<const N: usize> {
    pub contacts: [Contact; N],
    /// Of the measurements that count now.
    pub now: Sums<N>,
    pub logs: Logs,
    /// The densities with friction of the greatest forces, where it is in proportion to forces.
    pub rough: Option<Logs>,
    pub marginal: Marginal<N>,
}

impl<const N: usize> Hypothesis<N> {
    /// The force of a contact on its link at the newest pose, link frame (N).
    pub fn force(&self, contact: usize) -> Vector3<f64> {
        let Contact { claim, touch, .. } = &self.contacts[contact];
        let Forces { known, first, spring } = touch.forces;
        let force = known + first * self.marginal.force[contact] + spring * self.marginal.stiffness[contact];
        // An obstacle that is left does not pull.
        if claim.model == ContactModel::Obstacle && force.dot(&touch.normal) > 0.0 {
            Vector3::zeros()
        } else {
            force
        }
    }

    /// The contacts in another order.
    pub fn reorder(&mut self, order: &[usize; N]) {
        self.contacts = order.map(|k| self.contacts[k]);
        self.marginal.force = order.map(|k| self.marginal.force[k]);
        self.marginal.stiffness = order.map(|k| self.marginal.stiffness[k]);
        self.now.reorder(order);
    }
}

/// One of the contacts of all hypotheses.
#[derive(Debug, Clone, Copy)]
pub(super) struct One<'a, const N: usize> {
    pub all: &'a [Hypothesis<N>],
    pub contact: usize,
}

impl<const N: usize> ContactSamples for One<'_, N> {
    #[inline]
    fn sample(&self, k: usize) -> ContactSample {
        let hypothesis = &self.all[k];
        let Contact { claim, touch, .. } = &hypothesis.contacts[self.contact];
        ContactSample {
            link: claim.link as usize,
            point: touch.point,
            normal: touch.normal,
            force: hypothesis.force(self.contact),
            stiffness: match claim.model {
                ContactModel::Person => 0.0,
                _ => hypothesis.marginal.stiffness[self.contact],
            },
        }
    }
}
