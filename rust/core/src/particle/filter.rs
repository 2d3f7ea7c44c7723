//! The filter as users see it.

use std::sync::Arc;

use nalgebra::Vector3;

use super::columns::Columns;
use super::estimate::ContactEstimate;
use super::options::FilterOptions;
use super::parallel::Crew;
use super::swarm::Swarm;
use crate::error::Result;
use crate::robot::Robot;

/// Finds one contact anywhere on a robot from joint torques, by particles on its surface (Bimbo 2019).
///
/// Each particle is a hypothesis of link, point, obstacle and force. The robot makes small motions in contact; those
/// that predict the torques survive. Per particle the force and the stiffness are a Gaussian belief that a Kalman
/// filter updates (Rao-Blackwell), so that only link, point and obstacle are sampled, and an obstacle's centre is kept
/// from step to step but for a share that is drawn anew.
///
/// After the first one an update allocates nothing, and takes a time in proportion to the particles.
#[derive(Debug)]
pub struct ContactParticleFilter {
    // Away only while the crew has it, within `update`.
    swarm: Option<Box<Swarm>>,
    crew: Option<Crew>,
}

impl ContactParticleFilter {
    /// A filter for a robot.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) names the option.
    pub fn new(robot: Arc<Robot>, options: FilterOptions) -> Result<Self> {
        let threads = options.threads;
        let swarm = Box::new(Swarm::new(robot, options)?);
        let crew = if threads > 1 { Some(Crew::new(threads)?) } else { None };
        Ok(Self { swarm: Some(swarm), crew })
    }

    /// Takes in a configuration `q` `(nq,)` and the external torque `tau_ext` `(nv,)` measured there [Nm; N for sliding
    /// joints and a base's linear part].
    ///
    /// The external torque is what a [`MomentumObserver`](crate::observer::MomentumObserver) gives, or where the robot
    /// holds still the static equation, `g(q) - tau`.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) names the argument; the filter is unchanged.
    pub fn update(&mut self, q: &[f64], tau_ext: &[f64]) -> Result<&ContactEstimate> {
        let swarm = self.swarm();
        swarm.read(q, tau_ext)?;
        match (&self.crew, self.swarm.take()) {
            (Some(crew), Some(swarm)) => self.swarm = Some(crew.step(swarm)),
            (_, swarm) => {
                self.swarm = swarm;
                self.swarm().step();
            }
        }
        Ok(self.estimate())
    }

    /// Forgets all updates.
    pub fn reset(&mut self) {
        self.swarm().reset();
    }

    /// The last estimate.
    pub fn estimate(&self) -> &ContactEstimate {
        &self.present().estimate
    }

    /// The particles after the last update.
    pub fn particles(&self) -> &Columns {
        &self.present().particles
    }

    /// Their weights, which sum to one.
    pub fn weights(&self) -> &[f64] {
        &self.present().weights
    }

    /// Indices of the links that are looked on.
    pub fn links(&self) -> &[usize] {
        &self.present().frames.wanted
    }

    /// Contact point of particle k, world frame [m].
    pub fn point(&self, k: usize) -> Vector3<f64> {
        let Swarm { frames, particles, .. } = self.present();
        frames.links[particles.link[k] as usize].pose.transform_point(&particles.point[k])
    }

    /// Outward normal of particle k, world frame.
    pub fn normal(&self, k: usize) -> Vector3<f64> {
        let Swarm { frames, particles, .. } = self.present();
        frames.links[particles.link[k] as usize].pose.rotation * particles.normal[k]
    }

    fn swarm(&mut self) -> &mut Swarm {
        self.swarm.as_mut().expect(PRESENT)
    }

    fn present(&self) -> &Swarm {
        self.swarm.as_ref().expect(PRESENT)
    }
}

const PRESENT: &str = "the particles are away only within an update";
