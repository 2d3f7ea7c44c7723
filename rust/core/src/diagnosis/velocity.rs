//! Velocities against positions: late, or low-passed. No model of the robot is needed.

use super::finding::{FaultCode, Finding};
use super::motion::{median, Motion};

/// Velocities are compared over windows of so many seconds: noise of positions then matters little.
const WINDOW: f64 = 0.03;

/// Time constant of the smoothing of positions and velocities (s).
const SMOOTHING: f64 = 0.03;

/// Delays that are tried first (s).
const COARSE: [f64; 16] =
    [-0.06, -0.04, -0.03, -0.02, -0.01, -0.005, 0.0, 0.005, 0.01, 0.02, 0.03, 0.04, 0.06, 0.08, 0.1, 0.15];

/// Time constants of low-passes that are tried first (s).
const TIME_CONSTANTS: [f64; 9] = [0.003, 0.006, 0.01, 0.016, 0.024, 0.032, 0.045, 0.064, 0.1];

/// What is left unexplained must become less by this share.
const LEAST_SHARE: f64 = 0.1;

/// At the times of the stamps a lag explains this share of what the velocities miss; if not, the stamps jitter.
const RATHER_THAN_JITTER: f64 = 0.3;

/// A lag that is at least this share of another one is about the same.
const AGREES: f64 = 0.75;

/// Delays that are worth a word, and that spoil the detection of contacts (s).
const WORTH_A_WORD: f64 = 4e-3;
const SPOILING: f64 = 8e-3;

/// A low-pass rather than a delay must leave only this share of what the delay leaves, ...
const RATHER: f64 = 0.965;
/// ... and this share where stamps may jitter: a low-pass smooths their jitter, a delay does not.
const RATHER_ON_STAMPS: f64 = 0.25;

/// Halvings of the distance between what is tried: from 10 ms to a tenth of a millisecond.
const REFINEMENTS: usize = 7;

/// Low-passes of velocities: one pole, two equal poles, Butterworth's two.
const DAMPINGS: [Option<f64>; 3] = [None, Some(1.0), Some(std::f64::consts::FRAC_1_SQRT_2)];

/// What velocities may have gone through.
#[derive(Debug, Clone, Copy)]
enum Lag {
    Delay(f64),
    LowPass { time: f64, damping: Option<f64> },
}

/// Finds a lag of the velocities, and takes it out of them.
pub(super) fn lag(motion: &mut Motion) -> Option<Finding> {
    let seen = likeliest(motion, RATHER);
    let stamped = on_stamps(motion, seen.map(|(lag, _)| lag));
    let (lag, share) = stamped.as_ref().map(|(_, lag, share)| (*lag, *share)).or(seen)?;
    let (finding, seconds) = described(lag);
    if share < LEAST_SHARE || seconds < WORTH_A_WORD {
        return None;
    }
    match stamped {
        Some((stamped, ..)) => {
            *motion = stamped;
            take_out(motion, lag);
            motion.retime();
        }
        None => take_out(motion, lag),
    }
    Some(finding.explaining(share).major_if(seconds > SPOILING))
}

fn take_out(motion: &mut Motion, lag: Lag) {
    match lag {
        Lag::Delay(seconds) => motion.v = motion.shifted(&motion.v, seconds),
        Lag::LowPass { .. } => motion.v = slopes(motion),
    }
}

/// A lag that makes the estimate of the time between rows needless, with the motion at the times of the stamps.
///
/// Where all joints speed up and slow down together, steps of time that are free make up for any lag. Where they do not,
/// the lag `seen` with these steps is about the same, and known better.
fn on_stamps(motion: &Motion, seen: Option<Lag>) -> Option<(Motion, Lag, f64)> {
    if !motion.retimed {
        return None;
    }
    let stamped = motion.on_its_stamps();
    let (lag, share) = likeliest(&stamped, RATHER_ON_STAMPS)?;
    let agree = seen.is_some_and(|seen| lateness(seen) / lateness(lag) > AGREES);
    (share > RATHER_THAN_JITTER && !agree).then_some((stamped, lag, share))
}

/// The lag that explains the velocities best, and the share of the misfit that it explains; a low-pass where it leaves
/// less than `rather` of what a delay leaves.
fn likeliest(motion: &Motion, rather: f64) -> Option<(Lag, f64)> {
    let plain = misfit(motion, Lag::Delay(0.0))?;
    let delays = COARSE.map(Lag::Delay);
    let (delay, by_delay) = refined(motion, &delays)?;
    let passes = DAMPINGS.iter().filter_map(|damping| {
        let tried = TIME_CONSTANTS.map(|time| Lag::LowPass { time, damping: *damping });
        refined(motion, &tried)
    });
    let (pass, by_pass) = passes.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (lag, left) = if by_pass < rather * by_delay { (pass, by_pass) } else { (delay, by_delay) };
    Some((lag, 1.0 - left / plain))
}

