//! The planning of a motion, move by move.

use super::clearance::Clearance;
use super::draw::{draw, redraw};
use super::information::{Gain, Information};
use super::limits::Limits;
use super::motion::{Motion, Move};
use super::Excitation;
use crate::error::{Error, Result};
use crate::math::random::Stream;
use crate::robot::Robot;

/// Lengths of a motion that can be planned (s).
const SECONDS: [f64; 2] = [1.0, 600.0];
/// Most rows of a motion.
const MOST_ROWS: f64 = 2e6;
/// Random moves of which the best one is improved, by as many attempts; the first number where there are many parameters.
const DRAWS: [u64; 2] = [3, 96];
/// Number of parameters up to which all are drawn (an arm of seven joints has 98); beyond, the work stays the same.
const FEW_PARAMETERS: f64 = 100.0;
/// How much of a move is tried where all of it is not clear.
const SHARES: [f64; 4] = [1.0, 0.6, 0.3, 0.1];
/// Where no move is clear, the robot waits so long (s) and tries others.
const WAIT: f64 = 0.1;
/// Less time than this is none (s).
const ROUNDING: f64 = 1e-9;
/// Random poses among which a clear one is looked for.
const POSES: u64 = 500;
/// Clear poses among which joints that are held find theirs.
const HELD_POSES: usize = 24;

/// Plans a motion, move by move, so that the caller can stop in between.
///
/// ```
/// use contactsense::calibration::{Excitation, ExcitationPlanner};
///
/// let robot = contactsense::robot::Robot::example_arm();
/// let mut planner = ExcitationPlanner::new(&robot, &Excitation::new(5.0))?;
/// while planner.advance() {}
/// let motion = planner.finish();
/// assert!((motion.duration() - 5.0).abs() < 1e-9);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ExcitationPlanner<'a> {
    robot: &'a Robot,
    limits: Limits,
    clearance: Clearance,
    information: Information,
    stream: Stream,
    moves: Vec<Move>,
    at: Vec<f64>,
    time: f64,
    rows: usize,
    dt: f64,
}

impl<'a> ExcitationPlanner<'a> {
    /// Finds where the motion starts.
    ///
    /// # Errors
    /// [`Error::Input`] names the argument that is wrong; it is `robot` where the base is free to move, where there is no joint,
    /// or where no pose is clear.
    pub fn new(robot: &'a Robot, wanted: &Excitation) -> Result<Self> {
        if robot.floating_base() {
            return Err(Error::input(
                "robot",
                "its base is free to move: joint positions alone do not say how it moves, nor whether it keeps its \
                 balance; give a robot with a fixed base, or one whose base is fixed to a stand",
            ));
        }
        robot.check_moves()?;
        let [shortest, longest] = SECONDS;
        if !(shortest..=longest).contains(&wanted.seconds) {
            let text = format!("must be from {shortest} to {longest} [s], not {}", wanted.seconds);
            return Err(Error::input("seconds", text));
        }
        let steps = wanted.seconds / wanted.dt;
        if !(wanted.dt > 0.0 && (1.0..MOST_ROWS).contains(&steps)) {
            let text = format!(
                "must be positive, at most seconds, and give at most {MOST_ROWS:.0} rows [s], not {}",
                wanted.dt
            );
            return Err(Error::input("dt", text));
        }
        let limits = Limits::new(robot, wanted)?;
        let stream = Stream::new(wanted.seed);
        let steps = steps.round();
        let mut planner = ExcitationPlanner {
            robot,
            clearance: Clearance::new(robot, &limits, stream.fork(0)),
            information: Information::new(robot, &limits, stream.fork(1)),
            limits,
            stream,
            moves: vec![],
            at: vec![],
            time: steps * wanted.dt,
            rows: steps as usize + 1,
            dt: wanted.dt,
        };
        planner.at = planner.start()?;
        Ok(planner)
    }

    /// Adds a move; false once the motion has its length.
    pub fn advance(&mut self) -> bool {
        let left = self.left();
        if left <= ROUNDING {
            return false;
        }
        let wait = Move::rest(&self.at, WAIT.min(left));
        let mut part = self.best(left).unwrap_or(wait);
        part.start = self.time - left;
        self.at = part.end();
        self.moves.push(part);
        true
    }

    /// The motion as far as it is planned.
    pub fn finish(self) -> Motion {
        let unchecked = self.clearance.unchecked(self.robot);
        Motion::new(self.robot, self.moves, self.rows, self.dt, unchecked)
    }

    /// Time without a move yet (s).
    fn left(&self) -> f64 {
        self.time - self.moves.last().map_or(0.0, |last| last.start + last.duration)
    }

    /// The best clear move of some random ones, and counts it as taken.
    fn best(&mut self, left: f64) -> Option<Move> {
        let stream = self.stream.fork(2).fork(self.moves.len() as u64);
        let mut drawn: Vec<(Move, Gain)> = vec![];
        for number in 0..self.draws() {
            let part = draw(&self.limits, stream.fork(number), &self.at, left);
            if let Some(gain) = self.information.gain(self.robot, &part) {
                drawn.push((part, gain));
            }
        }
        drawn.sort_by(|(_, one), (_, other)| one.rate.total_cmp(&other.rate));
        self.improve(&mut drawn, stream);
        for share in SHARES {
            for (part, _) in drawn.iter().rev() {
                let part = part.shrunk(share);
                if self.clearance.allows_move(self.robot, &part) {
                    if let Some(gain) = self.information.gain(self.robot, &part) {
                        self.information.add(gain);
                        return Some(part);
                    }
                }
            }
        }
        None
    }

    /// Appends better and better moves to those drawn, which are sorted: one joint after another does something else.
    fn improve(&mut self, drawn: &mut Vec<(Move, Gain)>, stream: Stream) {
        let draws = self.draws();
        for number in draws..2 * draws {
            let Some((best, best_gain)) = drawn.last() else { return };
            let part = redraw(&self.limits, stream.fork(number), best, number as usize % self.at.len());
            if let Some(gain) = self.information.gain(self.robot, &part) {
                if gain.rate > best_gain.rate {
                    drawn.push((part, gain));
                }
            }
        }
    }

    fn draws(&self) -> u64 {
        let [least, most] = DRAWS;
        let size = (FEW_PARAMETERS / self.information.parameters() as f64).min(1.0);
        ((most as f64 * size.powi(3)) as u64).max(least)
    }

    /// A clear pose: neutral or the middle of the ranges, else a random one; where joints are held, the one of some in
    /// which weights load the others most.
    fn start(&mut self) -> Result<Vec<f64>> {
        let held = self.limits.moves.contains(&false);
        let usual = [vec![0.0; self.robot.nv()], self.limits.middle()];
        let stream = self.stream.fork(3);
        let random = (0..POSES).map(|number| self.limits.random(&stream.fork(number)));
        let poses: Vec<Vec<f64>> = usual.into_iter().chain(random).collect();
        let mut best: Option<(f64, Vec<f64>)> = None;
        let mut found = 0;
        for pose in poses {
            if !self.limits.hold(&pose) || !self.clearance.allows_pose(self.robot, &pose) {
                continue;
            }
            let load = self.information.load(self.robot, &pose, &self.limits.moves);
            if best.as_ref().is_none_or(|(most, _)| load > *most) {
                best = Some((load, pose));
            }
            found += 1;
            if !held || found == HELD_POSES {
                break;
            }
        }
        let none = || {
            let text = format!(
                "no pose of {POSES} random ones within its limits is clear of collisions; check its surfaces"
            );
            Error::input("robot", text)
        };
        best.map(|(_, pose)| pose).ok_or_else(none)
    }
}
