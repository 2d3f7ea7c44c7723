//! The filter as users see it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;

use nalgebra::Vector3;

use super::columns::Columns;
use super::estimate::FilterEstimate;
use super::options::FilterOptions;
use super::state::FilterState;
use crate::error::{Error, Result};
use crate::posterior::parallel::Pool;
use crate::robot::Robot;

/// Finds one contact anywhere on a robot from joint torques, by particles on its surface (Bimbo 2019).
///
/// Each particle is a hypothesis of link, point, obstacle and force. The robot makes small motions in contact; those
/// that predict the torques survive. Per particle the force and the stiffness are a Gaussian belief that a Kalman
/// filter updates (Rao-Blackwell), so that only link, point and obstacle are sampled, and an obstacle's centre is kept
/// from step to step but for a share that is drawn anew.
///
/// After the first one an update on one thread allocates nothing; its time is in proportion to the particles.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::particle::{ContactParticleFilter, FilterOptions};
/// use contactsense::robot::Robot;
///
/// let robot = Arc::new(Robot::example_arm());
/// let options = FilterOptions { particles: 1000, ..FilterOptions::default() };
/// let mut filter = ContactParticleFilter::new(robot, options)?;
/// let found = filter.update(&[0.4; 7], &[0.0; 7])?;
/// assert!(found.estimate.contact.is_none());
///
/// let found = filter.update(&[0.4; 7], &[1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])?;
/// assert!(found.estimate.contact.is_some() && found.estimate.ambiguous);
/// assert_eq!(filter.particles().len(), 1000);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug)]
pub struct ContactParticleFilter {
    state: FilterState,
    pool: Pool,
}

impl ContactParticleFilter {
    /// A filter for a robot.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) names the option.
    pub fn new(robot: Arc<Robot>, options: FilterOptions) -> Result<Self> {
        let threads = options.threads;
        let state = FilterState::new(robot, options)?;
        Ok(Self { state, pool: Pool::new(threads)? })
    }

    /// Takes in a configuration `q` `(nq,)` and the external torque `tau_ext` `(nv,)` measured there [Nm; N for sliding
    /// joints and a base's linear part].
    ///
    /// The external torque is what a [`MomentumObserver`](crate::observer::MomentumObserver) gives, or where the robot
    /// holds still the static equation, `g(q) - tau`.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) names the argument; the filter is unchanged.
    pub fn update(&mut self, q: &[f64], tau_ext: &[f64]) -> Result<&FilterEstimate> {
        let Self { state, pool } = self;
        state.read(q, tau_ext)?;
        pool.install(|| state.step());
        if state.stop.swap(false, Ordering::Relaxed) {
            // What was done in part is of no use.
            state.reset();
            return Err(Error::Stopped);
        }
        Ok(&state.found)
    }

    /// A flag that stops an update when another thread sets it. The update then ends within some seconds, even with ten
    /// million particles, with [`Error::Stopped`], and the filter has forgotten all updates.
    pub fn stop(&self) -> Arc<AtomicBool> {
        self.state.stop.clone()
    }

    /// Forgets all updates.
    pub fn reset(&mut self) {
        self.state.reset();
    }

    /// The last estimate.
    pub fn estimate(&self) -> &FilterEstimate {
        &self.state.found
    }

    /// The particles after the last update.
    pub fn particles(&self) -> &Columns {
        &self.state.cloud.particles
    }

    /// Their weights, which sum to one.
    pub fn weights(&self) -> &[f64] {
        &self.state.cloud.weights
    }

    /// Indices of the links that are looked on.
    pub fn links(&self) -> &[usize] {
        &self.state.instant.frames.wanted
    }

    /// Contact point of particle k, world frame (m).
    pub fn point(&self, k: usize) -> Vector3<f64> {
        let FilterState { instant, cloud, .. } = &self.state;
        let particles = &cloud.particles;
        instant.pose(particles.link[k] as usize).transform_point(&particles.point[k])
    }

    /// Outward normal of particle k, world frame.
    pub fn normal(&self, k: usize) -> Vector3<f64> {
        let FilterState { instant, cloud, .. } = &self.state;
        let particles = &cloud.particles;
        instant.pose(particles.link[k] as usize).rotation * particles.normal[k]
    }
}
