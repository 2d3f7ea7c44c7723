//! The filter as users see it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;

use nalgebra::Vector3;

use super::columns::Columns;
use super::estimate::FilterEstimate;
use super::options::FilterOptions;
use super::sets::Sets;
use super::state::FilterState;
use crate::error::{Error, Result};
use crate::posterior::parallel::Pool;
use crate::robot::Robot;

/// Finds one contact or several anywhere on a robot from joint torques, by particles on its surface (Bimbo 2019).
///
/// Each particle is a hypothesis of link, point, obstacle and force. The robot makes small motions in contact; those
/// that predict the torques survive. Per particle the force and the stiffness are a Gaussian belief that a Kalman
/// filter updates (Rao-Blackwell), so that only link, point and obstacle are sampled, and an obstacle's centre is kept
/// from step to step but for a share that is drawn anew.
///
/// Of several contacts ([`max_contacts`](FilterOptions::max_contacts)) each has particles of its own (Manuelli and Tedrake 2016), which
/// explain what the others may leave over; they are added while the torques ask for it, and dropped when they explain nothing.
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
    sets: Sets,
    pool: Pool,
}

impl ContactParticleFilter {
    /// A filter for a robot.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) names the option.
    pub fn new(robot: Arc<Robot>, options: FilterOptions) -> Result<Self> {
        Ok(Self { sets: Sets::new(&robot, &options)?, pool: Pool::new(options.threads)? })
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
        let Self { sets, pool } = self;
        sets.read(q, tau_ext)?;
        pool.install(|| sets.step());
        if sets.stop().swap(false, Ordering::Relaxed) {
            // What was done in part is of no use.
            sets.reset();
            return Err(Error::Stopped);
        }
        Ok(&self.sets.first().found)
    }

    /// A flag that stops an update when another thread sets it. The update then ends within some seconds, even with ten
    /// million particles, with [`Error::Stopped`], and the filter has forgotten all updates.
    pub fn stop(&self) -> Arc<AtomicBool> {
        self.sets.stop().clone()
    }

    /// Forgets all updates.
    pub fn reset(&mut self) {
        self.sets.reset();
    }

    /// The last estimate.
    pub fn estimate(&self) -> &FilterEstimate {
        &self.sets.first().found
    }

    /// Indices of the links that are looked on.
    pub fn links(&self) -> &[usize] {
        &self.sets.first().instant.frames.wanted
    }

    /// The particles of each contact after the last update; of one contact where there is none.
    pub fn contacts(&self) -> impl ExactSizeIterator<Item = ContactParticles<'_>> {
        self.sets.of_contacts().map(ContactParticles)
    }

    /// The particles of the first contact after the last update.
    pub fn particles(&self) -> &Columns {
        &self.sets.first().cloud.particles
    }

    /// Their weights, which sum to one.
    pub fn weights(&self) -> &[f64] {
        &self.sets.first().cloud.weights
    }
}

/// The particles of one contact.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::particle::{ContactParticleFilter, FilterOptions};
/// use contactsense::robot::Robot;
///
/// let options = FilterOptions { particles: 500, max_contacts: 2, ..FilterOptions::default() };
/// let mut filter = ContactParticleFilter::new(Arc::new(Robot::example_arm()), options)?;
/// filter.update(&[0.4; 7], &[1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])?;
/// assert_eq!(filter.contacts().len(), 1);
/// for contact in filter.contacts() {
///     assert!((contact.weights().iter().sum::<f64>() - 1.0).abs() < 1e-9);
///     assert!((contact.normal(0).norm() - 1.0).abs() < 1e-9);
/// }
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct ContactParticles<'a>(&'a FilterState);

impl<'a> ContactParticles<'a> {
    /// As columns.
    pub fn columns(&self) -> &'a Columns {
        &self.0.cloud.particles
    }

    /// Their weights, which sum to one.
    pub fn weights(&self) -> &'a [f64] {
        &self.0.cloud.weights
    }

    /// Contact point of particle k, world frame (m).
    pub fn point(&self, k: usize) -> Vector3<f64> {
        let particles = self.columns();
        self.0.instant.pose(particles.link[k] as usize).transform_point(&particles.point[k])
    }

    /// Outward normal of particle k, world frame.
    pub fn normal(&self, k: usize) -> Vector3<f64> {
        let particles = self.columns();
        self.0.instant.pose(particles.link[k] as usize).rotation * particles.normal[k]
    }
}
