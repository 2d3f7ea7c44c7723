//! A motion as a chain of moves, each a smooth function of time.

use crate::robot::{JointKind, Robot};

/// A sine of one joint within a move.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Wave {
    /// rad or m.
    pub amplitude: f64,
    /// rad/s.
    pub frequency: f64,
    /// rad.
    pub phase: f64,
}

impl Wave {
    pub const NONE: Wave = Wave { amplitude: 0.0, frequency: 0.0, phase: 0.0 };
}

/// Sines of each joint.
pub(super) const WAVES: usize = 2;

/// A move from rest to rest: along a straight line of joint positions, with sines added that fade in and out.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Move {
    pub start: f64,
    pub duration: f64,
    pub from: Vec<f64>,
    pub travel: Vec<f64>,
    /// One a joint.
    pub waves: Vec<[Wave; WAVES]>,
}

/// A value and its first two derivatives by time.
type Jet = [f64; 3];

/// Of the way from 0 to 1 within a second, without velocity and acceleration at its ends (a polynomial of degree 5).
fn way(x: f64) -> Jet {
    let (x2, rest) = (x * x, 1.0 - x);
    [x * x2 * (10.0 - 15.0 * x + 6.0 * x2), 30.0 * x2 * rest * rest, 60.0 * x * rest * (1.0 - 2.0 * x)]
}

/// Largest velocity and acceleration of [`way`].
pub(super) const WAY_PEAKS: [f64; 2] = [1.875, 5.7736];

/// Fades sines in and out: `(4 x (1 - x))^3`, whose first two derivatives are zero at both ends.
fn window(x: f64) -> Jet {
    let u = 4.0 * x * (1.0 - x);
    let slope = 4.0 * (1.0 - 2.0 * x);
    [u * u * u, 3.0 * u * u * slope, 6.0 * u * slope * slope - 24.0 * u * u]
}

/// Bounds of the first two derivatives of [`window`].
pub(super) const WINDOW_PEAKS: [f64; 2] = [3.44, 24.0];

impl Move {
    /// Where all joints stand still.
    pub fn rest(from: &[f64], duration: f64) -> Self {
        let joints = from.len();
        Move {
            start: 0.0,
            duration,
            from: from.to_vec(),
            travel: vec![0.0; joints],
            waves: vec![[Wave::NONE; WAVES]; joints],
        }
    }

    /// Position, velocity and acceleration of a joint, `time` after the move's start.
    pub fn joint(&self, joint: usize, time: f64) -> Jet {
        if self.duration <= 0.0 {
            return [self.from[joint], 0.0, 0.0];
        }
        let x = (time / self.duration).clamp(0.0, 1.0);
        let rate = 1.0 / self.duration;
        let [s, ds, dds] = way(x);
        let travel = self.travel[joint];
        let mut jet = [self.from[joint] + travel * s, travel * ds * rate, travel * dds * rate * rate];
        let [w, dw, ddw] = window(x);
        let (dw, ddw) = (dw * rate, ddw * rate * rate);
        for wave in &self.waves[joint] {
            let (sin, cos) = (wave.frequency * x * self.duration + wave.phase).sin_cos();
            let (slope, bend) = (wave.frequency * cos, -wave.frequency * wave.frequency * sin);
            jet[0] += wave.amplitude * w * sin;
            jet[1] += wave.amplitude * (dw * sin + w * slope);
            jet[2] += wave.amplitude * (ddw * sin + 2.0 * dw * slope + w * bend);
        }
        jet
    }

    /// Where it ends.
    pub fn end(&self) -> Vec<f64> {
        self.from.iter().zip(&self.travel).map(|(from, travel)| from + travel).collect()
    }

    /// A bound of a joint's speed over the whole move.
    pub fn peak_speed(&self, joint: usize) -> f64 {
        let waves = self.waves[joint].iter();
        let waves =
            waves.map(|wave| wave.amplitude.abs() * (WINDOW_PEAKS[0] / self.duration + wave.frequency));
        self.travel[joint].abs() * WAY_PEAKS[0] / self.duration + waves.sum::<f64>()
    }

