//! A log as diagnosis reads it: averaged to a rate that the robot's motion needs, with the time between rows.

use super::time_step::time_scale;
use crate::robot::configuration::spread_torque;
use crate::robot::{JointKind, Robot};

/// Rows are averaged until they are this far apart (s): motion is far slower, and noise and work become less.
const AVERAGED_STEP: f64 = 5e-3;

/// Share of the motion of the positions that the velocities explain in consecutive rows.
const CONSECUTIVE: f64 = 0.8;

/// Velocities times time differ from the changes of positions by at most this factor, or one of them is wrong.
const LARGEST_RATIO: f64 = 2.0;

/// Averages of fewer rows say nothing of motion.
const LEAST_AVERAGES: usize = 10;

/// The step of a row is estimated anew where that leaves this share of the misfit: stamps of real logs jitter.
const JITTERS: f64 = 0.5;

/// A step is between nothing and so many times the usual one; more is a gap in the log.
const LONGEST_STEP: f64 = 5.0;

/// A log with the joints' positions as plain angles.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    pub time: Vec<f64>,
    pub q: Vec<f64>,
    /// `(n, nv)` each, row by row; of a floating base zeros.
    pub angle: Vec<f64>,
    pub v: Vec<f64>,
    pub tau: Vec<f64>,
    pub nv: usize,
    /// Whether the rows follow each other in time.
    pub consecutive: bool,
    /// Whether the time between rows was estimated from positions and velocities.
    pub retimed: bool,
    /// The time of the rows before that.
    pub stamps: Vec<f64>,
}

impl Motion {
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Seconds in all.
    pub fn duration(&self) -> f64 {
        self.time.last().unwrap_or(&0.0) - self.time.first().unwrap_or(&0.0)
    }

    /// Whether no joint changes its position.
    pub fn stands_still(&self) -> bool {
        /// Less is the noise of encoders (rad; m).
        const STILL: f64 = 0.01;
        let range = |k: usize| {
            let values = self.angle.iter().skip(k).step_by(self.nv);
            let (least, most) =
                values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
            most - least
        };
        (0..self.nv).all(|k| range(k) < STILL)
    }

    /// The usual time between rows (s).
    pub fn step(&self) -> f64 {
        median(self.time.windows(2).map(|pair| pair[1] - pair[0]).collect())
    }

    /// The motion of a checked log; without `time` the step follows from positions and velocities.
    pub fn new(robot: &Robot, time: Option<&[f64]>, q: &[f64], v: &[f64], tau: &[f64]) -> Motion {
        let (nq, nv) = (robot.nq(), robot.nv());
        let n = v.len() / nv.max(1);
        let mut motion = Motion {
            time: vec![],
            q: q.to_vec(),
            angle: angles(robot, q, n),
            v: v.to_vec(),
            tau: vec![0.0; n * nv],
            nv,
            consecutive: false,
            retimed: false,
            stamps: vec![],
        };
        let width = tau.len().checked_div(n).unwrap_or(0);
        for (row, out) in tau.chunks_exact(width.max(1)).zip(motion.tau.chunks_exact_mut(nv.max(1))) {
            spread_torque(row, out);
        }
        let (scale, agreement) = time_scale(nv, &motion.angle, &motion.v, time);
        let fits = if time.is_some() { ratio_fits(scale) } else { scale > 0.0 };
        motion.consecutive = agreement > CONSECUTIVE && fits && n >= 2;
        motion.time = match time {
            Some(time) => time.to_vec(),
            None => {
                let step = if motion.consecutive { scale } else { 1.0 };
                (0..n).map(|row| row as f64 * step).collect()
            }
        };
        if motion.consecutive {
            motion.consecutive = motion.average(robot, nq);
        }
        if motion.consecutive {
            motion.retime();
        }
        motion
    }

    /// Whether every joint's torque is the same in all rows.
    pub fn torque_is_constant(&self) -> bool {
        let first = &self.tau[..self.nv.min(self.tau.len())];
        self.tau.chunks_exact(self.nv.max(1)).all(|row| row == first)
    }

    /// Seconds in all of rows that follow each other in time.
    pub fn seconds(robot: &Robot, time: Option<&[f64]>, q: &[f64], v: &[f64]) -> Option<f64> {
        let n = v.len() / robot.nv().max(1);
        let (scale, agreement) = time_scale(robot.nv(), &angles(robot, q, n), v, time);
        let seconds = time.map_or(scale * n as f64, |time| time[n - 1] - time[0]);
        (agreement > CONSECUTIVE && scale > 0.0).then_some(seconds)
    }

