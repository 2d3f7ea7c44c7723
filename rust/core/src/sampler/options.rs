//! Options of the sampler.

use crate::error::{Error, Result};
use crate::particle::FilterOptions;
use crate::robot::Robot;
use crate::torque::{ForceModel, NoiseModel};

/// Measurements that a window holds at least and at most: one pose tells little, and each costs time and memory.
const LEAST_WINDOW: usize = 2;
const MOST_WINDOW: usize = 1000;

/// Options of a [`StaticObstacleSampler`](super::StaticObstacleSampler).
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::robot::Robot;
/// use contactsense::sampler::{SamplerOptions, StaticObstacleSampler};
///
/// let options = SamplerOptions { hypotheses: 500, window: 20, ..SamplerOptions::default() };
/// let sampler = StaticObstacleSampler::new(Arc::new(Robot::example_arm()), &options)?;
/// assert_eq!(sampler.weights().len(), 500);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SamplerOptions {
    /// How many hypotheses.
    pub hypotheses: usize,
    /// Poses whose torques are kept, from 2 to 1000.
    pub window: usize,
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
    /// Moves of each hypothesis after they are drawn anew.
    pub moves: usize,
    /// How many threads share an update.
    pub threads: usize,
}

impl Default for SamplerOptions {
    fn default() -> Self {
        let filter = FilterOptions::default();
        SamplerOptions {
            hypotheses: 4000,
            window: 40,
            force_model: filter.force_model,
            links: None,
            seed: filter.seed,
            force_range: filter.force_range,
            stiffness_range: filter.stiffness_range,
            radius_range: filter.radius_range,
            torque_noise: filter.torque_noise,
            relative_noise: filter.relative_noise,
            torque_threshold: None,
            noise: None,
            moves: 6,
            threads: filter.threads,
        }
    }
}

impl SamplerOptions {
    /// What a filter is told in the same words; it is checked with the links that are looked on.
    pub(super) fn check(&self, robot: &Robot) -> Result<(FilterOptions, Vec<usize>)> {
        if !(LEAST_WINDOW..=MOST_WINDOW).contains(&self.window) {
            let text =
                format!("must be a whole number from {LEAST_WINDOW} to {MOST_WINDOW}, got {}", self.window);
            return Err(Error::input("window", text));
        }
        let filter = FilterOptions {
            particles: self.hypotheses,
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
        let wanted = filter.check(robot).map_err(|error| match error {
            Error::Input { argument, problem } if argument == "particles" => {
                Error::input("hypotheses", problem)
            }
            other => other,
        })?;
        Ok((filter, wanted))
    }
}
