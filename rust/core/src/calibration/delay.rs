//! How late the measured velocity is against the measured position.

use super::log::Log;
use crate::robot::{JointKind, Robot};

/// Of the two low-passes that both sides go through (1/s): noise of differenced positions is far above.
const GAIN: f64 = 20.0;
/// At rows further apart they are slower: the largest step as a share of their time constant.
const LARGEST_STEP: f64 = 0.3;
/// So many time constants after a start both sides have forgotten it.
const SETTLED: f64 = 5.0;
/// A delay is one only if it is so many standard errors from none.
const SIGNIFICANT: f64 = 3.0;
/// Rows within this many time constants of the low-pass err together.
const TOGETHER: f64 = 2.0;

/// The delay (s) and its standard error; zero where none is seen.
pub(super) fn velocity_delay(robot: &Robot, log: &Log<'_>, step: f64) -> [f64; 2] {
    let nv = robot.nv();
    let gain = GAIN.min(LARGEST_STEP / step);
    // Of the rate of the positions and of the velocities: twice low-passed, and sums of the regression.
    let mut filters = vec![[0.0; 4]; nv];
    let mut sums = vec![[0.0; 3]; nv];
    let mut since = 0.0;
    for row in 1..log.len() {
        let dt = log.time[row] - log.time[row - 1];
        if dt > super::LONGEST_STEPS * step {
            filters.fill([0.0; 4]);
            since = 0.0;
            continue;
        }
        since += dt;
        let (q, before) = (log.q_of(robot, row), log.q_of(robot, row - 1));
        let (v, v_before) = (log.v_of(robot, row), log.v_of(robot, row - 1));
        let kept = (-gain * dt).exp();
        for (j, body) in robot.bodies[1..].iter().enumerate() {
            let rate = displacement(body.kind, &q[body.idx_q..], &before[body.idx_q..]) / dt;
            let [x1, x2, y1, y2] = &mut filters[j];
            *x1 = kept * *x1 + (1.0 - kept) * rate;
            *y1 = kept * *y1 + (1.0 - kept) * 0.5 * (v[j] + v_before[j]);
            *x2 = kept * *x2 + (1.0 - kept) * *x1;
            *y2 = kept * *y2 + (1.0 - kept) * *y1;
            let (change, late) = (gain * (*x1 - *x2), *x2 - *y2);
            if since > SETTLED / gain {
                let [xx, xy, yy] = &mut sums[j];
                *xx += change * change;
                *xy += change * late;
                *yy += late * late;
            }
        }
    }
    // Each joint by how well its delay is known.
    let rows = log.len() as f64 * (step * gain / TOGETHER).min(1.0);
    let (mut weight, mut sum) = (0.0, 0.0);
    for [xx, xy, yy] in sums {
        let left = (yy - xy * xy / f64::max(xx, f64::MIN_POSITIVE)).max(f64::MIN_POSITIVE);
        if xx > 0.0 {
            let information = xx * rows / left;
            weight += information;
            sum += information * xy / xx;
        }
    }
    if weight == 0.0 {
        return [0.0, f64::INFINITY];
    }
    let (delay, error) = (sum / weight, weight.sqrt().recip());
    [if delay > SIGNIFICANT * error { delay } else { 0.0 }, error]
}

/// How far a joint moved.
pub(super) fn displacement(kind: JointKind, q: &[f64], before: &[f64]) -> f64 {
    match kind {
        JointKind::Continuous => {
            let (cos, sin) = (q[0] * before[0] + q[1] * before[1], q[1] * before[0] - q[0] * before[1]);
            sin.atan2(cos)
        }
        _ => q[0] - before[0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_late_velocity_is_found() {
        let robot = Robot::example_arm();
        let (rows, step) = (5000, 1e-3);
        for late in [0.0, 0.004, 0.02] {
            let time: Vec<f64> = (0..rows).map(|k| k as f64 * step).collect();
            let each = |f: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
                time.iter().flat_map(|t| (0..7).map(move |j| f(*t, 1.0 + 0.5 * f64::from(j)))).collect()
            };
            let q = each(&|t, rate| (rate * t).sin());
            let v = each(&|t, rate| rate * (rate * (t - late)).cos());
            let log = Log { time: &time, q: &q, v: &v, tau: &v };
            let [found, _] = velocity_delay(&robot, &log, step);
            assert!((found - late).abs() < 3e-4, "{late}: {found}");
        }
    }
}
