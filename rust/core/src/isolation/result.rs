//! What isolation answers.

use std::ops::Range;

use nalgebra::{Vector3, Vector6};

use super::determined_wrench::{DeterminedWrench, WrenchPosterior};
use super::posterior::{ContactPosterior, LinkProbability, PathPoint, Track, MOST_POINTS};
use super::torque_now::TorqueNow;
use crate::posterior::{Mode, MOST_MODES};
use crate::robot::LinkIndex;
use crate::sensor::{SensorIndex, SensorTree};
use crate::spatial::vector::split;

/// All hits of one instant that are kept.
pub(super) const CANDIDATES: usize = 512;

/// A place where the line of action meets a surface.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::isolation::{ContactIsolator, IsolatorOptions};
/// use contactsense::robot::Robot;
///
/// let robot = Arc::new(Robot::example_arm());
/// let mut isolator = ContactIsolator::new(robot.clone(), &IsolatorOptions::default())?;
/// // A push on the side of the last link.
/// let (q, link) = ([0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.0], robot.link("link_7")?);
/// let pose = robot.link_pose(&q, link)?;
/// let jacobian = robot.jacobian(&q, link, Some(pose.transform_point(&[0.05, 0.0, 0.1].into()).into()))?;
/// let tau_ext = jacobian.rows(0, 3).transpose() * (pose.rotation * nalgebra::Vector3::new(-20.0, 0.0, 0.0));
/// let isolation = isolator.isolate(&q, tau_ext.as_slice())?;
/// // Its line goes in at one side and comes out at the other.
/// let candidates = &isolation.candidates[isolation.contacts[0].candidates.clone()];
/// assert!(candidates[0].pushing && candidates[0].link == link);
/// assert!(candidates[1..].iter().any(|other| !other.pushing && other.distance > candidates[0].distance));
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Candidate {
    /// The link.
    pub link: LinkIndex,
    /// World frame (m).
    pub point: Vector3<f64>,
    /// Outward normal, world frame.
    pub normal: Vector3<f64>,
    /// Whether the force enters the surface here.
    pub pushing: bool,
    /// Along the force, from the point of the line nearest to the base (m).
    pub distance: f64,
}

/// The place of a contact on its link.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::isolation::{ContactIsolator, IsolatorOptions};
/// use contactsense::robot::Robot;
///
/// let robot = Arc::new(Robot::example_arm());
/// let mut isolator = ContactIsolator::new(robot.clone(), &IsolatorOptions::default())?;
/// // A push on the side of the last link.
/// let (q, link) = ([0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.0], robot.link("link_7")?);
/// let pose = robot.link_pose(&q, link)?;
/// let point = pose.transform_point(&[0.05, 0.0, 0.1].into());
/// let jacobian = robot.jacobian(&q, link, Some(point.into()))?;
/// let tau_ext = jacobian.rows(0, 3).transpose() * (pose.rotation * nalgebra::Vector3::new(-20.0, 0.0, 0.0));
/// let isolation = isolator.isolate(&q, tau_ext.as_slice())?;
/// let place = isolation.contacts[0].place.expect("seven joints determine it");
/// assert!((place.point - point).norm() < 1e-6 && (place.point_local.z - 0.1).abs() < 1e-6);
/// assert!((place.normal - pose.rotation.column(0)).norm() < 1e-6);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContactPlace {
    /// Point of contact, world frame (m).
    pub point: Vector3<f64>,
    /// The same in the link frame (m).
    pub point_local: Vector3<f64>,
    /// Outward surface normal at the point, world frame.
    pub normal: Vector3<f64>,
    /// Standard deviation of the point (m). The standard deviation of a torque is taken as a third of its threshold, and
    /// as more where the torques contradict one force. Other places that explain the torques as well are included: by the posterior
    /// over all surface it is at least a third of the radius that holds 99 %.
    pub std: f64,
}

