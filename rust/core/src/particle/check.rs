//! Whether a single push on an obstacle that stays explains what was measured at the last poses.

use nalgebra::Vector3;

use super::contacts::{Contacts, Task};
use super::instant::Instant;
use super::options::{FilterOptions, Likelihood, Motion};
use super::push::Push;
use super::search::{EstimatedPush, Search};
use super::spring::Slope;
use super::weight;
use super::window::Window;
use crate::math::chi_square::upper_limit;
use crate::robot::Robot;

/// Errors of torque may be so many times as large as is stated [1].
const GRANTED: f64 = 3.0;
/// Parameters of a push at one pose: its force and two coordinates on the surface; of an obstacle: its centre.
const FITTED: usize = 3;
const CENTRE: usize = 3;
/// A slope of so many standard errors is none by chance (99.9 %).
const CONFIRMED: f64 = 3.0;
/// Without torques to spare the point can be chosen so that the force follows the motion, whatever the truth: then only
/// a far more exact slope confirms a push, of so many times the softest stiffness.
const EXACT: f64 = 10.0;
const CLEARLY_STIFFER: f64 = 3.0;
/// A stiffness is not in its range where even so many standard errors do not bring it there (99 %).
const EXCLUDED: f64 = 2.326;
/// Poses that are needed, with torques to spare and without.
const LEAST_POSES: usize = 4;
const LEAST_POSES_WITHOUT_SPARE: usize = 8;

/// A misfit below this share of the largest one needs no search for a better one.
const AMPLE: f64 = 0.25;

/// The test, and what it found at the last update.
#[derive(Debug, Clone)]
pub(super) struct Check {
    /// Torques that a push leaves over, one a velocity variable [Nm].
    left: Vec<f64>,
    window: Window,
    /// None where no obstacle is assumed.
    search: Option<Search>,
    /// Least and greatest stiffness of an obstacle [N/m].
    stiffness: [f64; 2],
    /// Direction of gravity, world frame; none without gravity.
    down: Option<Vector3<f64>>,
    explained: bool,
    trusted: bool,
}

impl Check {
    pub fn new(robot: &Robot, instant: &Instant, options: &FilterOptions) -> Self {
        // Only where an obstacle is assumed and its force is believed to follow the motion.
        let springy = options.motion == Motion::Curvature && options.likelihood == Likelihood::Gaussian;
        Check {
            left: vec![0.0; robot.nv()],
            window: Window::new(instant),
            search: springy.then(|| Search::new(robot.links().len(), robot.nv())),
            stiffness: options.stiffness_range,
            down: robot.gravity.try_normalize(0.0),
            explained: true,
            trusted: false,
        }
    }

    /// Forgets all poses: another contact is looked at.
    pub fn restart(&mut self) {
        self.window.clear();
        if let Some(search) = &mut self.search {
            search.restart();
        }
        (self.explained, self.trusted) = (true, false);
    }

    /// Takes in the estimated push, and another one that may fit better; returns the root mean square of the torques
    /// left over, in standard deviations of the stated noise.
    pub fn take_in(
        &mut self,
        robot: &Robot,
        push: &Push<'_>,
        other: Option<&Push<'_>>,
        estimated: &EstimatedPush,
    ) -> f64 {
        let own = self.left_over(push);
        let left = other.map_or(own, |other| self.left_over(other).min(own));
        let opened = self.window.take_in(push.instant, push.link, left);
        let torque = &push.instant.torque;
        if let (true, Some(search)) = (opened, &mut self.search) {
            search.follow(self.window.newest(), self.window.before());
        }
        let surface = robot.links()[push.link].surface.as_ref();
        (self.explained, self.trusted) = match (&mut self.search, surface) {
            (Some(search), Some(surface)) => {
                let Push { link, force_model, .. } = *push;
                let joints = torque.len();
                let task = Task { window: &self.window, link, surface, force_model, joints };
                let (explained, trusted) = judge(search, &task, estimated, self.stiffness);
                let down = self.down.filter(|_| trusted);
                let as_well = |down| {
                    weight::explains_as_well(&task, &push.instant.frames.wanted, &down, search.contacts(link))
                };
                (explained, trusted && !down.is_some_and(as_well))
            }
            _ => {
                let checks = self.window.len() * torque.len().saturating_sub(FITTED);
                let left: f64 = self.window.samples().iter().map(|sample| sample.left).sum();
                let explained = left <= tolerance(checks);
                (explained, explained)
            }
        };
        (left / torque.len() as f64).sqrt()
    }

    /// Squared norm of the torques that the best force of a push leaves over, each over its stated noise.
    fn left_over(&mut self, push: &Push<'_>) -> f64 {
        push.left_over(&mut self.left);
        self.left.iter().zip(&push.instant.stated).map(|(left, noise)| (left / noise).powi(2)).sum()
    }

    /// Whether a single push explains the last poses.
    pub fn explained(&self) -> bool {
        self.explained
    }

    /// Whether it is confirmed, too.
    pub fn trusted(&self) -> bool {
        self.trusted
    }
}

/// Whether one obstacle, of a stiffness in the range, explains all poses, and whether their motion confirms it.
fn judge(
    search: &mut Search,
    task: &Task<'_>,
    estimated: &EstimatedPush,
    [softest, stiffest]: [f64; 2],
) -> (bool, bool) {
    let poses = task.window.len();
    let chain = task.window.chain(task.link);
    // Each pose has a force of its own. The other joints are tested apart, lest many of them at rest hide a misfit.
    let limit = tolerance((poses * chain.saturating_sub(1)).saturating_sub(CENTRE));
    let others = tolerance(poses * task.joints.saturating_sub(chain));
    let (errors, least, enough) = if chain > FITTED {
        (CONFIRMED, softest, LEAST_POSES)
    } else {
        (EXACT, CLEARLY_STIFFER * softest, LEAST_POSES_WITHOUT_SPARE)
    };
    let too_soft = |slope: Slope| slope.value + EXCLUDED * slope.error < softest;
    let confirmed = |slope: Slope| {
        slope.value >= (errors * slope.error).max(least) && slope.value - EXCLUDED * slope.error <= stiffest
    };
    let fits = |contacts: &Contacts| contacts.misfit <= limit && contacts.others <= others;
    let trusted = |contacts: &Contacts| {
        poses >= enough
            && fits(contacts)
            && estimated.agrees(contacts)
            && Slope::of(contacts, poses).is_some_and(confirmed)
    };
    let done = |contacts: &Contacts| contacts.misfit <= AMPLE * limit && trusted(contacts);
    let contacts = search.improve(task, estimated, done);
    let explained = fits(contacts) && !Slope::of(contacts, poses).is_some_and(too_soft);
    (explained, trusted(contacts))
}

/// The largest misfit that errors explain, of so many redundant torques.
pub(super) fn tolerance(checks: usize) -> f64 {
    GRANTED * GRANTED * upper_limit(checks)
}
