//! Small motions under which no hypothesis loses the contact or presses too hard.

use super::obstacle::Obstacle;
use super::prediction::Prediction;
use crate::error::Result;
use crate::math::random::Stream;
use crate::robot::Robot;

/// Poses at which a motion is looked at, its end included: on the way the force may be greater than at the end.
const POSES: usize = 4;
/// The contact's depth errs by this (m), as in the filter's beliefs, and its stiffness is reckoned as this share greater.
const DEPTH_ERROR: f64 = 1e-4;
const STIFFNESS_MARGIN: f64 = 0.2;
/// A force that falls below this share of what it is now may be lost.
const LEAST_SHARE: f64 = 0.25;
/// Hypotheses that are less probable than this, all together, are not noticeable.
const NOTICEABLE: f64 = 0.04;
/// Forces that exceed the bound already are held to be impossible where they are less probable than this, all together: the
/// robot would not be where it is.
const EXCEEDED: f64 = 0.25;
/// Rounds in which a motion is drawn to the linear bounds, and the share of them that it is drawn to: the rest is for what is not linear.
const ROUNDS: usize = 40;
const INSIDE: f64 = 0.85;
/// A motion that is not admissible is shortened to this share, so often.
const SHORTER: f64 = 0.6;
const TRIES: usize = 8;

/// A motion under which the contact is kept.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    /// By velocity variable (rad, m).
    pub step: Vec<f64>,
    /// Where it ends.
    pub q: Vec<f64>,
    /// Least and greatest force on the way under the noticeable hypotheses (N).
    pub force: [f64; 2],
}

/// What an obstacle allows: `rate . step` (m) is how much deeper it gets, and stays within these.
struct Bound {
    rate: Vec<f64>,
    squared: f64,
    range: [f64; 2],
}

/// Draws motions from one configuration.
pub(super) struct Candidates<'a> {
    robot: &'a Robot,
    obstacles: &'a [Obstacle],
    limit: Limit,
    q: &'a [f64],
    /// How far each joint may go either way (rad, m).
    room: Vec<[f64; 2]>,
    bounds: Vec<Bound>,
    there: Prediction<'a>,
}

impl<'a> Candidates<'a> {
    /// `here` is the prediction at `q`.
    pub fn new(
        robot: &'a Robot,
        obstacles: &'a [Obstacle],
        here: &Prediction<'a>,
        q: &'a [f64],
        max_force: f64,
        max_step: &[f64],
    ) -> Self {
        let limit = Limit::new(obstacles, max_force);
        let bound = |obstacle: &Obstacle| {
            let touch = here.touch(obstacle, obstacle.triangle)?;
            let mut rate = vec![0.0; robot.nv()];
            here.add_unit_torque(obstacle.link, &touch, &mut rate);
            // The torque of the inward force is against the motion that presses.
            rate.iter_mut().for_each(|x| *x = -*x);
            let squared = rate.iter().map(|x| x * x).sum();
            let [low, high] = limit.allowed(obstacle);
            let stiffness = hardest(obstacle);
            let range = [(low - obstacle.force) / stiffness, (high - obstacle.force) / stiffness];
            let range =
                [INSIDE * (range[0] + DEPTH_ERROR).min(0.0), INSIDE * (range[1] - DEPTH_ERROR).max(0.0)];
            (squared > 0.0).then_some(Bound { rate, squared, range })
        };
        Candidates {
            robot,
            obstacles,
            limit,
            q,
            room: room(robot, q, max_step),
            bounds: obstacles.iter().filter_map(bound).collect(),
            there: here.clone(),
        }
    }

    /// A random motion; none where not even a short one is admissible.
    pub fn draw(&mut self, random: &Stream) -> Result<Option<Candidate>> {
        let mut step: Vec<f64> = (0..self.room.len())
            .map(|joint| {
                let [low, high] = self.room[joint];
                low + (high - low) * random.uniform(joint as u64)
            })
            .collect();
        self.draw_inside(&mut step);
        for _ in 0..TRIES {
            let q = self.robot.integrate(self.q, &step)?;
            if let Some(force) = self.kept(&step)? {
                return Ok(Some(Candidate { step, q, force }));
            }
            step.iter_mut().for_each(|x| *x *= SHORTER);
        }
        Ok(None)
    }

