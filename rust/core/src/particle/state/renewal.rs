//! Drawing particles anew, by their weights and from the whole surface.

use super::FilterState;
use crate::particle::birth::Birth;
use crate::particle::cloud::Cloud;
use crate::particle::columns::Slice;
use crate::particle::estimate::Event;
use crate::particle::options::{Likelihood, Motion};
use crate::particle::rejuvenation::Rejuvenation;
use crate::particle::step_noise::StepNoise;
use crate::posterior::parallel::{Course, Pieces};

/// Share of the particles that look for a contact on the whole surface, where nothing explains the torque.
const REINITIALISED: f64 = 0.5;
/// Share of the robot's motion that a contact held to be fixed moves.
const SLIP: f64 = 0.5;

impl FilterState {
    /// Nothing explains the torque, as after a jump of the contact: looks for it on the whole surface at once, beside what
    /// was known. Returns how many particles are effective then, and what happened.
    pub(super) fn reinitialise(&mut self, noise: &StepNoise, moved: f64, event: Event) -> (f64, Event) {
        let count = self.cloud.particles.len();
        let kept = self.copies(REINITIALISED);
        self.resample(noise, moved, kept);
        self.instant.stand();
        self.adaptation.begin();
        self.predict(&StepNoise::none(), kept);
        let effective = self.weigh(0.0, &StepNoise::none());
        let found: f64 = self.cloud.weights[kept..count].iter().sum();
        (effective, if found > 0.5 { Event::Changed } else { event })
    }

    /// How many are copies where particles are drawn anew, a share of them from the whole surface.
    pub(super) fn copies(&self, fresh_share: f64) -> usize {
        let count = self.cloud.particles.len();
        count - ((fresh_share * count as f64) as usize).min(count - 1)
    }

    /// Where systematic resampling begins.
    pub(super) fn offset(&mut self) -> f64 {
        self.clock.stream().uniform(0)
    }

    /// Draws particles anew: so many copies, and those behind them from the whole surface.
    pub fn resample(&mut self, noise: &StepNoise, moved: f64, kept: usize) {
        let offset = self.offset();
        self.cloud.copying().0.draw(kept, offset);
        self.take_copies(kept, noise, moved);
    }

    /// Puts copies that were drawn in the particles' place, moved apart, and draws the others from the whole surface.
    pub(super) fn take_copies(&mut self, kept: usize, noise: &StepNoise, moved: f64) {
        self.cloud.take_copies(kept);
        let apart = noise.point.unwrap_or_else(|| {
            // A contact that is held to be fixed is not: it moves about as much as the robot does.
            let slip = if self.options.motion == Motion::Curvature { 0.0 } else { SLIP * moved };
            self.adaptation.apart(self.clusters.spread).max(slip)
        });
        self.rejuvenate(kept, apart, noise.point.is_some());
        self.renew(kept, false);
        self.cloud.level();
    }

    /// Moves copies among the first ones (or all of these) apart along the surface [m].
    fn rejuvenate(&mut self, kept: usize, apart: f64, all: bool) {
        let apart = Rejuvenation {
            motion: self.options.motion,
            apart,
            all,
            response_model: self.response_model(),
            keep_torque: self.options.likelihood == Likelihood::Gaussian,
            stiffness_range: self.options.stiffness_range,
            most_force: self.options.force_range[1],
            random: self.clock.stream(),
        };
        let Self { robot, instant, cloud, options, stop, .. } = self;
        let Cloud { particles, parents, .. } = cloud;
        let work = |start: usize, mut slice: Slice<'_>| {
            apart.apply(robot, instant, parents, start, &mut slice);
        };
        Course { threads: options.threads, stop }.for_each(particles.slice().split(kept).0, 0, &work);
    }

    /// Makes all particles behind the first ones anew, from the whole surface: evenly, or at random.
    pub(super) fn renew(&mut self, kept: usize, evenly: bool) {
        let (response_model, random) = (self.response_model(), self.clock.stream());
        let Self { robot, instant, cloud, options, stop, .. } = self;
        let Cloud { births, particles, .. } = cloud;
        let count = particles.len();
        let birth = Birth { births, robot, instant, response_model, motion: options.motion, random };
        let work = |start: usize, mut slice: Slice<'_>| {
            for k in 0..slice.len() {
                if evenly {
                    birth.evenly(&mut slice, k, start + k, count);
                } else {
                    birth.anywhere(&mut slice, k, start + k);
                }
            }
        };
        Course { threads: options.threads, stop }.for_each(particles.slice().split(kept).1, kept, &work);
    }
}
