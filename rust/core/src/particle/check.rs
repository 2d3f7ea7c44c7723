//! Whether a single push on an obstacle that stays explains what was measured, and for how long it has.

use super::fit::{Fit, Push, FITTED};
use super::options::{FilterOptions, Likelihood, Motion};
use super::schedule::NEW_POSE;
use super::spring::{Place, Spring};

/// A slope of so many standard errors is none by chance (99.9 %).
const CONFIRMED: f64 = 3.0;
/// A stiffness is not in its range where even so many standard errors more are softer (99 %).
const EXCLUDED: f64 = 2.326;
/// With no torque to spare, the point can be chosen so that the force follows the softest obstacle in the range, whatever
/// the truth: then the stiffness is confirmed only from so many times the softest on.
const CLEARLY_STIFFER: f64 = 2.0;
/// A slope below so many standard errors takes a confirmation back: less than what gives one, so that a push whose
/// motions tell little for a while is not doubted.
const DOUBTED: f64 = 1.0;
/// Updates for which both tests must have held before they are trusted, with torques to spare and without: what is no
/// push holds them by chance only, in one motion and not in the next; a push holds them for ever.
const HOLD: u32 = 5;
const HOLD_WITHOUT_SPARE: u32 = 10;

/// Tests over the last updates.
#[derive(Debug, Clone)]
pub(super) struct Check {
    fit: Fit,
    spring: Spring,
    /// Least stiffness of an obstacle [N/m]; none where no obstacle is assumed, which needs no motion then.
    softest: Option<f64>,
    explained: bool,
    /// Updates for which the tests have held, and are to hold.
    held: u32,
    hold: u32,
}

impl Check {
    pub fn new(options: &FilterOptions, torque_noise: Vec<f64>) -> Self {
        // Only where an obstacle is assumed and its force is believed to follow the motion.
        let springy = options.motion == Motion::Curvature && options.likelihood == Likelihood::Gaussian;
        Check {
            fit: Fit::new(torque_noise, options.relative_noise),
            spring: Spring::default(),
            softest: springy.then_some(options.stiffness_range[0]),
            explained: true,
            held: 0,
            hold: HOLD,
        }
    }

    /// Forgets all updates: another contact is looked at.
    pub fn restart(&mut self) {
        self.fit.restart();
        self.spring.restart();
        self.explained = true;
        self.held = 0;
    }

    /// Takes in the push that is told, and another one that may fit better, after a motion [m]; returns the root mean
    /// square of the residual, in standard deviations of the stated noise.
    pub fn take_in(&mut self, told: &Push<'_>, other: Option<&Push<'_>>, torque: &[f64], moved: f64) -> f64 {
        let residual = self.fit.take_in(told, other, torque);
        let (contradicted, confirmed) = match self.softest {
            Some(softest) => self.follow(softest, told, moved),
            None => (false, Some(true)),
        };
        self.explained = self.fit.explained() && !contradicted;
        match confirmed {
            Some(true) if self.explained => self.held = self.held.saturating_add(1),
            // A motion that tells little confirms nothing, and takes nothing back.
            None if self.explained => {}
            _ => self.held = 0,
        }
        residual
    }

    /// Takes in the force that is found; returns whether it contradicts an obstacle, and whether it confirms one.
    fn follow(&mut self, softest: f64, told: &Push<'_>, moved: f64) -> (bool, Option<bool>) {
        let Push { link, point, normal, .. } = *told;
        if self.spring.link() != Some(link) {
            self.held = 0;
        }
        let (gain, product) = told.response();
        if gain > 0.0 {
            let place = Place { link, pose: told.frames.links[link].pose, point, normal };
            self.spring.take_in(place, product / gain, 1.0 / gain, (moved / NEW_POSE).min(1.0));
        }
        let Some(slope) = self.spring.slope() else { return (false, None) };
        let contradicted = slope.value + EXCLUDED * slope.error < softest;
        let spare = told.frames.links[link].joints() > FITTED;
        self.hold = if spare { HOLD } else { HOLD_WITHOUT_SPARE };
        let least = if spare { softest } else { CLEARLY_STIFFER * softest };
        let kept = if spare { 0.0 } else { least };
        let confirmed = slope.value >= (CONFIRMED * slope.error).max(least);
        (contradicted, (confirmed || slope.value < (DOUBTED * slope.error).max(kept)).then_some(confirmed))
    }

    /// Whether a single push explains the last updates.
    pub fn explained(&self) -> bool {
        self.explained
    }

    /// Whether it has been confirmed for long enough to be trusted.
    pub fn trusted(&self) -> bool {
        self.held >= self.hold
    }
}
