//! The velocities of a log as the fit takes them: on time and without noise, as no control loop can have them.

use super::log::Log;
use crate::robot::Robot;

/// Half the time over which velocities are averaged (s): noise of differenced encoder counts goes, motion of up to 20 rad/s
/// stays to a per cent.
const HALF_WIDTH: f64 = 0.01;

/// The mean velocity from `HALF_WIDTH` before each row to as long after, taken from so much later as velocities are late.
pub(super) fn smooth_velocity(robot: &Robot, log: &Log<'_>, delay: f64, step: f64) -> Vec<f64> {
    let nv = robot.nv();
    let longest = super::LONGEST_STEPS * step;
    let mut smooth = Vec::with_capacity(log.v.len());
    // The stretch without a gap that a row is in, and the rows around it.
    let (mut from, mut to) = (0, 0);
    let (mut first, mut last) = (0, 0);
    for row in 0..log.len() {
        if row >= to {
            from = row;
            let gap = |k: &usize| log.time[*k] - log.time[*k - 1] > longest;
            to = (row + 1..log.len()).find(gap).unwrap_or(log.len());
            (first, last) = (from, from);
        }
        // A window that is cut off on one side is cut off on the other: its middle stays.
        let middle = (log.time[row] + delay).min(log.time[to - 1]);
        let width = HALF_WIDTH.min(middle - log.time[from]).min(log.time[to - 1] - middle);
        while last < to && log.time[last] <= middle + width {
            last += 1;
        }
        while log.time[first] < middle - width && first + 1 < last {
            first += 1;
        }
        let shift = middle - (first..last).map(|k| log.time[k]).sum::<f64>() / (last - first) as f64;
        let rate = slope(log, nv, (first.saturating_sub(1)).max(from)..(last + 1).min(to));
        for j in 0..nv {
            let mean = (first..last).map(|k| log.v[k * nv + j]).sum::<f64>() / (last - first) as f64;
            // Rows are not where the window's middle is.
            smooth.push(mean + shift * rate(j));
        }
    }
    smooth
}

/// The mean rate of each velocity over some rows.
fn slope<'a>(log: &Log<'a>, nv: usize, rows: std::ops::Range<usize>) -> impl Fn(usize) -> f64 + use<'a> {
    let (first, last) = (rows.start, rows.end - 1);
    let duration = log.time[last] - log.time[first];
    let v = log.v;
    move |j| if duration > 0.0 { (v[last * nv + j] - v[first * nv + j]) / duration } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::Stream;

    fn worst(step: f64, delay: f64, noise: f64) -> f64 {
        let robot = Robot::example_arm();
        let time: Vec<f64> =
            (0..4000).map(|k| f64::from(k) * step).filter(|t| !(1.0..1.5).contains(t)).collect();
        let stream = Stream::new(1);
        let late = |(k, t): (usize, &f64)| {
            let v = (5.0 * (t - delay)).sin() + noise * stream.normals(2 * k as u64)[0];
            [v; 7]
        };
        let v: Vec<f64> = time.iter().enumerate().flat_map(late).collect();
        let log = Log { time: &time, q: &v, v: &v, tau: &v };
        let smooth = smooth_velocity(&robot, &log, delay, step);
        let error = |k: usize| (smooth[7 * k] - (5.0 * time[k]).sin()).abs();
        let near_end = |t: f64| t > time[time.len() - 1] - 0.05 || (0.95..1.0).contains(&t);
        (0..time.len()).filter(|k| !near_end(time[*k])).map(error).fold(0.0, f64::max)
    }

    #[test]
    fn velocities_come_on_time_at_any_rate() {
        assert!(worst(1e-3, 0.0, 0.0) < 1e-3);
        assert!(worst(1e-3, 0.0047, 0.0) < 1e-3);
        assert!(worst(1.0 / 30.0, 0.012, 0.0) < 0.01);
    }

    #[test]
    fn noise_is_averaged() {
        assert!(worst(1e-3, 0.003, 0.02) < 0.02);
    }
}
