//! A torque behind observers, and the covariance of its errors.

use super::free_directions::{level_shares, FreeDirections};
use super::friction_errors::FrictionErrors;
use super::payload_errors::PayloadErrors;
use super::slow_errors::SlowErrors;
use super::velocity_covariance::VelocityCovariance;
use super::white_noise::{WhiteNoise, WhiteShares};
use super::whitening::Whitening;
use crate::observer::Order;
use crate::torque::ErrorVariances;

/// A covariance is worked out anew at once where white noise has changed by more than this factor since.
const STALE: f64 = 1.1;

/// A torque behind observers of one gain a joint, and its covariance.
#[derive(Debug, Clone)]
pub(super) struct Signal {
    /// Of each joint, or of all where the gains are equal.
    white: Vec<WhiteNoise>,
    /// Variance of the torque's white noise in a sample, by velocity variable.
    of_sample: Vec<f64>,
    /// What the observer leaves of the variance of each error, by velocity variable; of the velocities' as a root. White noise
    /// is that of the covariance in the making.
    torque: Vec<f64>,
    velocity: Vec<f64>,
    model: Vec<f64>,
    friction: Vec<f64>,
    /// White noise of the covariance in the making, and of the complete one.
    growing: Vec<WhiteShares>,
    complete: Vec<WhiteShares>,
    whitening: Whitening,
    /// By how much variances can be larger than those of the complete covariance.
    growth: f64,
    /// That the statistic exceeds at the chosen rate of false alarms.
    pub level: f64,
    /// The level of Gaussian errors.
    pub gaussian_level: f64,
    /// Of the level, where directions are taken away, by their number.
    shares: Vec<f64>,
    pub statistic: f64,
}

impl Signal {
    /// Torques behind observers of a gain each (1/s).
    pub fn new(
        variances: &ErrorVariances,
        gain: &[f64],
        order: Order,
        dt: f64,
        level: f64,
        gaussian_level: f64,
    ) -> Self {
        let by_joint = |share: &dyn Fn(usize) -> f64| (0..gain.len()).map(share).collect::<Vec<f64>>();
        let alike = gain.windows(2).all(|pair| pair[0] == pair[1]);
        let distinct = if alike { gain.len().min(1) } else { gain.len() };
        let white: Vec<WhiteNoise> =
            gain[..distinct].iter().map(|gain| variances.white_noise(*gain, dt, order)).collect();
        let shares: Vec<WhiteShares> = white.iter().map(WhiteNoise::shares).collect();
        Signal {
            of_sample: variances.torque.clone(),
            torque: vec![0.0; gain.len()],
            velocity: vec![0.0; gain.len()],
            model: by_joint(&|j| order.slow_share(gain[j], variances.slow.model_time[j])),
            friction: by_joint(&|j| variances.friction[j] * FrictionErrors::response(gain[j], order)),
            growing: shares.clone(),
            complete: shares,
            white,
            whitening: Whitening::new(gain.len()),
            growth: 1.0,
            level,
            gaussian_level,
            shares: level_shares(gain.len(), gaussian_level),
            statistic: 0.0,
        }
    }

    /// A step of the observer, of a length (s); none where it keeps its torque. `moving` is the share of the velocities'
    /// noise that the robot's motion allows.
    #[inline]
    pub fn advance(&mut self, length: Option<f64>, moving: f64) {
        self.white.iter_mut().for_each(|white| white.advance(length, moving));
        self.compare();
    }

    fn compare(&mut self) {
        let now = self.white.iter().map(WhiteNoise::shares);
        self.growth = now.zip(&self.complete).map(|(now, then)| now.growth(*then)).fold(1.0, f64::max);
    }

    /// Whether white noise is another than that of the complete covariance.
    #[inline]
    pub fn stale(&self) -> bool {
        let fallen = |(then, white): (&WhiteShares, &WhiteNoise)| then.growth(white.shares()) > STALE;
        self.growth > STALE || self.complete.iter().zip(&self.white).any(fallen)
    }

    /// A tick's work on the covariance; true where it is complete.
    #[inline]
    pub fn whiten(
        &mut self,
        velocity: &VelocityCovariance,
        slow: &SlowErrors,
        friction: &FrictionErrors,
        payload: &PayloadErrors,
    ) -> bool {
        if self.whitening.at_start() {
            self.take_shares();
        }
        let Signal { whitening, torque, velocity: root, model, friction: of_friction, .. } = self;
        let shares = friction.shares();
        let complete = whitening.advance(|i, row| {
            for ((value, product), other) in row.iter_mut().zip(velocity.row(i)).zip(&*root) {
                *value = product * root[i] * other;
            }
            row[i] += torque[i] + slow.variance(i, model[i]) + of_friction[i] * shares[i];
            slow.of_model().add_to_row(i, row);
            if payload.any() {
                payload.add_to_row(i, row);
            }
        });
        if complete {
            self.complete.copy_from_slice(&self.growing);
            self.compare();
        }
        complete
    }

    /// The white noise of now is that of the next covariance: one of several steps would be none of any torque.
    fn take_shares(&mut self) {
        for (growing, white) in self.growing.iter_mut().zip(&self.white) {
            *growing = white.shares();
        }
        let shares = self.growing.iter().cycle();
        let shares = shares.map(|shares| (shares.torque, shares.velocity.sqrt()));
        let entries = self.torque.iter_mut().zip(&mut self.velocity).zip(&self.of_sample);
        for (((torque, velocity), of_sample), (share, root)) in entries.zip(shares) {
            (*torque, *velocity) = (of_sample * share, root);
        }
    }

    /// Compares a torque without bias with its errors; what is in free directions does not count.
    #[inline]
    pub fn evaluate(&mut self, torque: &mut [f64], which: usize, free: Option<&mut FreeDirections>) {
        let statistic = match free {
            Some(free) => {
                let (left, taken) = free.leave(which, &mut self.whitening, torque);
                left / self.shares[taken]
            }
            None => self.whitening.squared_norm(torque),
        };
        self.statistic = statistic / self.growth;
    }

    /// The statistic of a torque without bias.
    #[inline]
    pub fn squared_norm(&mut self, torque: &[f64]) -> f64 {
        self.whitening.squared_norm(torque) / self.growth
    }

    /// The standard deviation of each torque (Nm).
    pub fn deviations(&self) -> impl Iterator<Item = f64> + Clone + '_ {
        let growth = self.growth.sqrt();
        self.whitening.deviations().iter().map(move |deviation| growth * deviation)
    }

    /// The variance of joint `j` without that of slow errors.
    pub fn fast_variance(&self, j: usize, velocity: &VelocityCovariance, friction: &FrictionErrors) -> f64 {
        let shares = self.white[j.min(self.white.len() - 1)].shares();
        let white = self.of_sample[j] * shares.torque + velocity.row(j)[j] * shares.velocity;
        white + self.friction[j] * friction.shares()[j]
    }

    /// What the observer leaves of the variance of joint `j`'s slow errors.
    pub fn model_share(&self, j: usize) -> f64 {
        self.model[j]
    }

    pub fn whitening_mut(&mut self) -> &mut Whitening {
        &mut self.whitening
    }

    /// The next covariance is worked out at once.
    pub fn restart(&mut self) {
        self.whitening.reset();
    }

    /// Forgets all steps.
    pub fn reset(&mut self) {
        self.statistic = 0.0;
        self.whitening.reset();
        self.white.iter_mut().for_each(WhiteNoise::reset);
        self.compare();
    }
}