    /// The same with the lengths of all its ways times `share`, which keeps limits of velocity and acceleration.
    pub fn shrunk(&self, share: f64) -> Move {
        let mut smaller = self.clone();
        smaller.travel.iter_mut().for_each(|travel| *travel *= share);
        smaller.waves.iter_mut().flatten().for_each(|wave| wave.amplitude *= share);
        smaller
    }
}

/// A planned motion, sampled at equal distances of time: rows one after another.
///
/// ```
/// use contactsense::calibration::{exciting_motion, Excitation, Motion};
///
/// let robot = contactsense::robot::Robot::example_arm();
/// let Motion { time, q, .. } = exciting_motion(&robot, &Excitation::new(3.0))?;
/// assert_eq!(q.len(), 7 * time.len());
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Motion {
    /// Time of each row, `(n,)` (s).
    pub time: Vec<f64>,
    /// Configurations, `(n, nq)`.
    pub q: Vec<f64>,
    /// Velocities, `(n, nv)` (rad/s, m/s).
    pub v: Vec<f64>,
    /// Accelerations, `(n, nv)` (rad/s^2, m/s^2).
    pub a: Vec<f64>,
    /// Links, by name, whose distance to each other was not checked: neighbours, and those that cross in nearly all poses.
    pub unchecked: Vec<(String, String)>,
    pub(super) kinds: Vec<JointKind>,
    pub(super) moves: Vec<Move>,
}

impl Motion {
    pub(super) fn new(
        robot: &Robot,
        moves: Vec<Move>,
        rows: usize,
        dt: f64,
        unchecked: Vec<(String, String)>,
    ) -> Self {
        let kinds: Vec<JointKind> = robot.joint_kinds().collect();
        let mut motion = Motion { time: vec![], q: vec![], v: vec![], a: vec![], unchecked, kinds, moves };
        motion.time.reserve_exact(rows);
        motion.q.reserve_exact(rows * robot.nq());
        motion.v.reserve_exact(rows * robot.nv());
        motion.a.reserve_exact(rows * robot.nv());
        for row in 0..rows {
            let time = row as f64 * dt;
            let (mut q, mut v, mut a) = (vec![], vec![], vec![]);
            motion.write(time, [&mut q, &mut v, &mut a]);
            motion.time.push(time);
            motion.q.append(&mut q);
            motion.v.append(&mut v);
            motion.a.append(&mut a);
        }
        motion
    }

    /// Along a straight line from a checked configuration of a robot with a fixed base, from rest to rest. `step` is the way of
    /// each joint (rad, m). The distance of no two links is checked.
    pub(crate) fn line(robot: &Robot, q: &[f64], step: &[f64], duration: f64, dt: f64) -> Self {
        let mut part = Move::rest(&positions(robot, q), duration);
        part.travel.copy_from_slice(step);
        let rows = (duration / dt).round() as usize + 1;
        Motion::new(robot, vec![part], rows, dt, all_pairs(robot))
    }

