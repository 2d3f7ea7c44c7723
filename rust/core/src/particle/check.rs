//! Whether a single push on an obstacle that stays explains what was measured, and for how long it has.

use super::fit::{Fit, Push};
use super::schedule::NEW_POSE;
use super::spring::{Place, Spring};

/// A slope of so many standard errors is none by chance (99.9 %).
const CONFIRMED: f64 = 3.0;
/// A stiffness is not in its range where even so many standard errors more are softer (99 %).
const EXCLUDED: f64 = 2.326;
/// Updates for which both tests must have held before they are trusted: what is no push holds them by chance only, in
/// one motion of a few updates and not in the next, a push holds them for ever.
const HOLD: u32 = 5;

/// Tests over the last updates.
#[derive(Debug, Clone)]
pub(super) struct Check {
    fit: Fit,
    spring: Spring,
    /// Least stiffness of an obstacle [N/m]; none where no obstacle is assumed, which needs no motion then.
    softest: Option<f64>,
    explained: bool,
    /// Updates for which the tests have held, up to `HOLD`.
    held: u32,
}

impl Check {
    pub fn new(fit: Fit, softest: Option<f64>) -> Self {
        Check { fit, spring: Spring::default(), softest, explained: true, held: 0 }
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
            Some(true) if self.explained => self.held = (self.held + 1).min(HOLD),
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
        let confirmed = slope.value >= CONFIRMED * slope.error;
        (contradicted, (confirmed || slope.value < 0.0).then_some(confirmed))
    }

    /// Whether a single push explains the last updates.
    pub fn explained(&self) -> bool {
        self.explained
    }

    /// Whether it has been confirmed for long enough to be trusted.
    pub fn trusted(&self) -> bool {
        self.held >= HOLD
    }
}
