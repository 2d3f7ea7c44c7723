//! Which value of the statistic untouched motion exceeds at a chosen rate (algorithm D3).

use crate::math::bisection::last_where;
use crate::math::chi_square::{survival, LARGEST};

/// How often contact-free motion, on blocks of a log that were not fitted, made a statistic large: beyond `level` 0.8 times a
/// second, and more rarely by a factor of e for each `scale` more.
///
/// ```
/// use contactsense::calibration::Tail;
///
/// let tail = Tail { gain: 8.0, level: 12.0, scale: 3.0 };
/// assert!(tail.at(1.0) > tail.at(10.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Tail {
    /// Of the observer whose torques the statistic is of (1/s).
    pub gain: f64,
    /// The statistic that was exceeded 0.8 times a second.
    pub level: f64,
    /// By so much more at a rate that is a factor of e lower.
    pub scale: f64,
}

/// Time in which the largest value of the statistic counts as one peak (s).
pub(crate) const PEAK_TIME: f64 = 0.25;
/// Share of the peaks that a tail is fitted to.
pub(crate) const TAIL_SHARE: f64 = 0.2;
/// Rate of these peaks (1/s).
const PEAKS: f64 = TAIL_SHARE / PEAK_TIME;
/// Seconds of an hour.
const HOUR: f64 = 3600.0;

impl Tail {
    /// The statistic that is exceeded at a rate (1/h).
    pub fn at(&self, per_hour: f64) -> f64 {
        self.level + self.scale * (PEAKS * HOUR / per_hour).ln().max(0.0)
    }

    /// The tail of `degrees` Gaussian torques behind an observer of a `gain` (1/s), called every `dt` (s).
    pub(crate) fn gaussian(degrees: usize, gain: f64, dt: f64) -> Tail {
        let [peaks, hourly] = [PEAKS * HOUR, 1.0].map(|rate| gaussian_level(degrees, gain, dt, rate));
        Tail { gain, level: peaks, scale: (hourly - peaks) / (PEAKS * HOUR).ln() }
    }

    /// No lower than another tail of the same gain.
    pub(crate) fn at_least(self, other: Tail) -> Tail {
        Tail { level: self.level.max(other.level), scale: self.scale.max(other.scale), ..self }
    }

    /// The tail of the statistic's values that were the largest of [`PEAK_TIME`] each; none of too few.
    pub(crate) fn of_peaks(gain: f64, peaks: &mut [f64]) -> Option<Tail> {
        peaks.sort_by(f64::total_cmp);
        let first = ((1.0 - TAIL_SHARE) * peaks.len() as f64) as usize;
        let largest = peaks.get(first..).filter(|largest| largest.len() >= FEWEST_PEAKS)?;
        let others = (largest.len() - 1) as f64;
        let excess = largest.iter().map(|peak| peak - largest[0]).sum::<f64>() / others;
        // One standard deviation more: a scale that is too small costs more false alarms than one too large saves.
        Some(Tail { gain, level: largest[0], scale: excess * (1.0 + others.sqrt().recip()) })
    }
}

/// A mean of fewer is not known to a third.
const FEWEST_PEAKS: usize = 10;

/// The statistic of `degrees` Gaussian torques behind an observer of a `gain` (1/s), called every `dt` (s), that is exceeded
/// at a rate (1/h). It stays over a level `u` for about `1 / (gain u)`: the rate of a chi-square process whose correlation
/// falls off linearly is its probability times `gain u` (Pickands 1969; Adler and Taylor 2007, chapter 14), and
/// at most once a tick.
pub(crate) fn gaussian_level(degrees: usize, gain: f64, dt: f64, per_hour: f64) -> f64 {
    let rate = |level: f64| HOUR * survival(degrees, level) / (dt + 1.0 / (gain * level));
    last_where([degrees as f64, LARGEST], |level| rate(level) > per_hour)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::Stream;

    #[test]
    fn the_gaussian_tail_is_that_of_its_level() {
        for degrees in [2, 6, 7] {
            let tail = Tail::gaussian(degrees, 50.0, 1e-3);
            for per_hour in [0.1, 1.0, 30.0, 1e3] {
                let level = gaussian_level(degrees, 50.0, 1e-3, per_hour);
                assert!((tail.at(per_hour) / level - 1.0).abs() < 0.03, "{degrees} {per_hour}");
            }
            let shown = Tail { gain: 50.0, level: 1.0, scale: 10.0 };
            assert_eq!(shown.at_least(tail), Tail { scale: 10.0, ..tail });
        }
    }

    /// Three Gaussian torques behind a low-pass exceed the level as often as it says.
    #[test]
    fn a_level_is_exceeded_at_its_rate() {
        const DEGREES: usize = 3;
        let (gain, dt, hours) = (20.0_f64, 1e-3, 2.0);
        let noise = Stream::new(5);
        let decay = (-gain * dt).exp();
        let per_hour = 60.0;
        let level = gaussian_level(DEGREES, gain, dt, per_hour);
        let deviation = (0.5 * (1.0 - decay)).sqrt();
        let (mut torque, mut onsets, mut free_until) = ([0.0; DEGREES], 0, 0);
        let ticks = (hours * HOUR / dt) as u64;
        for tick in 0..ticks {
            for (j, torque) in torque.iter_mut().enumerate() {
                let white = noise.normals(2 * (DEGREES as u64 * tick + j as u64))[0];
                *torque = (1.0 - decay) * white + decay * *torque;
            }
            let statistic = torque.iter().map(|r| (r / deviation).powi(2)).sum::<f64>();
            // What goes on within a tenth of a second is one alarm.
            if statistic > level && tick > 100 {
                onsets += usize::from(tick >= free_until);
                free_until = tick + 100;
            }
        }
        let expected = per_hour * hours;
        let found = onsets as f64;
        assert!((0.6 * expected..1.4 * expected).contains(&found), "{found} instead of {expected}");
    }

    #[test]
    fn an_exponential_tail_is_found() {
        // Quantiles of an exponential distribution of scale 3.
        let mut peaks: Vec<f64> =
            (0..1000).map(|k| -3.0 * (1.0 - (f64::from(k) + 0.5) / 1000.0).ln()).collect();
        let tail = Tail::of_peaks(8.0, &mut peaks).expect("enough peaks");
        assert!(
            (tail.scale / (1.0 + 199.0_f64.sqrt().recip()) - 3.0).abs() < 0.1
                && (tail.level - 3.0 * 5.0_f64.ln()).abs() < 0.1,
            "{tail:?}"
        );
        assert_eq!(Tail::of_peaks(8.0, &mut [1.0; 20]), None);
    }
}
