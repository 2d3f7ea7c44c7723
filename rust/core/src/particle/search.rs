//! The search for the obstacle that explains a window best, a bounded number of steps an update.

use nalgebra::Vector3;

use super::contacts::{Contacts, Task};
use super::obstacle::{Obstacle, Residuals};
use super::window::POSES;
use crate::spatial::basis::across;

/// Steps an update from the obstacle that was found before, and from another start. With few poses a step costs less,
/// and more are taken, so that all is found as soon as the poses show it.
const STEPS: usize = 1;
const RIVAL_STEPS: usize = 3;
const MOST_STEPS: usize = 12;
/// Steps after which another start is given up: a fit that converges has done so.
const PATIENCE: usize = 12;
/// Starts: the best particle's obstacle, small and large ones at the estimated point, with radii of [m], and some so far beside
/// it [m], since the estimated point may be one of several that fit about as well.
const RADII: [f64; 2] = [0.01, 0.05];
const BESIDE: f64 = 0.03;
const SIDES: usize = 4;
/// A contact farther from the estimated one is another [m].
const APART: f64 = 0.05;

/// Where the estimated push is: its point and outward normal, world frame, the point in its link's frame, and the centre of the best
/// particle's obstacle, if it is on the same link, world frame [m].
#[derive(Debug, Clone, Copy)]
pub(super) struct EstimatedPush {
    pub point: Vector3<f64>,
    pub normal: Vector3<f64>,
    pub local: Vector3<f64>,
    pub centre: Option<Vector3<f64>>,
}

impl EstimatedPush {
    /// Whether contacts agree with it at the newest pose.
    pub fn agrees(&self, contacts: &Contacts) -> bool {
        (contacts.point - self.local).norm() <= APART
    }

    /// The centre to begin with at a turn.
    fn start(&self, turn: usize) -> Vector3<f64> {
        let first = across(&self.normal);
        let second = self.normal.cross(&first);
        let beside = |aside: Vector3<f64>| self.point + self.normal * BESIDE + aside * BESIDE;
        // The best particle knows more at every update.
        let particle = self.centre.filter(|_| turn.is_multiple_of(2));
        particle.unwrap_or_else(|| match turn / 2 % (RADII.len() + SIDES) {
            0 => self.point + self.normal * RADII[0],
            1 => self.point + self.normal * RADII[1],
            2 => beside(first),
            3 => beside(-first),
            4 => beside(second),
            _ => beside(-second),
        })
    }
}

/// A fit from another start.
#[derive(Debug, Clone)]
struct Rival {
    link: usize,
    obstacle: Obstacle,
    steps: usize,
}

/// Obstacles that are sought.
#[derive(Debug, Clone)]
pub(super) struct Search {
    /// The best one found, one a link: the estimated link may change and come back.
    found: Vec<Option<Obstacle>>,
    rival: Option<Rival>,
    /// Starts so far.
    turn: usize,
    residuals: Residuals,
}

impl Search {
    /// For so many links and joints.
    pub fn new(links: usize, joints: usize) -> Self {
        Search { found: vec![None; links], rival: None, turn: 0, residuals: Residuals::new(joints) }
    }

    /// Forgets all that was found.
    pub fn restart(&mut self) {
        self.found.fill(None);
        self.rival = None;
        self.turn = 0;
    }

    /// The contacts found on a link.
    pub fn contacts(&self, link: usize) -> Option<&Contacts> {
        self.found[link].as_ref().map(Obstacle::contacts)
    }

    /// A pose of the window was replaced by one that follows on another.
    pub fn follow(&mut self, pose: usize, before: usize) {
        for obstacle in self.found.iter_mut().flatten() {
            obstacle.follow(pose, before);
        }
        if let Some(rival) = &mut self.rival {
            rival.obstacle.follow(pose, before);
        }
    }

    /// Searches on, from other starts too until that is done; returns the contacts that fit best.
    pub fn improve(
        &mut self,
        task: &Task<'_>,
        estimated: &EstimatedPush,
        done: impl Fn(&Contacts) -> bool,
    ) -> &Contacts {
        let more = POSES / task.window.len().max(1);
        let found = self.found[task.link].get_or_insert_with(|| Obstacle::at(estimated.start(0)));
        for _ in 0..(STEPS * more).min(MOST_STEPS) {
            found.improve(task, &mut self.residuals);
        }
        if done(found.contacts()) {
            return found.contacts();
        }
        let kept = self.rival.take().filter(|rival| rival.link == task.link && rival.steps < PATIENCE);
        let mut rival = kept.unwrap_or_else(|| {
            self.turn += 1;
            Rival { link: task.link, obstacle: Obstacle::at(estimated.start(self.turn)), steps: 0 }
        });
        for _ in 0..(RIVAL_STEPS * more).min(MOST_STEPS) {
            let settled = rival.obstacle.improve(task, &mut self.residuals);
            rival.steps = if settled { PATIENCE } else { rival.steps + 1 };
            if settled {
                break;
            }
        }
        if rival.obstacle.contacts().misfit < found.contacts().misfit {
            std::mem::swap(found, &mut rival.obstacle);
            rival.steps = PATIENCE;
        }
        self.rival = Some(rival);
        found.contacts()
    }
}
