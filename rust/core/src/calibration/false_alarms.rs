//! Levels of the statistic of detection that contact-free motion exceeds at the chosen rate.

use super::{Calibration, Tail};
use crate::detection::{gaussian_level, Level, GAINS, LARGEST_STEP};

/// The lowest level, as a share of the level of Gaussian noise: a log holds less than later motion, so its tail lowers the
/// level only so far.
const LOWEST: f64 = 0.5;

impl Calibration {
    /// Levels for a bank of observers called every `dt` (s), of those gains that the log could judge; the rate of false alarms
    /// is shared between them. Empty where `dt` is too long for all of them.
    pub(crate) fn levels(&self, nv: usize, dt: f64) -> Vec<Level> {
        let known: Vec<f64> = match &self.tails[..] {
            [] => GAINS.to_vec(),
            tails => tails.iter().map(|tail| tail.gain).collect(),
        };
        let gains: Vec<f64> =
            known.into_iter().filter(|gain| self.torque_is_external || gain * dt <= LARGEST_STEP).collect();
        let rate = self.false_alarms_per_hour / gains.len() as f64;
        let level = |gain: f64| {
            let gaussian = gaussian_level(nv, gain, dt, rate);
            let shown =
                self.tails.iter().find(|tail| tail.gain == gain).map_or(gaussian, |tail| tail.at(rate));
            Level { gain, level: shown.max(LOWEST * gaussian), gaussian }
        };
        gains.into_iter().map(level).collect()
    }

    /// The level for the torque of one observer of a gain a joint (1/s): errors widen it as much as at the worst of the gains
    /// that the log judged.
    pub(crate) fn level_at(&self, nv: usize, gain: &[f64], dt: f64) -> Level {
        let rate = self.false_alarms_per_hour;
        let fastest = gain.iter().copied().fold(0.0, f64::max);
        let gaussian = gaussian_level(nv, fastest, dt, rate);
        let widened = |tail: &Tail| tail.at(rate) / gaussian_level(nv, tail.gain, dt, rate);
        let widest = self.tails.iter().map(widened).fold(1.0, f64::max);
        Level { gain: fastest, level: gaussian * widest, gaussian }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;

    #[test]
    fn the_level_is_what_the_log_shows_and_no_less_than_half_of_the_gaussian_one() {
        let described = Calibration::of_description(&Robot::example_arm());
        let with = |level: f64, scale: f64| {
            let tails = vec![Tail { gain: 8.0, level, scale }, Tail { gain: 50.0, level, scale }];
            Calibration { tails, ..described.clone() }.levels(7, 1e-3)
        };
        let gaussian = with(1.0, 1e-3)[0].gaussian;
        let tail_at = |level: f64, scale: f64| {
            Tail { gain: 8.0, level, scale }.at(0.5 * described.false_alarms_per_hour)
        };
        let lowest = 0.5 * gaussian;
        for (level, scale, expected) in [
            (60.0, 2.0, tail_at(60.0, 2.0)),
            (1.0, 1e-3, lowest),
            (10.0, 1.5, tail_at(10.0, 1.5)),
            (200.0, 1.0, tail_at(200.0, 1.0)),
        ] {
            let found = with(level, scale)[0];
            assert!((found.level - expected).abs() < 1e-9 && found.gaussian == gaussian, "{level}");
        }
        let without = Calibration { tails: vec![], ..described }.levels(7, 1e-3);
        assert!(without.len() == 3 && without.iter().all(|level| level.level == level.gaussian));
    }
}
