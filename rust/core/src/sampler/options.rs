//! Options of the sampler.

use crate::error::{Error, Result};
use crate::particle::{whole, FilterOptions, MOST_CONTACTS};
use crate::robot::Robot;
use crate::torque::{ForceModel, NoiseModel};

use super::hypothesis::ContactModel;

/// Measurements that a window holds at least and at most: one pose tells little, and each costs time and memory.
const LEAST_WINDOW: usize = 2;
const MOST_WINDOW: usize = 1000;

/// More moves only take time.
const MOST_MOVES: usize = 1000;

/// Options of a [`StaticObstacleSampler`](super::StaticObstacleSampler).
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::robot::Robot;
/// use contactsense::sampler::{SamplerOptions, StaticObstacleSampler};
///
/// let options = SamplerOptions { particles: 500, window: 20, ..SamplerOptions::default() };
/// let sampler = StaticObstacleSampler::new(Arc::new(Robot::example_arm()), &options)?;
/// assert_eq!(sampler.weights().len(), 500);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SamplerOptions {
    /// How many particles: hypotheses of a contact.
    pub particles: usize,
    /// What the contact may be with.
    pub models: Vec<ContactModel>,
    /// Contacts that there may be at the same time, from 1 to 4. Of more than one, all are with obstacles.
    pub max_contacts: usize,
    /// Poses whose torques are kept, from 2 to 1000.
    pub window: usize,
    /// Time after which a measurement counts for a part in e of what it did when it was new (s): obstacles that creep are followed.
    /// None for obstacles that stay.
    pub forgetting_time: Option<f64>,
    /// Which forces a contact can exert.
    pub force_model: ForceModel,
    /// Names of the links to look on; all that move and have a surface by default.
    pub links: Option<Vec<String>>,
    /// Same seed, same answer, for any number of threads.
    pub seed: u64,
    /// Least and greatest force at the first touch (N).
    pub force_range: [f64; 2],
    /// Least and greatest contact stiffness (N/m).
    pub stiffness_range: [f64; 2],
    /// Least and greatest radius of the obstacle's curvature (m).
    pub radius_range: [f64; 2],
    /// Standard deviation of a torque at rest, one for all or one a joint (Nm; N for a sliding joint).
    pub torque_noise: Vec<f64>,
    /// Standard deviation of a torque relative to its size.
    pub relative_noise: f64,
    /// Below it on every joint there is no contact, as [`FilterOptions::torque_threshold`].
    pub torque_threshold: Option<Vec<f64>>,
    /// Errors of the torques, in place of `torque_noise` and `relative_noise`.
    pub noise: Option<NoiseModel>,
    /// Moves of each particle in an update at most, where the window is full; more where it is not, for the same work. Twice as many
    /// of particles of several contacts.
    pub moves: usize,
    /// How many threads share an update.
    pub threads: usize,
}

impl Default for SamplerOptions {
    fn default() -> Self {
        Self::like(&FilterOptions::default())
    }
}

impl SamplerOptions {
    /// With all that a filter is told in the same words, the others by default.
    pub fn like(filter: &FilterOptions) -> Self {
        let filter = filter.clone();
        SamplerOptions {
            particles: filter.particles,
            models: vec![ContactModel::Obstacle],
            max_contacts: 1,
            window: 40,
            forgetting_time: None,
            force_model: filter.force_model,
            links: filter.links,
            seed: filter.seed,
            force_range: filter.force_range,
            stiffness_range: filter.stiffness_range,
            radius_range: filter.radius_range,
            torque_noise: filter.torque_noise,
            relative_noise: filter.relative_noise,
            torque_threshold: filter.torque_threshold,
            noise: filter.noise,
            moves: 1,
            threads: filter.threads,
        }
    }

    /// What a filter is told in the same words; it is checked with the links that are looked on.
    pub(super) fn check(&self, robot: &Robot) -> Result<(FilterOptions, Vec<usize>)> {
        for (name, value, range) in [
            ("window", self.window, LEAST_WINDOW..=MOST_WINDOW),
            ("moves", self.moves, 1..=MOST_MOVES),
            ("max_contacts", self.max_contacts, 1..=MOST_CONTACTS),
        ] {
            whole(name, value, range)?;
        }
        if let Some(time) = self.forgetting_time.filter(|time| !(*time > 0.0 && time.is_finite())) {
            return Err(Error::input("forgetting_time", format!("must be positive (s), got {time}")));
        }
        if self.models.is_empty() {
            return Err(Error::input("models", "must name at least one model of a contact"));
        }
        if self.max_contacts > 1 && self.models.iter().any(|model| *model != ContactModel::Obstacle) {
            return Err(Error::input(
                "models",
                "must be 'obstacle' alone where max_contacts is greater than 1",
            ));
        }
        let filter = FilterOptions {
            particles: self.particles,
            force_model: self.force_model,
            links: self.links.clone(),
            seed: self.seed,
            force_range: self.force_range,
            stiffness_range: self.stiffness_range,
            radius_range: self.radius_range,
            torque_noise: self.torque_noise.clone(),
            relative_noise: self.relative_noise,
            torque_threshold: self.torque_threshold.clone(),
            noise: self.noise.clone(),
            threads: self.threads,
            ..FilterOptions::default()
        };
        let wanted = filter.check(robot)?;
        Ok((filter, wanted))
    }
}
