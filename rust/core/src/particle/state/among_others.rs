//! A contact among others: what it takes from what is known of them, and what they know of it.

use super::FilterState;
use crate::particle::adaptation::Adaptation;
use crate::particle::check::tolerance;
use crate::particle::known::{Known, Spring};
use crate::particle::options::Motion;
use crate::particle::step_noise::StepNoise;

impl FilterState {
    /// Takes out of the measurement that was read what other contacts do to it, beside this one as it is known.
    pub fn look_beside(&mut self, others: &[Known]) {
        let model = self.response_model();
        self.beside.take_out(&mut self.instant, others, self.known.as_ref(), &model);
    }

    /// The contact as others take it to be, where this is the best particle.
    pub(super) fn known(&self, best: usize) -> Option<Known> {
        let mode = self.found.estimate.contact?;
        let link = mode.link.get();
        let particles = &self.cloud.particles;
        if particles.link[best] as usize == link {
            let obstacle = (self.options.motion == Motion::Curvature).then(|| Spring {
                centre: particles.centre[best],
                distance: particles.distance[best],
                triangle: particles.triangle[best],
                stiffness: particles.stiffness[best],
            });
            return Some(Known {
                link,
                point: particles.point[best],
                normal: particles.normal[best],
                force: particles.force[best].max(0.0),
                spread: mode.spread,
                sure: self.stays,
                obstacle,
            });
        }
        let local = mode.in_link_frame(self.instant.pose(link));
        let force = -local.force.dot(&local.normal);
        Some(Known {
            link,
            point: local.point,
            normal: local.normal,
            force,
            spread: mode.spread,
            sure: self.stays,
            obstacle: None,
        })
    }

    /// Lets what is known of the contact follow the robot to the pose that was read.
    pub fn follow_known(&mut self) {
        if let Some(known) = &mut self.known {
            known.follow(&self.robot, &self.instant);
        }
    }

    /// Looks for the contact on the whole surface beside what is known of it, and for its noise anew: what other contacts do is seen
    /// otherwise now.
    pub fn look_again(&mut self) {
        self.adaptation = Adaptation::default();
        let noise = StepNoise::at(&self.options, self.clock.age, 0.0);
        let (effective, event) = self.reinitialise(&noise, 0.0, self.found.event);
        self.check.restart();
        self.estimate_contact(event, effective, 0.0);
    }

    /// Whether the torques of this update are explained without this contact, which explains less than told; or whether one that was sure
    /// has no force any more.
    pub fn is_idle(&self, least: f64) -> bool {
        if self.stays {
            return self.known.is_none_or(|known| known.force < self.options.force_range[0]);
        }
        self.explains < least && self.instant.squared <= tolerance(self.instant.torque.len())
    }

    /// Forgets the poses that were to confirm the contact.
    pub fn doubt(&mut self) {
        self.check.restart();
        self.found.estimate.ambiguous = self.found.estimate.contact.is_some();
    }
}
