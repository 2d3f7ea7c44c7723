//! The choice of a motion.

use super::belief::{Believed, ContactHypothesis};
use super::candidates::{Candidate, Candidates};
use super::information::{Information, Told};
use super::options::NextMotionOptions;
use super::prediction::Prediction;
use crate::calibration::Motion;
use crate::error::{Error, Result};
use crate::math::random::Stream;
use crate::posterior::ContactEstimate;
use crate::robot::Robot;

/// Why there is no motion.
///
/// ```
/// use contactsense::next_motion::NothingFound;
///
/// assert_eq!(NothingFound::NoContact.name(), "no contact");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum NothingFound {
    /// The estimate shows no contact.
    NoContact,
    /// Every motion that was drawn may lose the contact or exceed the bound of the force.
    NotAdmissible,
}

impl NothingFound {
    /// In lower case.
    pub fn name(self) -> &'static str {
        match self {
            NothingFound::NoContact => "no contact",
            NothingFound::NotAdmissible => "no admissible motion",
        }
    }
}

/// A motion in contact, and what is expected of it.
///
/// ```
/// use contactsense::next_motion::{next_motion, NextMotionOptions, NothingFound};
/// use contactsense::particle::{ContactParticleFilter, FilterOptions};
/// use contactsense::robot::Robot;
///
/// let robot = std::sync::Arc::new(Robot::example_arm());
/// let options = FilterOptions { particles: 500, ..FilterOptions::default() };
/// let filter = ContactParticleFilter::new(robot.clone(), options)?;
/// // Nothing is touched yet.
/// let estimate = &filter.estimate().estimate;
/// let next = next_motion(&robot, estimate, None, &[], &[0.4; 7], &NextMotionOptions::new(60.0, 0.03))?;
/// assert_eq!(next.nothing_found, Some(NothingFound::NoContact));
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NextMotion {
    /// From the present configuration, at rest at both ends; without rows where nothing was found.
    pub motion: Motion,
    /// Expected information about the contact (nats).
    pub information: f64,
    /// Root mean square distance of the contact point from its mean (m), now.
    pub spread_before: f64,
    /// The same after the motion, as expected (m).
    pub spread_after: f64,
    /// Least and greatest predicted force on the way (N).
    pub force_range: [f64; 2],
    /// How many motions were drawn, and how many of them are admissible.
    pub candidates: usize,
    /// Those under which the contact is neither lost nor pressed too hard.
    pub admissible: usize,
    /// Why there is no motion; none where there is one.
    pub nothing_found: Option<NothingFound>,
}

/// Of random small motions in contact, the one after which the contact's point is expected to be known best.
///
/// Hypotheses are the `particles` of a filter where there are any, else points around the modes of the estimate; where the
/// `torque` of the estimate is known (Nm), those count most that explain it. Each is an obstacle that stays in the world. Under all that are noticeable together, the contact is neither lost nor pressed harder than
/// `max_force`, or than it already is. Collisions of the robot with itself and with anything else are not looked at.
///
/// # Errors
/// [`Error::Input`] names the argument.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::next_motion::{next_motion, NextMotionOptions};
/// use contactsense::particle::{ContactParticleFilter, FilterOptions};
/// use contactsense::robot::Robot;
///
/// let robot = Arc::new(Robot::example_arm());
/// let q = [0.4; 7];
/// let options = FilterOptions { particles: 500, ..FilterOptions::default() };
/// let mut filter = ContactParticleFilter::new(robot.clone(), options)?;
/// let found = filter.update(&q, &[1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])?;
/// let options = NextMotionOptions::new(60.0, 0.03);
/// let next = next_motion(&robot, &found.estimate, Some(&found.torque), &[], &q, &options)?;
/// assert!(next.information > 0.0 && next.spread_after < next.spread_before);
/// # Ok::<(), contactsense::Error>(())
/// ```
pub fn next_motion(
    robot: &Robot,
    estimate: &ContactEstimate,
    torque: Option<&[f64]>,
    particles: &[ContactHypothesis],
    q: &[f64],
    options: &NextMotionOptions,
) -> Result<NextMotion> {
    if robot.floating_base() {
        return Err(Error::input(
            "robot",
            "its base must be fixed: a motion of the joints alone moves another one",
        ));
    }
    robot.check_configuration(q)?;
    if let Some(torque) = torque {
        robot.check_tangent("torque", torque)?;
    }
    let (max_step, noise) = options.check(robot)?;
    let random = Stream::new(options.seed);
    let nothing = |why: NothingFound, spread: f64| {
        let none = Motion::none(robot, q);
        NextMotion {
            motion: none,
            information: 0.0,
            spread_before: spread,
            spread_after: spread,
            force_range: [f64::NAN; 2],
            candidates: if why == NothingFound::NoContact { 0 } else { options.count },
            admissible: 0,
            nothing_found: Some(why),
        }
    };
    let links = robot.touchable_links().iter().map(|link| link.get()).collect();
    let here = Prediction::new(robot, links, q);
    let believed = Believed { robot, here: &here, noise: &noise, torque, random: random.fork(0) };
    let obstacles = match (&estimate.contact, particles) {
        (None, _) => vec![],
        (Some(_), []) => believed.of_estimate(estimate),
        (Some(_), particles) => believed.of_hypotheses(particles)?,
    };
    if obstacles.is_empty() {
        return Ok(nothing(NothingFound::NoContact, f64::NAN));
    }
    let information = Information::new(&obstacles, &here, &noise, random.fork(1));
    let mut candidates = Candidates::new(robot, &obstacles, &here, q, options.max_force, &max_step);
    let mut there = here.clone();
    let mut admissible = 0;
    let mut best: Option<(Told, Candidate)> = None;
    for number in 0..options.count {
        let Some(candidate) = candidates.draw(&random.fork(2 + number as u64))? else { continue };
        admissible += 1;
        there.move_to(&candidate.q);
        let told = information.told(&there);
        // Entropy also falls where only force and stiffness become known.
        if best.as_ref().is_none_or(|(other, _)| told.spread < other.spread) {
            best = Some((told, candidate));
        }
    }
    let Some((told, candidate)) = best else {
        return Ok(nothing(NothingFound::NotAdmissible, information.spread()));
    };
    Ok(NextMotion {
        motion: Motion::line(robot, q, &candidate.step, options.duration, options.dt),
        information: told.information,
        spread_before: information.spread(),
        spread_after: told.spread,
        force_range: candidate.force,
        candidates: options.count,
        admissible,
        nothing_found: None,
    })
}
