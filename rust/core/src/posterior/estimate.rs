//! What a posterior over contacts says of one.

use nalgebra::Matrix3;

use super::clusters::Clusters;
use super::mode::Mode;
use crate::torque::Frames;

/// A contact as a posterior sees it.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::particle::{ContactParticleFilter, FilterOptions};
/// use contactsense::robot::Robot;
///
/// let options = FilterOptions { particles: 500, ..FilterOptions::default() };
/// let mut filter = ContactParticleFilter::new(Arc::new(Robot::example_arm()), options)?;
/// let estimate = &filter.update(&[0.4; 7], &[1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])?.estimate;
/// // One pose is not enough to know the place.
/// assert!(estimate.contact.is_some() && estimate.ambiguous);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContactEstimate {
    /// The most probable place on the most probable link; none where the torques show no contact.
    pub contact: Option<Mode>,
    /// Second moment of all samples' points about that place, other modes included, world frame (m^2).
    pub covariance: Option<Matrix3<f64>>,
    /// One a link that is looked on, in their order.
    pub link_probabilities: Vec<f64>,
    /// Best first.
    pub modes: Vec<Mode>,
    /// The data do not say which link or where on it.
    pub ambiguous: bool,
}

impl ContactEstimate {
    /// No contact; space for so many links and modes.
    pub(crate) fn new(links: usize, modes: usize) -> Self {
        ContactEstimate {
            contact: None,
            covariance: None,
            link_probabilities: vec![0.0; links],
            modes: Vec::with_capacity(modes),
            ambiguous: false,
        }
    }

    /// No contact.
    pub(crate) fn clear(&mut self) {
        (self.contact, self.covariance, self.ambiguous) = (None, None, false);
        self.link_probabilities.fill(0.0);
        self.modes.clear();
    }

    /// Takes on another one, of as many links.
    pub(crate) fn copy(&mut self, other: &ContactEstimate) {
        (self.contact, self.covariance, self.ambiguous) = (other.contact, other.covariance, other.ambiguous);
        self.link_probabilities.clone_from(&other.link_probabilities);
        self.modes.clone_from(&other.modes);
    }

    /// Takes on what the modes say; `error` is the moment left over, as far as it is not averaged out (Nm).
    pub(crate) fn set(&mut self, clusters: &Clusters, frames: &Frames, error: f64) {
        self.clear();
        for (probability, &link) in self.link_probabilities.iter_mut().zip(&frames.wanted) {
            *probability = clusters.on_link(link);
        }
        self.modes.extend_from_slice(&clusters.found);
        let probable = |a: &usize, b: &usize| clusters.on_link(*a).total_cmp(&clusters.on_link(*b));
        let Some(link) = frames.wanted.iter().copied().max_by(probable) else { return };
        let on_link = self.modes.iter().find(|mode| mode.link.get() == link);
        let Some(mode) = on_link.or(self.modes.first()).copied() else { return };
        // Samples that agree know no better than they explain: an error of torque is one of the lever.
        let lever = (error / mode.force.norm()).min(FARTHEST);
        let floor = RESOLUTION.powi(2) + lever * lever / 3.0;
        let covariance = clusters.covariance(frames, &mode.point) + Matrix3::identity() * floor;
        self.ambiguous = clusters.on_link(mode.link.get()) < SURE_LINK
            || mode.probability < SURE_MODE
            || covariance.trace().sqrt() > WIDE;
        (self.contact, self.covariance) = (Some(mode), Some(covariance));
    }

    /// Where nothing is assumed of a contact's stiffness.
    pub(crate) fn forget_stiffness(&mut self) {
        self.modes.iter_mut().chain(&mut self.contact).for_each(|mode| mode.stiffness = None);
    }
}

/// Standard deviation of a point that samples cannot undercut [m].
const RESOLUTION: f64 = 5e-3;
/// A lever that is not known better than this is not known [m].
const FARTHEST: f64 = 1.0;
/// Less probable links and modes are not sure.
const SURE_LINK: f64 = 0.8;
const SURE_MODE: f64 = 0.7;
/// A point that is known no better than this is not known [m].
const WIDE: f64 = 0.05;
