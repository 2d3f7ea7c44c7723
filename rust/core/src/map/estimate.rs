//! What a map says of a contact.

use crate::posterior::ContactEstimate;

/// The posterior of one contact.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::map::{ContactMap, MapOptions};
/// use contactsense::robot::Robot;
///
/// let mut map = ContactMap::new(Arc::new(Robot::example_arm()), &MapOptions::default())?;
/// let found = map.evaluate(&[0.4; 7], &[1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])?;
/// assert!(found.log_evidence > 0.0, "a contact is likelier than none");
/// assert!(found.region_radius.is_some_and(|radius| radius > 0.0));
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MapEstimate {
    /// The contact, its modes, and the links' probabilities.
    pub estimate: ContactEstimate,
    /// Radius of the ball about the contact's point that holds 90 % of the posterior (m); none without contact.
    pub region_radius: Option<f64>,
    /// Logarithm of how many times as likely the torque is with a contact as without.
    pub log_evidence: f64,
    /// Whether the noise explains what the best contact leaves over (a chi-square test at 99 %).
    pub explained: bool,
    /// Root mean square, over all joints, of the torque that the best contact leaves over, in standard deviations.
    pub residual: f64,
    /// Effective number of the pieces of surface that the posterior is spread over.
    pub effective_samples: f64,
}