    /// Moves a step into the bounds of all obstacles, by projections onto one after another (Kaczmarz 1937, for half-spaces
    /// Agmon 1954).
    fn draw_inside(&self, step: &mut [f64]) {
        for _ in 0..ROUNDS {
            let mut inside = true;
            for Bound { rate, squared, range } in &self.bounds {
                let deeper: f64 = rate.iter().zip(&*step).map(|(rate, step)| rate * step).sum();
                let excess = deeper - deeper.clamp(range[0], range[1]);
                if excess != 0.0 {
                    inside = false;
                    step.iter_mut().zip(rate).for_each(|(step, rate)| *step -= excess / squared * rate);
                }
            }
            for (step, [low, high]) in step.iter_mut().zip(&self.room) {
                *step = step.clamp(*low, *high);
            }
            if inside {
                return;
            }
        }
    }

    /// Least and greatest force on the way; none where the contact may be lost, or pressed too hard.
    fn kept(&mut self, step: &[f64]) -> Result<Option<[f64; 2]>> {
        let mut triangles: Vec<Option<u32>> =
            self.obstacles.iter().map(|obstacle| obstacle.triangle).collect();
        let mut forces = vec![[f64::INFINITY, 0.0_f64]; self.obstacles.len()];
        let mut wrong = vec![false; self.obstacles.len()];
        let tolerated = (NOTICEABLE * self.obstacles.len() as f64) as usize;
        for pose in 1..=POSES {
            let share = pose as f64 / POSES as f64;
            let part: Vec<f64> = step.iter().map(|x| share * x).collect();
            self.there.move_to(&self.robot.integrate(self.q, &part)?);
            for (k, obstacle) in self.obstacles.iter().enumerate() {
                let Some(touch) = self.there.touch(obstacle, triangles[k]) else { continue };
                triangles[k] = touch.triangle;
                let stiffness = hardest(obstacle);
                let force = |deeper: f64| (obstacle.force + stiffness * deeper).max(0.0);
                let (least, most) = (force(touch.deeper - DEPTH_ERROR), force(touch.deeper + DEPTH_ERROR));
                let [low, high] = self.limit.allowed(obstacle);
                // Motion that neither presses nor pulls is always allowed.
                wrong[k] |= (least < low && touch.deeper < 0.0) || (most > high && touch.deeper > 0.0);
                let likely = (obstacle.force + obstacle.stiffness * touch.deeper).max(0.0);
                forces[k] = [forces[k][0].min(likely), forces[k][1].max(likely)];
            }
            if wrong.iter().filter(|wrong| **wrong).count() > tolerated {
                return Ok(None);
            }
        }
        let all = forces.iter().zip(&wrong).zip(self.obstacles);
        let kept = all.filter(|((_, wrong), obstacle)| !**wrong && self.limit.possible(obstacle));
        let kept = kept.map(|((force, _), _)| force);
        Ok(Some(kept.fold([f64::INFINITY, 0.0], |all, one| [all[0].min(one[0]), all[1].max(one[1])])))
    }
}

/// Which forces are allowed.
#[derive(Debug, Clone, Copy)]
struct Limit {
    /// N.
    max_force: f64,
    /// Whether it may be exceeded already.
    exceeded: bool,
}

impl Limit {
    fn new(obstacles: &[Obstacle], max_force: f64) -> Self {
        let over = obstacles.iter().filter(|obstacle| obstacle.force > max_force).count();
        Limit { max_force, exceeded: over as f64 > EXCEEDED * obstacles.len() as f64 }
    }

    /// Whether the present force of an obstacle is held to be possible.
    fn possible(&self, obstacle: &Obstacle) -> bool {
        self.exceeded || obstacle.force <= self.max_force
    }

    /// Least and greatest force that an obstacle may exert on the way (N): none greater than the bound, or than now where that is
    /// exceeded already.
    fn allowed(&self, obstacle: &Obstacle) -> [f64; 2] {
        let most = if self.possible(obstacle) { self.max_force.max(obstacle.force) } else { f64::INFINITY };
        [LEAST_SHARE * obstacle.force, most]
    }
}

/// The stiffness that is reckoned with (N/m).
fn hardest(obstacle: &Obstacle) -> f64 {
    obstacle.stiffness * (1.0 + STIFFNESS_MARGIN)
}

/// How far each velocity variable may go down and up (rad, m).
fn room(robot: &Robot, q: &[f64], max_step: &[f64]) -> Vec<[f64; 2]> {
    let mut room: Vec<[f64; 2]> = max_step.iter().map(|step| [-step, *step]).collect();
    for body in &robot.bodies[1..] {
        // A pair (cos, sin) has no limits.
        if body.kind.nq() == 1 {
            let [low, high] = &mut room[body.idx_v];
            let position = q[body.idx_q];
            *low = low.max(body.position_limits[0] - position).min(0.0);
            *high = high.min(body.position_limits[1] - position).max(0.0);
        }
    }
    room
}
