//! The step between two positions that an encoder counts, as a log shows it.

use super::delay::displacement;
use super::log::Log;
use crate::robot::Robot;

/// Smaller differences are rounding (rad; m).
const ROUNDING: f64 = 1e-9;

/// The smallest change of each joint's position from row to row, `(nv,)` (rad; m): the step of what counts positions, and next to
/// nothing of exact ones. Zero of a joint that never moves.
pub(super) fn position_steps(robot: &Robot, log: &Log<'_>) -> Vec<f64> {
    let step = |(kind, idx_q): (_, usize)| {
        let change = |row: usize| {
            let [before, now] = [row - 1, row].map(|row| &log.q_of(robot, row)[idx_q..]);
            displacement(kind, now, before).abs()
        };
        let smallest =
            (1..log.len()).map(change).filter(|change| *change > ROUNDING).fold(f64::INFINITY, f64::min);
        if smallest.is_finite() {
            smallest
        } else {
            0.0
        }
    };
    robot.bodies[1..].iter().map(|body| step((body.kind, body.idx_q))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counted_positions_show_their_step() {
        let robot = Robot::example_arm();
        let rows = 3000;
        let time: Vec<f64> = (0..rows).map(|k| 1e-3 * k as f64).collect();
        for step in [0.0, 5e-5, 1e-3] {
            let position = |t: f64, j: usize| {
                let exact = (2.0 * t + j as f64).sin();
                if step > 0.0 {
                    (exact / step).round() * step
                } else {
                    exact
                }
            };
            // The last joint stands.
            let q: Vec<f64> = time
                .iter()
                .flat_map(|t| (0..7).map(move |j| if j < 6 { position(*t, j) } else { 0.3 }))
                .collect();
            let (v, tau) = (vec![0.0; 7 * rows], vec![0.0; 7 * rows]);
            let found = position_steps(&robot, &Log { time: &time, q: &q, v: &v, tau: &tau });
            assert!(found[..6].iter().all(|found| (found - step).abs() < 1e-5), "{found:?}");
            assert_eq!(found[6], 0.0);
        }
    }
}