/// A lag in words, and its time (s).
fn described(lag: Lag) -> (Finding, f64) {
    match lag {
        Lag::Delay(seconds) => {
            let text = if seconds > 0.0 {
                format!("the velocity is {:.0} ms later than the position", 1e3 * seconds)
            } else {
                format!("the position is {:.0} ms later than the velocity", -1e3 * seconds)
            };
            (Finding::new(FaultCode::Delay, text).sized(seconds, "s"), seconds.abs())
        }
        Lag::LowPass { time, damping } => {
            let cutoff = 1.0 / (std::f64::consts::TAU * time);
            let order = if damping.is_some() { "second" } else { "first" };
            let text =
                format!("the velocity is low-passed at {cutoff:.1} Hz ({order} order), the position is not");
            (Finding::new(FaultCode::Filtered, text).sized(cutoff, "Hz"), time)
        }
    }
}

/// The best of what is tried, refined between its neighbours, with its misfit.
fn refined(motion: &Motion, tried: &[Lag]) -> Option<(Lag, f64)> {
    let mut all: Vec<(Lag, f64)> =
        tried.iter().filter_map(|lag| Some((*lag, misfit(motion, *lag)?))).collect();
    for _ in 0..REFINEMENTS {
        let best = (0..all.len()).min_by(|a, b| all[*a].1.total_cmp(&all[*b].1))?;
        let mut between = vec![];
        for other in [best.checked_sub(1), Some(best + 1)].into_iter().flatten() {
            if let Some((lag, _)) = all.get(other) {
                between.push(middle(all[best].0, *lag));
            }
        }
        for lag in between {
            all.push((lag, misfit(motion, lag)?));
        }
        all.sort_by(|a, b| size(a.0).total_cmp(&size(b.0)));
    }
    all.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))
}

fn size(lag: Lag) -> f64 {
    match lag {
        Lag::Delay(seconds) => seconds,
        Lag::LowPass { time, .. } => time,
    }
}

/// The mean delay (s).
fn lateness(lag: Lag) -> f64 {
    match lag {
        Lag::Delay(seconds) => seconds,
        Lag::LowPass { time, damping } => time * damping.map_or(1.0, |damping| 2.0 * damping),
    }
}

fn middle(a: Lag, b: Lag) -> Lag {
    match (a, b) {
        (Lag::LowPass { time, damping }, Lag::LowPass { time: other, .. }) => {
            Lag::LowPass { time: (time * other).sqrt(), damping }
        }
        _ => Lag::Delay(0.5 * (size(a) + size(b))),
    }
}

/// Mean square of what velocities do not explain of the changes of positions, which a lag was taken out of; relative.
fn misfit(motion: &Motion, lag: Lag) -> Option<f64> {
    let nv = motion.nv;
    let moving = motion.moving_joints();
    let angle = match lag {
        Lag::Delay(seconds) => motion.shifted(&motion.angle, -seconds),
        Lag::LowPass { time, damping } => passed(motion, &motion.angle, time, damping),
    };
    // A lag that smooths the noise of positions would have an advantage; smoothed once more, it has none.
    let angle = passed(motion, &angle, SMOOTHING, None);
    let v = passed(motion, &motion.v, SMOOTHING, None);
    let window = ((WINDOW / motion.step()).round() as usize).max(1);
    // At both ends delays are extrapolated and low-passes not settled.
    let edge = motion.time[0] + 0.6;
    let end = motion.time[motion.len() - 1] - 0.2;
    let mut squares = vec![];
    for first in (0..motion.len().saturating_sub(window)).step_by(window) {
        let last = first + window;
        if motion.time[first] < edge || motion.time[last] > end {
            continue;
        }
        let (mut along, mut square) = (0.0, 0.0);
        let pairs: Vec<(f64, f64)> = moving
            .iter()
            .map(|&(k, weight)| {
                let way: f64 = (first..last)
                    .map(|row| {
                        let step = motion.time[row + 1] - motion.time[row];
                        0.5 * step * (v[row * nv + k] + v[(row + 1) * nv + k])
                    })
                    .sum();
                let root = weight.sqrt();
                (root * (angle[last * nv + k] - angle[first * nv + k]), root * way)
            })
            .collect();
        for (dq, way) in &pairs {
            along += way * (dq - way);
            square += way * way;
        }
        // Steps that were estimated are free: only what no step explains counts.
        let stretch = if motion.retimed {
            along / (square + 0.01 * (window * window * pairs.len()) as f64)
        } else {
            0.0
        };
        squares.extend(pairs.iter().map(|(dq, way)| (dq - way * (1.0 + stretch)).powi(2)));
    }
    if squares.len() < 20 {
        return None;
    }
    // Rows lost or repeated are no lag: misfits count up to a limit.
    let limit = 25.0 * median(squares.clone());
    Some(squares.iter().map(|square| square.min(limit)).sum::<f64>() / squares.len() as f64)
}