    /// Without a row: the robot stays at a checked configuration.
    pub(crate) fn none(robot: &Robot, q: &[f64]) -> Self {
        Motion::new(robot, vec![Move::rest(&positions(robot, q), 0.0)], 0, 0.0, vec![])
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// How many configuration variables and velocity variables there are.
    pub fn joints(&self) -> (usize, usize) {
        (self.kinds.iter().map(|kind| kind.nq()).sum(), self.kinds.len())
    }

    /// Length (s).
    pub fn duration(&self) -> f64 {
        self.moves.last().map_or(0.0, |last| last.start + last.duration)
    }

    /// Configuration, velocity and acceleration at a time (s); before and after the motion, its ends at rest.
    pub fn at(&self, time: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let (mut q, mut v, mut a) = (vec![], vec![], vec![]);
        self.write(time, [&mut q, &mut v, &mut a]);
        (q, v, a)
    }

    fn write(&self, time: f64, [q, v, a]: [&mut Vec<f64>; 3]) {
        let after = self.moves.partition_point(|part| part.start <= time);
        let Some(part) = self.moves.get(after.saturating_sub(1)) else { return };
        for (joint, kind) in self.kinds.iter().enumerate() {
            let [position, velocity, acceleration] = part.joint(joint, time - part.start);
            push_position(*kind, position, q);
            v.push(velocity);
            a.push(acceleration);
        }
    }
}

/// Appends the configuration variables of a joint at a position.
fn push_position(kind: JointKind, position: f64, q: &mut Vec<f64>) {
    match kind {
        JointKind::Continuous => q.extend([position.cos(), position.sin()]),
        _ => q.push(position),
    }
}

/// The configuration of joint positions; the base is fixed.
pub(super) fn configuration(robot: &Robot, positions: impl IntoIterator<Item = f64>, q: &mut Vec<f64>) {
    q.clear();
    for (kind, position) in robot.joint_kinds().zip(positions) {
        push_position(kind, position, q);
    }
}

/// The inverse of [`configuration`]: the positions of a robot's joints, whose base is fixed.
fn positions(robot: &Robot, q: &[f64]) -> Vec<f64> {
    let mut positions = Vec::with_capacity(robot.nv());
    for body in &robot.bodies[1..] {
        positions.push(match body.kind {
            JointKind::Continuous => q[body.idx_q + 1].atan2(q[body.idx_q]),
            _ => q[body.idx_q],
        });
    }
    positions
}

/// Every two links with a surface.
fn all_pairs(robot: &Robot) -> Vec<(String, String)> {
    let names: Vec<&String> =
        robot.touchable_links().iter().map(|link| &robot.links()[link.get()].name).collect();
    let pairs = names
        .iter()
        .enumerate()
        .flat_map(|(k, first)| names[k + 1..].iter().map(move |second| (*first, *second)));
    pairs.map(|(first, second)| (first.clone(), second.clone())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Move {
        let wave = |amplitude, frequency, phase| Wave { amplitude, frequency, phase };
        Move {
            start: 0.0,
            duration: 2.5,
            from: vec![0.3],
            travel: vec![-1.2],
            waves: vec![[wave(0.2, 4.0, 0.3), wave(0.1, 7.0, 2.0)]],
        }
    }

    #[test]
    fn derivatives_are_those_of_the_position() {
        let (part, h) = (example(), 1e-4);
        for step in 1..50 {
            let time = 0.05 * f64::from(step);
            let [before, now, after] = [time - h, time, time + h].map(|time| part.joint(0, time));
            if step < 49 {
                assert!(((after[0] - before[0]) / (2.0 * h) - now[1]).abs() < 1e-5);
                assert!(((after[1] - before[1]) / (2.0 * h) - now[2]).abs() < 1e-5);
            }
            assert!(now[1].abs() <= part.peak_speed(0));
        }
    }

    #[test]
    fn it_starts_and_ends_at_rest() {
        let part = example();
        for time in [-1.0, 0.0, 2.5, 9.0] {
            let [position, velocity, acceleration] = part.joint(0, time);
            let wanted = if time > 1.0 { part.end()[0] } else { 0.3 };
            assert!(
                (position - wanted).abs() < 1e-12 && velocity.abs() < 1e-12 && acceleration.abs() < 1e-12
            );
        }
    }

    #[test]
    fn peaks_are_bounds() {
        for step in 0..=1000 {
            let x = f64::from(step) * 1e-3;
            for (jet, peaks) in [(way(x), WAY_PEAKS), (window(x), WINDOW_PEAKS)] {
                assert!(jet[1].abs() <= peaks[0] + 1e-9 && jet[2].abs() <= peaks[1] + 1e-9);
            }
        }
    }
}