    /// By how much changes of positions differ from velocities times time, where they follow them but for a factor that no
    /// log of a robot has.
    pub fn odd_ratio(robot: &Robot, time: &[f64], q: &[f64], v: &[f64]) -> Option<f64> {
        let n = v.len() / robot.nv().max(1);
        let (scale, agreement) = time_scale(robot.nv(), &angles(robot, q, n), v, Some(time));
        (agreement > CONSECUTIVE && !ratio_fits(scale)).then_some(scale)
    }

    /// By how much changes of positions differ from velocities times time.
    pub fn slope(robot: &Robot, time: Option<&[f64]>, q: &[f64], v: &[f64]) -> f64 {
        let nv = robot.nv();
        let n = v.len() / nv.max(1);
        if q.len() != n * robot.nq() || time.is_some_and(|time| time.len() != n) {
            return 1.0;
        }
        time_scale(nv, &angles(robot, q, n), v, time).0
    }

    /// Means over so many rows that they are [`AVERAGED_STEP`] apart; whether enough are left.
    fn average(&mut self, robot: &Robot, nq: usize) -> bool {
        let step = self.step();
        let block = ((AVERAGED_STEP / step).round() as usize).max(1);
        if self.len() / block < LEAST_AVERAGES || step.is_nan() || step <= 0.0 {
            return false;
        }
        if block == 1 {
            return true;
        }
        let mean = |values: &[f64], width: usize| -> Vec<f64> {
            let blocks = values.chunks_exact(width * block);
            blocks
                .flat_map(|rows| {
                    (0..width).map(move |k| {
                        rows.chunks_exact(width).map(|row| row[k]).sum::<f64>() / (rows.len() / width) as f64
                    })
                })
                .collect()
        };
        self.time = mean(&self.time, 1);
        self.angle = mean(&self.angle, self.nv);
        self.v = mean(&self.v, self.nv);
        self.tau = mean(&self.tau, self.nv);
        self.q = mean(&self.q, nq);
        self.q.chunks_exact_mut(nq).for_each(|q| normalise(robot, q));
        true
    }

    /// The step of each row from positions and velocities, where those of the stamps fit badly.
    pub fn retime(&mut self) {
        self.stamps.clone_from(&self.time);
        let moving = self.moving_joints();
        if moving.len() < 2 || self.len() < 3 {
            return;
        }
        let usual = self.step();
        let (mut stamped, mut estimated) = (0.0, 0.0);
        let mut steps = Vec::with_capacity(self.len() - 1);
        for row in 1..self.len() {
            let given = self.time[row] - self.time[row - 1];
            let (mut along, mut square, mut misfit) = (0.0, 0.0, 0.0);
            for &(k, weight) in &moving {
                let (dq, v) = self.change(row, k);
                along += weight * dq * v;
                square += weight * v * v;
                misfit += weight * (dq - v * given).powi(2);
            }
            // A tenth of the usual speed says little of the time.
            let damped = square + 0.01 * moving.len() as f64 * usual.powi(-2);
            let step = (given + (along - square * given) / damped).clamp(1e-3 * usual, LONGEST_STEP * usual);
            let step = if given > LONGEST_STEP * usual { given } else { step };
            stamped += misfit;
            for &(k, weight) in &moving {
                let (dq, v) = self.change(row, k);
                estimated += weight * (dq - v * step).powi(2);
            }
            steps.push(step);
        }
        if estimated < JITTERS * JITTERS * stamped {
            self.retimed = true;
            let mut time = self.time[0];
            for (row, step) in steps.iter().enumerate() {
                time += step;
                self.time[row + 1] = time;
            }
        }
    }

    /// The same with the rows at the times of their stamps.
    pub fn on_its_stamps(&self) -> Motion {
        Motion { time: self.stamps.clone(), retimed: false, ..self.clone() }
    }

    /// The change of a position up to a row, and the mean velocity meanwhile.
    pub fn change(&self, row: usize, k: usize) -> (f64, f64) {
        let (now, before) = (row * self.nv + k, (row - 1) * self.nv + k);
        (self.angle[now] - self.angle[before], 0.5 * (self.v[now] + self.v[before]))
    }

    /// Joints that move, with the inverse square of the size of their steps.
    pub fn moving_joints(&self) -> Vec<(usize, f64)> {
        let n = (self.len().max(2) - 1) as f64;
        let square = |k: usize| (1..self.len()).map(|row| self.change(row, k).0.powi(2)).sum::<f64>() / n;
        let squares: Vec<f64> = (0..self.nv).map(square).collect();
        let largest = squares.iter().fold(0.0_f64, |a, b| a.max(*b));
        let moves = |k: &usize| squares[*k] > 1e-4 * largest && squares[*k] > 0.0;
        (0..self.nv).filter(moves).map(|k| (k, 1.0 / squares[k])).collect()
    }