/// One contact: what the data determine of it.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::isolation::{ContactIsolator, IsolatorOptions};
/// use contactsense::robot::Robot;
///
/// let robot = Arc::new(Robot::example_arm());
/// let mut isolator = ContactIsolator::new(robot.clone(), &IsolatorOptions::default())?;
/// // Torques of the first three joints say on which link a contact is, and not where.
/// let isolation = isolator.isolate(&[0.4; 7], &[1.0, 2.0, 0.5, 0.0, 0.0, 0.0, 0.0])?;
/// let contact = &isolation.contacts[0];
/// assert_eq!(contact.link, robot.link("link_3")?);
/// assert!(!contact.located && contact.place.is_none() && contact.wrench.is_none());
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Contact {
    /// The link.
    pub link: LinkIndex,
    /// Where on the link; none if only the link is known.
    pub place: Option<ContactPlace>,
    /// Wrench (force, moment) on the robot at the link's origin, world axes (N, Nm); none if only the link is known. It may
    /// be known where the place is not.
    pub wrench: Option<Vector6<f64>>,
    /// What is known of the wrench where one contact is reported that is not located.
    pub determined: Option<DeterminedWrench>,
    /// The sensor that saw it; none: the joint torques.
    pub source: Option<SensorIndex>,
    /// Whether 90 % of the places that explain the torques lie within [`super::IsolatorOptions::locate_within`] of the
    /// point. If not, the link may be known, the point is not.
    pub located: bool,
    /// Whether redundant torques agree with the contacts reported. Where nothing is redundant (as many torques as
    /// unknowns), nothing checks the assumption that each contact is one force without moment.
    pub verified: bool,
    /// This contact's part of [`Isolation::candidates`], best first.
    pub candidates: Range<usize>,
    /// What the posterior over all surface says of it; none where only closed forms were tried.
    pub posterior: Option<ContactPosterior>,
    /// Which contact it is over time; none where contacts are not followed.
    pub track: Option<Track>,
}

impl Contact {
    pub(crate) fn unlocated(link: LinkIndex) -> Self {
        Self {
            link,
            place: None,
            wrench: None,
            determined: None,
            source: None,
            located: false,
            verified: false,
            candidates: 0..0,
            posterior: None,
            track: None,
        }
    }

    /// Force on the robot, world frame (N); none where the wrench is not known.
    pub fn force(&self) -> Option<Vector3<f64>> {
        self.wrench.map(|wrench| split(&wrench).0)
    }
}

/// All contacts of one instant.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::isolation::{ContactIsolator, IsolatorOptions};
/// use contactsense::robot::Robot;
///
/// let robot = Arc::new(Robot::example_arm());
/// let mut isolator = ContactIsolator::new(robot.clone(), &IsolatorOptions::default())?;
/// let isolation = isolator.isolate(&[0.4; 7], &[1.0, 2.0, 0.5, 0.0, 0.0, 0.0, 0.0])?;
/// assert_eq!((isolation.contacts.len(), isolation.rank_deficit), (1, 3));
/// assert!(isolation.link_candidates.contains(&robot.link("link_3")?) && !isolation.truncated);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Isolation {
    /// One contact a branch that feels one, farthest from the base first.
    pub contacts: Vec<Contact>,
    /// Surface hits of all contacts.
    pub candidates: Vec<Candidate>,
    /// Modes of the contacts' posteriors.
    pub modes: Vec<Mode>,
    /// Probabilities of links, of all contacts' posteriors.
    pub link_probabilities: Vec<LinkProbability>,
    /// Paths of all contacts that are followed.
    pub paths: Vec<PathPoint>,
    /// How many components of the wrenches the torques leave open (Vorndamme 2017, eq. 31).
    pub rank_deficit: usize,
    /// Norm of the external torque that the contacts do not explain.
    pub residual: f64,
    /// Links that may carry a contact, likeliest first.
    pub link_candidates: Vec<LinkIndex>,
    /// Whether there were more contacts than `max_contacts`, more hits of a line than are kept (the nearest are), or more
    /// explanations to try than the bounded work of a call allows.
    pub truncated: bool,
}

impl Isolation {
    /// An empty one with room for so many contacts on a robot of so many links.
    pub(crate) fn with_room(contacts: usize, links: usize) -> Self {
        Self {
            contacts: Vec::with_capacity(contacts),
            candidates: Vec::with_capacity(CANDIDATES),
            link_candidates: Vec::with_capacity(links + contacts),
            modes: Vec::with_capacity(MOST_MODES),
            link_probabilities: Vec::with_capacity(links),
            paths: Vec::with_capacity(contacts * MOST_POINTS),
            ..Self::default()
        }
    }

    /// Names the sensors that have seen contacts which the posterior found.
    pub(crate) fn name_sources(&mut self, tree: &SensorTree) {
        for contact in self.contacts.iter_mut().filter(|contact| contact.posterior.is_some()) {
            contact.source = tree.of_link(contact.link.get()).map(SensorIndex::new);
        }
    }

    /// What is known of the wrench of a single contact that is not located.
    pub(super) fn determine_wrench(&mut self, now: &TorqueNow<'_>, posterior: &mut WrenchPosterior) {
        if let [contact] = &mut self.contacts[..] {
            contact.determined = (!contact.located).then(|| posterior.on(contact.link, now)).flatten();
        }
    }

    pub(crate) fn clear(&mut self) {
        self.contacts.clear();
        self.candidates.clear();
        self.link_candidates.clear();
        self.modes.clear();
        self.link_probabilities.clear();
        self.paths.clear();
        self.rank_deficit = 0;
        self.residual = 0.0;
        self.truncated = false;
    }
}