/// Values low-passed as velocities may have been; `damping` of a second-order filter.
fn passed(motion: &Motion, values: &[f64], time: f64, damping: Option<f64>) -> Vec<f64> {
    let nv = motion.nv;
    let mut out = values.to_vec();
    for k in 0..nv {
        let (mut y, mut rate) = (values[k], 0.0);
        for row in 1..motion.len() {
            let step = motion.time[row] - motion.time[row - 1];
            let (a, b) = (values[(row - 1) * nv + k], values[row * nv + k]);
            let parts = ((8.0 * step / time).ceil() as usize).clamp(1, 200);
            let h = step / parts as f64;
            for part in 0..parts {
                let input = a + (b - a) * (part as f64 + 0.5) / parts as f64;
                match damping {
                    None => y = input + (y - input) * (-h / time).exp(),
                    Some(damping) => {
                        // Implicit in the rate, so that any step is stable.
                        let w = h / time;
                        rate = (rate + w * (input - y) / time) / (1.0 + 2.0 * damping * w + w * w);
                        y += h * rate;
                    }
                }
            }
            out[row * nv + k] = y;
        }
    }
    out
}

/// Velocities from positions alone.
fn slopes(motion: &Motion) -> Vec<f64> {
    let (n, nv) = (motion.len(), motion.nv);
    let mut v = motion.v.clone();
    for row in 0..n {
        let (before, after) = (row.saturating_sub(1), (row + 1).min(n - 1));
        let time = motion.time[after] - motion.time[before];
        if time <= 0.0 {
            continue;
        }
        for k in 0..nv {
            v[row * nv + k] = (motion.angle[after * nv + k] - motion.angle[before * nv + k]) / time;
        }
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::motion::tests::sines;
    use crate::robot::Robot;

    fn motion() -> Motion {
        let (time, q, v, tau) = sines(1e-2, 2000);
        Motion::new(&Robot::example_arm(), Some(&time), &q, &v, &tau)
    }

    #[test]
    fn velocities_in_time_have_no_lag() {
        assert_eq!(lag(&mut motion()), None);
    }

    #[test]
    fn late_velocities_are_found_and_mended() {
        let mut late = motion();
        late.v = late.shifted(&late.v, -0.025);
        let found = lag(&mut late).expect("a lag");
        assert_eq!(found.code, FaultCode::Delay);
        assert!((found.value.unwrap() - 0.025).abs() < 1e-3, "{found}");
        assert_eq!(lag(&mut late), None);
    }

    /// All joints speed up and slow down together, as when a robot moves from pose to pose.
    fn together() -> Motion {
        let (step, rows) = (1e-2, 2000);
        let (mut time, mut q, mut v) = (vec![], vec![], vec![]);
        for row in 0..rows {
            let t = row as f64 * step;
            // A cycloid in every second, to and fro.
            let (second, part) = (t.floor(), std::f64::consts::TAU * t.fract());
            let way = (part - part.sin()) / std::f64::consts::TAU;
            let forth = if second % 2.0 == 0.0 { 1.0 } else { -1.0 };
            let along = if forth > 0.0 { way } else { 1.0 - way };
            let size = |k: usize| 0.3 + 0.1 * k as f64;
            time.push(t);
            q.extend((0..7).map(|k| size(k) * along));
            v.extend((0..7).map(|k| size(k) * forth * (1.0 - part.cos())));
        }
        let tau = vec![0.0; v.len()];
        Motion::new(&Robot::example_arm(), Some(&time), &q, &v, &tau)
    }

    #[test]
    fn late_velocities_are_no_jitter_of_stamps() {
        let on_time = together();
        assert_eq!(lag(&mut together()), None);
        for delay in [0.02, 0.05, -0.02] {
            let mut late = on_time.on_its_stamps();
            late.v = late.shifted(&late.v, -delay);
            late.retime();
            // Free steps of time would explain it just as well.
            assert!(late.retimed);
            let found = lag(&mut late).expect("a lag");
            assert_eq!(found.code, FaultCode::Delay);
            assert!((found.value.unwrap() - delay).abs() < 1e-3, "{found}");
            let steps = late.time.windows(2).map(|pair| pair[1] - pair[0]);
            let worst = steps.map(|step| (step - 1e-2).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-3, "{worst}");
        }
    }

    #[test]
    fn filtered_velocities_are_told_from_late_ones() {
        let mut filtered = motion();
        filtered.v = passed(&filtered, &filtered.v, 0.032, None);
        let found = lag(&mut filtered).expect("a lag");
        assert_eq!((found.code, found.unit.as_str()), (FaultCode::Filtered, "Hz"));
        assert!((found.value.unwrap() - 5.0).abs() < 0.5, "{found}");
    }
}
