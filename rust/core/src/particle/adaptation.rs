//! The adaptive schedule: how sharply to weigh and how far to move copies, from what the data show.

use super::step_noise::NEW_POSE;

/// Least share of a measurement that counts although the robot stands still.
const STANDING: f64 = 0.02;
/// Share of particles that keep a say at each weighing.
const EFFECTIVE: f64 = 0.25;
/// Weight of the newest residual in what is held to be the noise.
const NEWEST: f64 = 0.3;
/// Copies are moved by this share of their mode's spread, and where the weighing was much wider than the noise, by the
/// second; within limits [m].
const APART: [f64; 2] = [0.1, 0.3];
const WIDENED: f64 = 4.0;
const LEAST_APART: f64 = 3e-4;
const MOST_APART: f64 = 0.02;
/// Share of particles that are drawn anew from the whole surface, where all is explained and where nothing is.
const FRESH: [f64; 2] = [0.01, 0.3];
/// Measurements in new poses over which errors are averaged at most.
const AVERAGED: f64 = 10.0;
/// Torques that are off by more are not noise, in units of its variance.
const MOST_VARIANCE: f64 = 30.0;
/// Updates after which a contact that one joint, two or three feel tells little new.
const FEW_JOINTS: [f64; 3] = [0.3, 1.0, 10.0];

/// Which share of a measurement is new after a motion [m].
pub(super) fn news(moved: f64) -> f64 {
    (moved / NEW_POSE).clamp(STANDING, 1.0)
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Adaptation {
    /// Variance of the torques' error, in units of their noise; none before a measurement.
    variance: Option<f64>,
    /// Share of the present measurement that has not been weighed yet.
    backlog: f64,
    sharpest: f64,
    widened: bool,
    /// Measurements in new poses.
    news: f64,
}

impl Default for Adaptation {
    fn default() -> Self {
        Adaptation { variance: None, backlog: 1.0, sharpest: 1.0, widened: false, news: 0.0 }
    }
}

impl Adaptation {
    /// Least variance to weigh the next measurement with, after a motion [m].
    ///
    /// A measurement counts once. While the robot stands still what is left of it is weighed, and then next to nothing:
    /// errors of the model do not average out where nothing moves.
    pub fn sharpest(&mut self, moved: f64, active_joints: usize, age: u64) -> f64 {
        let news = news(moved);
        // The torques of few joints over a small motion are smooth functions of as many angles: they tell a few
        // numbers. More samples of them would favour the places where torques depend least on the point.
        let fade = FEW_JOINTS
            .get(active_joints.saturating_sub(1))
            .map_or(1.0, |updates| updates / (updates + age as f64));
        self.backlog = (self.backlog + news * fade).min(fade);
        self.news += news;
        self.sharpest = self.noise();
        self.sharpest / self.backlog
    }

    /// Variance of the torques' error, in units of their noise.
    pub fn noise(&self) -> f64 {
        self.variance.unwrap_or(1.0)
    }

    /// Counts the present measurement as new.
    pub fn begin(&mut self) {
        self.backlog = 1.0;
    }

    /// Least share of effective particles.
    pub fn effective_share(&self) -> f64 {
        EFFECTIVE
    }

    /// Says with which variance the measurement was weighed.
    pub fn weighed(&mut self, variance: f64) {
        self.widened = variance * self.backlog > WIDENED * self.sharpest;
        self.backlog = (self.backlog - self.sharpest / variance).max(0.0);
    }

    /// Takes in the squared torque that the best particle leaves over, in units of the noise, and how many joints feel
    /// the contact.
    pub fn learn(&mut self, left: f64, active_joints: usize) {
        // One degree of freedom is the force's.
        let freedom = active_joints.saturating_sub(1).max(1) as f64;
        let found = (left / freedom).clamp(1.0, MOST_VARIANCE);
        self.variance = Some(match self.variance {
            Some(variance) => variance + NEWEST * (found - variance),
            None => found,
        });
    }

    /// How far copies are moved apart [m].
    pub fn apart(&self, spread: f64) -> f64 {
        let share = APART[usize::from(self.widened)];
        (share * spread).clamp(LEAST_APART, MOST_APART)
    }

    /// How much an error of torques is averaged out by the motions so far: errors of a model never are altogether.
    pub fn averaged(&self) -> f64 {
        1.0 / (1.0 + self.news.min(AVERAGED)).sqrt()
    }

    /// Share of particles to draw anew from the whole surface, by the part of the torque that is left over.
    pub fn fresh_share(left: f64) -> f64 {
        let [least, most] = FRESH;
        least + (most - least) * ((left - 0.1) / 0.4).clamp(0.0, 1.0)
    }
}
