//! Options of a filter, and checks of them.

use std::ops::RangeInclusive;

use super::schedule::Schedule;
use crate::error::{Error, Result};
use crate::robot::{Robot, LARGEST};
use crate::torque::{ForceModel, NoiseModel, TorqueNoise, LEVEL};

/// How a contact moves with the robot.
///
/// ```
/// use contactsense::particle::{FilterOptions, Motion};
///
/// let baseline = FilterOptions { motion: Motion::FixedOnLink, ..FilterOptions::default() };
/// assert_ne!(baseline.motion, Motion::default());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Motion {
    /// The obstacle stays, convex and springy (Bimbo 2019, eq. 8).
    #[default]
    Curvature,
    /// The contact point is fixed to the link (a baseline).
    FixedOnLink,
    /// The contact point is fixed in the world (a baseline).
    FixedInWorld,
}

/// How errors of torque are weighed.
///
/// ```
/// use contactsense::particle::{FilterOptions, Likelihood, Schedule};
///
/// // As in the paper.
/// let paper = FilterOptions {
///     likelihood: Likelihood::Exponential,
///     schedule: Schedule::paper(),
///     ..FilterOptions::default()
/// };
/// assert_ne!(paper.likelihood, Likelihood::default());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Likelihood {
    /// Gaussian, with noise per joint; the force is integrated out.
    #[default]
    Gaussian,
    /// `exp(-alpha |tau_hat - tau_ext|)` with a force drawn at random (Bimbo 2019, eq. 5).
    Exponential,
}

/// Options of a [`ContactParticleFilter`](super::ContactParticleFilter).
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::particle::{ContactParticleFilter, FilterOptions};
/// use contactsense::robot::Robot;
///
/// let robot = Arc::new(Robot::example_arm());
/// let links = Some(vec!["link_6".into(), "link_7".into()]);
/// let options = FilterOptions { particles: 500, links, ..FilterOptions::default() };
/// assert_eq!(ContactParticleFilter::new(robot.clone(), options.clone())?.links().len(), 2);
/// assert!(ContactParticleFilter::new(robot, FilterOptions { particles: 0, ..options }).is_err());
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct FilterOptions {
    /// How many particles.
    pub particles: usize,
    /// How contacts move.
    pub motion: Motion,
    /// Which forces a contact can exert.
    pub force_model: ForceModel,
    /// How errors of torque are weighed.
    pub likelihood: Likelihood,
    /// Names of the links to look on; all that move and have a surface by default.
    pub links: Option<Vec<String>>,
    /// Same seed, same answer, for any number of threads.
    pub seed: u64,
    /// Least and greatest force at the start (N).
    pub force_range: [f64; 2],
    /// Least and greatest contact stiffness [N/m].
    pub stiffness_range: [f64; 2],
    /// Least and greatest radius of the obstacle's curvature (m).
    pub radius_range: [f64; 2],
    /// Standard deviation of a torque at rest, one for all or one a joint [Nm; N for a sliding joint].
    pub torque_noise: Vec<f64>,
    /// Standard deviation of a torque relative to its size.
    pub relative_noise: f64,
    /// Below it on every joint there is no contact, one for all or one a joint (Nm). None for three standard deviations of
    /// the noise at rest, and at least 0.2 Nm where that noise is `torque_noise`.
    pub torque_threshold: Option<Vec<f64>>,
    /// Errors of the torques, in place of `torque_noise` and `relative_noise`, which are a short form of it.
    pub noise: Option<NoiseModel>,
    /// How sharpness and noise change.
    pub schedule: Schedule,
    /// Contacts that there may be at the same time, 1 to 4; several need the Gaussian likelihood.
    pub max_contacts: usize,
    /// How many threads share a step.
    pub threads: usize,
}

impl Default for FilterOptions {
    fn default() -> Self {
        FilterOptions {
            particles: 10_000,
            motion: Motion::default(),
            force_model: ForceModel::default(),
            likelihood: Likelihood::default(),
            links: None,
            seed: 0,
            force_range: [1.0, 100.0],
            stiffness_range: [3e2, 3e4],
            radius_range: [5e-3, 1.0],
            torque_noise: vec![0.02],
            relative_noise: 0.03,
            torque_threshold: None,
            noise: None,
            schedule: Schedule::Adaptive,
            max_contacts: 1,
            threads: 1,
        }
    }
}

