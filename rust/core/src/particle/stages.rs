//! An update in its parts, each by itself, to be timed.

use std::sync::Arc;

use super::columns::Columns;
use super::options::FilterOptions;
use super::state::FilterState;
use super::step_noise::StepNoise;
use crate::error::Result;
use crate::robot::Robot;

/// A filter whose updates are done part by part.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::particle::{FilterOptions, Stages};
/// use contactsense::robot::Robot;
///
/// let (q, tau) = ([0.4; 7], [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0]);
/// let options = FilterOptions { particles: 500, ..FilterOptions::default() };
/// let mut stages = Stages::new(Arc::new(Robot::example_arm()), options, &q, &tau)?;
/// stages.motion(&q, &tau)?;
/// let effective = stages.likelihood();
/// assert!(effective > 0.0 && effective <= 500.0);
/// stages.resampling();
/// stages.estimate();
/// assert_eq!(stages.particles().len(), 500);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Stages(FilterState);

impl Stages {
    /// A filter after one whole update.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) names the option or argument.
    pub fn new(robot: Arc<Robot>, options: FilterOptions, q: &[f64], tau_ext: &[f64]) -> Result<Self> {
        let mut state = FilterState::new(robot, options)?;
        state.read(q, tau_ext)?;
        state.step();
        Ok(Stages(state))
    }

    /// Moves all particles to a pose and computes what their forces do to the joints.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) names the argument.
    pub fn motion(&mut self, q: &[f64], tau_ext: &[f64]) -> Result<()> {
        self.0.read(q, tau_ext)?;
        let noise = self.noise();
        self.0.predict(&noise, self.0.cloud.particles.len());
        Ok(())
    }

    /// Weighs all particles, sharpness chosen first; returns how many are effective.
    pub fn likelihood(&mut self) -> f64 {
        let noise = self.noise();
        self.0.weigh(self.0.instant.displacement(), &noise)
    }

    /// Draws all particles anew by their weights, and moves copies apart.
    pub fn resampling(&mut self) {
        let noise = self.noise();
        let copies = self.0.cloud.particles.len() * 99 / 100;
        self.0.resample(&noise, self.0.instant.displacement(), copies);
    }

    /// Finds the modes and says the estimate.
    pub fn estimate(&mut self) {
        self.0.estimate_contact(crate::particle::Event::Continued, 1.0, 0.0);
    }

    /// The particles.
    pub fn particles(&self) -> &Columns {
        &self.0.cloud.particles
    }

    fn noise(&self) -> StepNoise {
        StepNoise::at(&self.0.options, self.0.clock.age, self.0.instant.displacement())
    }
}
