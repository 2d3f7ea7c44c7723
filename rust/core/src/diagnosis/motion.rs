//! A log as diagnosis reads it: averaged to a rate that the robot's motion needs, with the time between rows.

use crate::robot::configuration::spread_torque;
use crate::robot::{JointKind, Robot};

/// Rows are averaged until they are this far apart (s): motion is far slower, and noise and work become less.
const AVERAGED_STEP: f64 = 5e-3;

/// Share of the motion of the positions that the velocities explain in consecutive rows.
const CONSECUTIVE: f64 = 0.8;

/// Rows over which positions are compared with velocities: noise of single rows then matters little.
const STRIDES: usize = 400;

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
        };
        let width = if n == 0 { 0 } else { tau.len() / n };
        for (row, out) in tau.chunks_exact(width.max(1)).zip(motion.tau.chunks_exact_mut(nv.max(1))) {
            spread_torque(row, out);
        }
        let (scale, agreement) = time_scale(&motion, time);
        motion.consecutive = agreement > CONSECUTIVE && (time.is_some() || scale > 0.0);
        motion.time = match time {
            Some(time) => time.to_vec(),
            None => {
                let step = if motion.consecutive { scale } else { 1.0 };
                (0..n).map(|row| row as f64 * step).collect()
            }
        };
        if motion.consecutive {
            motion.average(robot, nq);
            motion.retime();
        }
        motion
    }

    /// By how much changes of positions differ from velocities times time.
    pub fn slope(robot: &Robot, time: Option<&[f64]>, q: &[f64], v: &[f64]) -> f64 {
        let nv = robot.nv();
        let n = v.len() / nv.max(1);
        if q.len() != n * robot.nq() || time.is_some_and(|time| time.len() != n) {
            return 1.0;
        }
        let motion = Motion {
            time: vec![],
            q: vec![],
            angle: angles(robot, q, n),
            v: v.to_vec(),
            tau: vec![],
            nv,
            consecutive: false,
            retimed: false,
        };
        time_scale(&motion, time).0
    }

    /// Means over so many rows that they are [`AVERAGED_STEP`] apart.
    fn average(&mut self, robot: &Robot, nq: usize) {
        let step = self.step();
        let block = ((AVERAGED_STEP / step).round() as usize).max(1);
        if block == 1 || step.is_nan() || step <= 0.0 {
            return;
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
    }

    /// The step of each row from positions and velocities, where those of the stamps fit badly.
    fn retime(&mut self) {
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

/// How many units of time a row takes (of `time`, else of one a row), and the share of the motion that this explains.
fn time_scale(motion: &Motion, time: Option<&[f64]>) -> (f64, f64) {
    let nv = motion.nv;
    let n = motion.v.len() / nv.max(1);
    let stride = (n / STRIDES).max(1);
    if n < 3 {
        return (0.0, 0.0);
    }
    let mut pairs: Vec<(f64, f64)> = vec![];
    for k in 0..nv {
        let mut of_joint = vec![];
        for start in (0..n - stride).step_by(stride) {
            let way: f64 = (start..start + stride)
                .map(|row| {
                    let step = time.map_or(1.0, |time| time[row + 1] - time[row]);
                    0.5 * step * (motion.v[row * nv + k] + motion.v[(row + 1) * nv + k])
                })
                .sum();
            of_joint.push((motion.angle[(start + stride) * nv + k] - motion.angle[start * nv + k], way));
        }
        let size = (of_joint.iter().map(|pair| pair.0 * pair.0).sum::<f64>() / of_joint.len() as f64).sqrt();
        if size > 1e-9 {
            pairs.extend(of_joint.iter().map(|(dq, way)| (dq / size, way / size)));
        }
    }
    slope(&pairs)
}

/// The slope of a line through zero that a few outliers do not turn, and the share of the rest that it explains.
fn slope(pairs: &[(f64, f64)]) -> (f64, f64) {
    let mut kept: Vec<(f64, f64)> = pairs.to_vec();
    let mut slope = 0.0;
    let mut share = 0.0;
    for _ in 0..4 {
        let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
        for (y, x) in &kept {
            xy += x * y;
            xx += x * x;
            yy += y * y;
        }
        if xx <= 0.0 || yy <= 0.0 {
            return (0.0, 0.0);
        }
        slope = xy / xx;
        share = xy * xy / (xx * yy);
        let mut misfits: Vec<f64> = pairs.iter().map(|(y, x)| (y - slope * x).abs()).collect();
        misfits.sort_by(f64::total_cmp);
        // The worst tenth may be gaps.
        let limit = 2.0 * misfits[misfits.len() * 9 / 10] + 1e-12;
        kept = pairs.iter().copied().filter(|(y, x)| (y - slope * x).abs() <= limit).collect();
    }
    (slope, share)
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