/// `torque_noise` says nothing of the slow errors that are left of bias and friction (Nm).
const LEAST_THRESHOLD: f64 = 0.2;
/// Contacts that there may be at the same time.
pub(crate) const MOST_CONTACTS: usize = 4;
/// As many particles or threads at most.
const MOST_PARTICLES: usize = 10_000_000;
const MOST_THREADS: usize = 256;
/// Noise and thresholds below it are no measurement's [Nm].
const LEAST_TORQUE: f64 = 1e-9;

impl FilterOptions {
    /// Indices of the links to look on.
    pub(crate) fn check(&self, robot: &Robot) -> Result<Vec<usize>> {
        whole("particles", self.particles, 1..=MOST_PARTICLES)?;
        whole("threads", self.threads, 1..=MOST_THREADS)?;
        whole("max_contacts", self.max_contacts, 1..=MOST_CONTACTS)?;
        if self.max_contacts > 1 && self.likelihood != Likelihood::Gaussian {
            return Err(Error::input(
                "max_contacts",
                format!("must be 1 where the likelihood is not Gaussian, got {}", self.max_contacts),
            ));
        }
        range("force_range", self.force_range)?;
        range("stiffness_range", self.stiffness_range)?;
        range("radius_range", self.radius_range)?;
        if !(self.relative_noise.is_finite() && self.relative_noise >= 0.0) {
            return Err(Error::input(
                "relative_noise",
                format!("must be zero or a positive number, got {}", self.relative_noise),
            ));
        }
        self.force_model.check()?;
        self.schedule.check()?;
        robot.contact_links(self.links.as_deref(), "a particle filter")
    }

    /// What the torques err by.
    pub(crate) fn torque_noise(&self, robot: &Robot) -> Result<TorqueNoise> {
        match &self.noise {
            Some(noise) => noise.of(robot),
            None => {
                let torque = Self::per_joint(robot, "torque_noise", &self.torque_noise)?;
                Ok(NoiseModel::short(torque, self.relative_noise).of(robot)?.without_coupling())
            }
        }
    }

    /// The torque threshold, as given or by default, one for all or one a joint (Nm); none where it follows from `noise`.
    pub fn stated_threshold(&self) -> Option<Vec<f64>> {
        match (&self.torque_threshold, &self.noise) {
            (Some(given), _) => Some(given.clone()),
            (None, Some(_)) => None,
            (None, None) => {
                Some(self.torque_noise.iter().map(|noise| (LEVEL * noise).max(LEAST_THRESHOLD)).collect())
            }
        }
    }

    /// Below these torques on every joint there is no contact.
    pub(crate) fn threshold(&self, robot: &Robot, noise: &TorqueNoise) -> Result<Vec<f64>> {
        match self.stated_threshold() {
            Some(threshold) => Self::per_joint(robot, "torque_threshold", &threshold),
            None => Ok(noise.threshold()),
        }
    }

    /// One positive number a velocity variable.
    fn per_joint(robot: &Robot, name: &'static str, values: &[f64]) -> Result<Vec<f64>> {
        let all = robot.per_velocity(name, values)?;
        match all.iter().find(|x| !(LEAST_TORQUE..LARGEST).contains(*x)) {
            Some(value) => Err(Error::input(name, format!("must be at least {LEAST_TORQUE:e}, got {value}"))),
            None => Ok(all),
        }
    }
}

/// Refuses what is not in the range.
pub(crate) fn whole(name: &'static str, value: usize, range: RangeInclusive<usize>) -> Result<()> {
    if range.contains(&value) {
        return Ok(());
    }
    let (low, high) = range.into_inner();
    Err(Error::input(name, format!("must be a whole number from {low} to {high}, got {value}")))
}

fn range(name: &'static str, [low, high]: [f64; 2]) -> Result<()> {
    if low > 0.0 && low <= high && high < 1e12 {
        return Ok(());
    }
    Err(Error::input(name, format!("must be two positive numbers, the lesser first, got {low} and {high}")))
}
