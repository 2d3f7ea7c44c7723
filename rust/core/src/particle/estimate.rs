//! What a filter says after an update.

use nalgebra::Vector3;

use crate::posterior::ContactEstimate;

/// What happened at an update.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::particle::{ContactParticleFilter, Event, FilterOptions};
/// use contactsense::robot::Robot;
///
/// let options = FilterOptions { particles: 500, ..FilterOptions::default() };
/// let mut filter = ContactParticleFilter::new(Arc::new(Robot::example_arm()), options)?;
/// assert_eq!(filter.update(&[0.4; 7], &[0.0; 7])?.event, Event::None);
/// assert_eq!(filter.update(&[0.4; 7], &[1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])?.event, Event::Started);
/// assert_eq!(filter.update(&[0.4; 7], &[0.0; 7])?.event, Event::Lost);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Event {
    /// No contact before or now.
    #[default]
    None,
    /// A contact began: the particles were spread over the surface.
    Started,
    /// The contact goes on.
    Continued,
    /// The contact ended.
    Lost,
    /// The contact is elsewhere than it was held to be.
    Changed,
    /// The robot jumped: what was known no longer holds, the particles were spread anew.
    Jumped,
}

impl Event {
    /// In lower case.
    pub fn name(self) -> &'static str {
        match self {
            Event::None => "none",
            Event::Started => "started",
            Event::Continued => "continued",
            Event::Lost => "lost",
            Event::Changed => "changed",
            Event::Jumped => "jumped",
        }
    }
}

/// The contact as a filter sees it, and how the filter fares.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::particle::{ContactParticleFilter, FilterOptions};
/// use contactsense::robot::Robot;
///
/// let options = FilterOptions { particles: 500, ..FilterOptions::default() };
/// let mut filter = ContactParticleFilter::new(Arc::new(Robot::example_arm()), options)?;
/// let found = filter.update(&[0.4; 7], &[1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])?;
/// assert!(found.estimate.contact.is_some() && found.effective_samples > 1.0);
/// assert!(found.log_evidence > 0.0, "a contact is likelier than none");
/// assert_eq!(found.updates, 1);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FilterEstimate {
    /// The contact. It is ambiguous also as long as motion has not confirmed that it is a push.
    pub estimate: ContactEstimate,
    /// Contacts beside it, where several may be: one for each that may be, without a contact where there is none.
    pub others: Vec<ContactEstimate>,
    /// What happened.
    pub event: Event,
    /// Whether a push by one obstacle that stays explains the torques at the last poses: what is left over is within three
    /// times the stated noise (a chi-square test at 99 %), and nothing shows that the force follows the motion less than on
    /// the softest obstacle sought. Where not, the contact is ambiguous, too.
    pub explained: bool,
    /// Root mean square, over all joints, of the torque that the best push leaves over, in standard deviations of the
    /// stated noise: about one or less where all is explained.
    pub residual: f64,
    /// Effective number of particles before resampling; zero without contact.
    pub effective_samples: f64,
    /// Logarithm of how many times as likely the torques of this update are under the particles, given the updates before,
    /// as without a contact; both at the sharpness with which they were weighed. Of the Gaussian likelihood.
    pub log_evidence: f64,
    /// Updates since the start or the last reset.
    pub updates: u64,
    /// The external torque of the last update, `(nv,)` (Nm); empty before it.
    pub torque: Vec<f64>,
}

impl FilterEstimate {
    /// No contact; space for so many contacts, each with so many links and modes.
    pub(crate) fn of_several(links: usize, modes: usize, contacts: usize) -> Self {
        FilterEstimate {
            estimate: ContactEstimate::new(links, modes),
            others: vec![ContactEstimate::new(links, modes); contacts - 1],
            event: Event::None,
            explained: true,
            residual: 0.0,
            effective_samples: 0.0,
            log_evidence: 0.0,
            updates: 0,
            torque: vec![],
        }
    }

    /// Where a contact is that is sure, and three of its standard deviations [m].
    pub(super) fn sure_within(&self) -> Option<(Vector3<f64>, f64)> {
        let ContactEstimate { contact, covariance, ambiguous, .. } = &self.estimate;
        let sure = contact.as_ref().zip(covariance.as_ref()).filter(|_| !ambiguous);
        sure.map(|(contact, covariance)| (contact.point, 3.0 * covariance.trace().sqrt()))
    }

    /// No contact, after what happened.
    pub(crate) fn clear(&mut self, event: Event) {
        self.estimate.clear();
        self.others.iter_mut().for_each(ContactEstimate::clear);
        self.event = event;
        (self.explained, self.residual) = (true, 0.0);
        (self.effective_samples, self.log_evidence) = (0.0, 0.0);
    }
}
