//! What a posterior over all surface says of a contact, and which contact it is over time.

use std::ops::Range;

use nalgebra::{Matrix3, Vector3};

use crate::robot::LinkIndex;

/// Points of a contact's path that are kept at most.
pub(crate) const MOST_POINTS: usize = 32;

/// What the posterior over all of the robot's surface says of a contact.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::monitor::{ContactMonitor, MonitorOptions};
/// use contactsense::robot::Robot;
/// use contactsense::Sample;
///
/// let robot = Arc::new(Robot::example_arm());
/// let (q, v) = (vec![0.4; 7], vec![0.0; 7]);
/// let pushed: Vec<f64> = robot.inverse_dynamics(&q, &v, &v)?.iter().map(|tau| tau - 3.0).collect();
/// let mut monitor = ContactMonitor::new(robot, &MonitorOptions::new(1e-3))?;
/// for _ in 0..300 {
///     monitor.update(&Sample::new(&q, &v, &pushed))?;
/// }
/// let isolation = &monitor.report().isolation;
/// let contact = &isolation.contacts[0];
/// let posterior = contact.posterior.as_ref().expect("one contact without sensors");
/// assert!(posterior.probability <= 1.0 + 1e-9 && posterior.region_radius > 0.0);
/// assert_eq!(contact.track.as_ref().expect("it is followed").id, 0);
/// // All links together.
/// let sum: f64 = isolation.link_probabilities[posterior.link_probabilities.clone()].iter().map(|it| it.probability).sum();
/// assert!((sum - 1.0).abs() < 1e-9);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContactPosterior {
    /// That the contact is on its link.
    pub probability: f64,
    /// Second moment of the posterior about the point, world frame (m^2).
    pub covariance: Matrix3<f64>,
    /// Radius of the ball about the point that holds 90 % of the posterior (m).
    pub region_radius: f64,
    /// This contact's part of [`Isolation::modes`](super::Isolation::modes), most probable first.
    pub modes: Range<usize>,
    /// This contact's part of [`Isolation::link_probabilities`](super::Isolation::link_probabilities).
    pub link_probabilities: Range<usize>,
}

/// The probability that a contact is on a link.
///
/// ```
/// use contactsense::isolation::LinkProbability;
/// use contactsense::robot::Robot;
///
/// let robot = Robot::example_arm();
/// let likely = LinkProbability { link: robot.link("link_3")?, probability: 0.8 };
/// assert_eq!(robot[likely.link].name, "link_3");
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LinkProbability {
    /// The link.
    pub link: LinkIndex,
    /// From zero to one.
    pub probability: f64,
}

/// A contact over time, from its onset on.
///
/// ```
/// use contactsense::isolation::Track;
///
/// let track = Track { id: 3, since: 1.25, peak_force: 18.0, path: 0..2 };
/// assert!(track.peak_force > 10.0 && track.path.len() == 2);
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Track {
    /// The same for one contact in all ticks; the first is 0.
    pub id: u64,
    /// Time of its first tick (s).
    pub since: f64,
    /// Greatest force so far (N).
    pub peak_force: f64,
    /// This contact's part of [`Isolation::paths`](super::Isolation::paths), oldest first.
    pub path: Range<usize>,
}

/// A place of a contact that moves over the robot's surface.
///
/// ```
/// use contactsense::isolation::PathPoint;
/// use contactsense::robot::Robot;
///
/// let robot = Robot::example_arm();
/// let point = PathPoint { time: 1.5, link: robot.link("link_7")?, point_local: [0.05, 0.0, 0.1].into() };
/// assert_eq!(robot[point.link].name, "link_7");
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PathPoint {
    /// From when on the contact has been here (s).
    pub time: f64,
    /// The link.
    pub link: LinkIndex,
    /// In the link's frame (m).
    pub point_local: Vector3<f64>,
}
