//! What a filter says after an update.

use nalgebra::{Matrix3, Vector3};

use super::modes::Modes;
use crate::torque::Frames;

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

/// A place where the contact may be.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::particle::{ContactParticleFilter, FilterOptions};
/// use contactsense::robot::Robot;
///
/// let options = FilterOptions { particles: 500, ..FilterOptions::default() };
/// let mut filter = ContactParticleFilter::new(Arc::new(Robot::example_arm()), options)?;
/// let modes = &filter.update(&[0.4; 7], &[1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])?.modes;
/// // The most probable first.
/// assert!(modes.windows(2).all(|pair| pair[0].probability >= pair[1].probability));
/// assert!(modes.iter().all(|mode| mode.force.dot(&mode.normal) < 0.0), "contacts push");
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Index into the robot's links.
    pub link: usize,
    /// On the link's surface, world frame (m).
    pub point: Vector3<f64>,
    /// On the robot, world frame (N).
    pub force: Vector3<f64>,
    /// Outward, world frame.
    pub normal: Vector3<f64>,
    /// Stiffness of the contact [N/m].
    pub stiffness: f64,
    /// Share of the particles' weight.
    pub probability: f64,
    /// Root of the mean squared distance of the mode's particles from their mean (m).
    pub spread: f64,
}

/// The contact as the particles see it.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::particle::{ContactParticleFilter, FilterOptions};
/// use contactsense::robot::Robot;
///
/// let options = FilterOptions { particles: 500, ..FilterOptions::default() };
/// let mut filter = ContactParticleFilter::new(Arc::new(Robot::example_arm()), options)?;
/// let estimate = filter.update(&[0.4; 7], &[1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])?;
/// // One pose is not enough to know the place.
/// assert!(estimate.contact && estimate.ambiguous && estimate.link.is_some());
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ContactEstimate {
    /// Whether the torques show one. Where not, all numbers but the counts are NaN or empty.
    pub contact: bool,
    /// What happened.
    pub event: Event,
    /// The most probable link, an index into the robot's links.
    pub link: Option<usize>,
    /// The most probable place on that link, world frame (m).
    pub point: Vector3<f64>,
    /// On the robot, world frame (N).
    pub force: Vector3<f64>,
    /// Outward, world frame.
    pub normal: Vector3<f64>,
    /// Stiffness of the contact [N/m]; none where the motion model has none.
    pub stiffness: Option<f64>,
    /// Second moment of all particles' points about `point`, other modes included, world frame [m^2].
    pub covariance: Matrix3<f64>,
    /// One a link that is looked on, in their order.
    pub link_probabilities: Vec<f64>,
    /// Best first.
    pub modes: Vec<Mode>,
    /// The data do not say which link or where on it, or motion has not confirmed yet that it is a push.
    pub ambiguous: bool,
    /// Whether a push by one obstacle that stays explains the torques at the last poses: what is left over is within four
    /// times the stated noise (a chi-square test at 99 %), and nothing shows that the force follows the motion less than on
    /// the softest obstacle sought. Where not, the contact is ambiguous, too.
    pub explained: bool,
    /// Root mean square, over all joints, of the torque that the best push leaves over, in standard deviations of the
    /// stated noise: about one or less where all is explained.
    pub residual: f64,
    /// Effective number of particles before resampling.
    pub effective_samples: f64,
    /// Updates since the start or the last reset.
    pub updates: u64,
}

impl ContactEstimate {
    /// No contact; space for so many links and modes.
    pub(super) fn new(links: usize, modes: usize) -> Self {
        let mut estimate = ContactEstimate {
            contact: false,
            event: Event::None,
            link: None,
            point: Vector3::zeros(),
            force: Vector3::zeros(),
            normal: Vector3::zeros(),
            stiffness: None,
            covariance: Matrix3::zeros(),
            link_probabilities: vec![0.0; links],
            modes: Vec::with_capacity(modes),
            ambiguous: false,
            explained: true,
            residual: 0.0,
            effective_samples: 0.0,
            updates: 0,
        };
        estimate.clear();
        estimate
    }

    /// No contact.
    pub(super) fn clear(&mut self) {
        let nothing = Vector3::repeat(f64::NAN);
        self.contact = false;
        self.link = None;
        (self.point, self.force, self.normal) = (nothing, nothing, nothing);
        self.stiffness = None;
        self.covariance = Matrix3::repeat(f64::NAN);
        self.link_probabilities.fill(0.0);
        self.modes.clear();
        self.ambiguous = false;
        self.explained = true;
        self.residual = 0.0;
        self.effective_samples = 0.0;
    }

    /// Takes on what the modes say; `error` is the moment left over, as far as it is not averaged out [Nm].
    pub(super) fn set_contact(&mut self, modes: &Modes, frames: &Frames, springy: bool, error: f64) {
        self.contact = true;
        for (probability, &link) in self.link_probabilities.iter_mut().zip(&frames.wanted) {
            *probability = modes.on_link(link);
        }
        self.modes.extend_from_slice(&modes.found);
        let probable = |a: &usize, b: &usize| modes.on_link(*a).total_cmp(&modes.on_link(*b));
        let Some(link) = frames.wanted.iter().copied().max_by(probable) else { return };
        let on_link = self.modes.iter().find(|mode| mode.link == link);
        let Some(mode) = on_link.or(self.modes.first()).copied() else { return };
        self.link = Some(mode.link);
        (self.point, self.force, self.normal) = (mode.point, mode.force, mode.normal);
        self.stiffness = springy.then_some(mode.stiffness);
        // Particles that agree know no better than they explain: an error of torque is one of the lever.
        let lever = (error / mode.force.norm()).min(FARTHEST);
        let floor = RESOLUTION.powi(2) + lever * lever / 3.0;
        self.covariance = modes.covariance(frames, &mode.point) + Matrix3::identity() * floor;
        self.ambiguous = modes.on_link(mode.link) < SURE_LINK
            || mode.probability < SURE_MODE
            || self.covariance.trace().sqrt() > WIDE;
    }
}

/// Standard deviation of a point that particles cannot undercut [m].
const RESOLUTION: f64 = 5e-3;
/// A lever that is not known better than this is not known [m].
const FARTHEST: f64 = 1.0;
/// Less probable links and modes are not sure.
const SURE_LINK: f64 = 0.8;
const SURE_MODE: f64 = 0.7;
/// A point that is known no better than this is not known [m].
const WIDE: f64 = 0.05;
