//! One hypothesis of a contact.

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

/// A contact at one pose.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch {
    /// Point and outward normal, link frame, and the triangle that holds the point.
    pub point: Vector3<f64>,
    pub normal: Vector3<f64>,
    pub triangle: Option<u32>,
    pub forces: Forces,
    pub sums: Sums,
}

/// A claim, and what the measurements say of it.
#[derive(Debug, Clone)]
pub(super) struct Hypothesis {
    pub claim: Claim,
    /// World frame (m): the obstacle's centre, or where the point was first.
    pub anchor: Vector3<f64>,
    /// Of the measurements that count now.
    pub now: Sums,
    /// At the newest pose.
    pub touch: Touch,
    pub logs: Logs,
    pub marginal: Marginal,
}

impl Hypothesis {
    /// The force on the link at the newest pose, link frame (N).
    pub fn force(&self) -> Vector3<f64> {
        let Forces { known, first, spring } = self.touch.forces;
        let force = known + first * self.marginal.force + spring * self.marginal.stiffness;
        // An obstacle that is left does not pull.
        if self.claim.model == ContactModel::Obstacle && force.dot(&self.touch.normal) > 0.0 {
            Vector3::zeros()
        } else {
            force
        }
    }
}

impl ContactSamples for Vec<Hypothesis> {
    #[inline]
    fn sample(&self, k: usize) -> ContactSample {
        let hypothesis = &self[k];
        ContactSample {
            link: hypothesis.claim.link as usize,
            point: hypothesis.touch.point,
            normal: hypothesis.touch.normal,
            force: hypothesis.force(),
            stiffness: match hypothesis.claim.model {
                ContactModel::Person => 0.0,
                _ => hypothesis.marginal.stiffness,
            },
        }
    }
}