    /// Values at another time than the rows', by linear interpolation.
    pub fn shifted(&self, values: &[f64], later: f64) -> Vec<f64> {
        let (n, nv) = (self.len(), self.nv);
        let mut out = values.to_vec();
        let mut place = 0;
        for row in 0..n {
            let wanted = (self.time[row] + later).clamp(self.time[0], self.time[n - 1]);
            while place + 2 < n && self.time[place + 1] < wanted {
                place += 1;
            }
            while place > 0 && self.time[place] > wanted {
                place -= 1;
            }
            if n < 2 {
                continue;
            }
            let share = (wanted - self.time[place]) / (self.time[place + 1] - self.time[place]);
            for k in 0..nv {
                let (a, b) = (values[place * nv + k], values[(place + 1) * nv + k]);
                out[row * nv + k] = a + share * (b - a);
            }
        }
        out
    }
}

/// Whether velocities times time are about the changes of positions.
fn ratio_fits(scale: f64) -> bool {
    (1.0 / LARGEST_RATIO..=LARGEST_RATIO).contains(&scale)
}

/// The joints' positions as numbers without jumps, `(n, nv)`.
fn angles(robot: &Robot, q: &[f64], n: usize) -> Vec<f64> {
    let (nq, nv) = (robot.nq(), robot.nv());
    let mut angles = vec![0.0; n * nv];
    for body in &robot.bodies[1..] {
        for row in 0..n {
            let q = &q[row * nq..][body.idx_q..];
            let angle = match body.kind {
                JointKind::Revolute | JointKind::Prismatic => q[0],
                JointKind::Continuous => {
                    let angle = q[1].atan2(q[0]);
                    let before = if row == 0 { angle } else { angles[(row - 1) * nv + body.idx_v] };
                    let turn = std::f64::consts::TAU;
                    angle + turn * ((before - angle) / turn).round()
                }
                JointKind::FreeFlyer => continue,
            };
            angles[row * nv + body.idx_v] = angle;
        }
    }
    angles
}

/// Means of unit vectors are shorter than those.
fn normalise(robot: &Robot, q: &mut [f64]) {
    for body in &robot.bodies[1..] {
        let part = match body.kind {
            JointKind::Continuous => &mut q[body.idx_q..body.idx_q + 2],
            JointKind::FreeFlyer => &mut q[body.idx_q + 3..body.idx_q + 7],
            _ => continue,
        };
        let norm = part.iter().map(|x| x * x).sum::<f64>().sqrt();
        if norm > 0.0 {
            part.iter_mut().for_each(|x| *x /= norm);
        }
    }
}

pub(super) fn median(mut values: Vec<f64>) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A log of the example arm: every joint on a sine of its own.
    pub(in crate::diagnosis) fn sines(step: f64, rows: usize) -> (Vec<f64>, Vec<f64>, Vec<f64>, Vec<f64>) {
        let robot = Robot::example_arm();
        let (mut time, mut q, mut v, mut tau) = (vec![], vec![], vec![], vec![]);
        for row in 0..rows {
            let t = row as f64 * step;
            time.push(t);
            let rate = |k: usize| 1.0 + 0.3 * k as f64;
            let at = |f: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
                (0..7).map(|k| f(rate(k), rate(k) * t + k as f64)).collect()
            };
            let here = at(&|_, phase| 0.6 * phase.sin());
            let speed = at(&|rate, phase| 0.6 * rate * phase.cos());
            let change = at(&|rate, phase| -0.6 * rate * rate * phase.sin());
            tau.extend(robot.inverse_dynamics(&here, &speed, &change).unwrap());
            q.extend(here);
            v.extend(speed);
        }
        (time, q, v, tau)
    }

    #[test]
    fn the_step_follows_from_positions_and_velocities() {
        let robot = Robot::example_arm();
        let (_, q, v, tau) = sines(2e-3, 3000);
        let motion = Motion::new(&robot, None, &q, &v, &tau);
        assert!(motion.consecutive && !motion.retimed);
        assert!((motion.duration() - 6.0).abs() < 0.02);
        // Rows in another order do not follow each other.
        let shuffled = |values: &[f64]| -> Vec<f64> {
            (0..3000).flat_map(|row| values[row * 1009 % 3000 * 7..][..7].to_vec()).collect()
        };
        let motion = Motion::new(&robot, None, &shuffled(&q), &shuffled(&v), &shuffled(&tau));
        assert!(!motion.consecutive);
    }

    #[test]
    fn stamps_that_jitter_are_mended() {
        let robot = Robot::example_arm();
        let (time, q, v, tau) = sines(1e-2, 1500);
        let stamps: Vec<f64> =
            time.iter().enumerate().map(|(row, t)| t + 4e-3 * (row as f64 * 2.4).sin()).collect();
        let motion = Motion::new(&robot, Some(&stamps), &q, &v, &tau);
        assert!(motion.retimed);
        let worst = motion.time.windows(2).map(|pair| (pair[1] - pair[0] - 1e-2).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-3, "{worst}");
    }
}
