//! Errors of the model that a calibration's motion did not show: they change with pose and speed, and are large where the robot
//! was never seen.

use crate::robot::{Kinematics, Robot};
use crate::torque::ModelError;

/// What they were just before a contact is a mean over about so long (s).
const RECENT: f64 = 0.3;
/// Each joint's share of the errors that others do not tell: hysteresis and scales differ from joint to joint.
const OWN: f64 = 1.0;

/// Torques of errors of one standard deviation each, here and as far as the bias has followed them.
#[derive(Debug, Clone)]
pub(crate) struct ModelErrors {
    errors: Vec<ModelError>,
    nv: usize,
    /// By error, `(nv,)` each: at the pose (of a few ticks ago), in the bias, and just before a contact.
    torque: Vec<f64>,
    followed: Vec<f64>,
    recent: Vec<f64>,
    /// The error whose torque is next.
    next: usize,
    started: bool,
}

impl ModelErrors {
    /// Independent errors of a robot with `nv` velocity variables.
    pub fn new(errors: Vec<ModelError>, nv: usize) -> Self {
        let zeros = vec![0.0; errors.len() * nv];
        ModelErrors {
            errors,
            nv,
            torque: zeros.clone(),
            followed: zeros.clone(),
            recent: zeros,
            next: 0,
            started: false,
        }
    }

    /// A tick's work on a pose: the torque of one error; the first time, of all.
    #[inline]
    pub fn advance(&mut self, robot: &Robot, kinematics: &Kinematics, v: &[f64]) {
        let Self { errors, nv, torque, next, started, .. } = self;
        let count = if *started { errors.len().min(1) } else { errors.len() };
        for _ in 0..count {
            errors[*next].torque(robot, kinematics, v, &mut torque[*next * *nv..(*next + 1) * *nv]);
            *next = (*next + 1) % errors.len();
        }
        if !*started {
            self.recent.copy_from_slice(&self.torque);
        }
        self.started = true;
    }

    /// The bias of joint `j` takes over a share of the torque that is measured.
    #[inline]
    pub fn follow(&mut self, j: usize, share: f64) {
        let torque = self.torque.iter().skip(j).step_by(self.nv);
        let followed = self.followed.iter_mut().skip(j).step_by(self.nv);
        followed.zip(torque).for_each(|(followed, torque)| *followed += share * (torque - *followed));
    }

    /// The bias of joint `j` loses a share of what it is.
    #[inline]
    pub fn forget(&mut self, j: usize, share: f64) {
        self.followed.iter_mut().skip(j).step_by(self.nv).for_each(|followed| *followed *= 1.0 - share);
    }

    /// A step of `dt` (s) in which nothing touches the robot.
    #[inline]
    pub fn keep(&mut self, dt: f64) {
        let share = (dt / RECENT).min(1.0);
        let torque = self.recent.iter_mut().zip(&self.torque);
        torque.for_each(|(recent, torque)| *recent += share * (torque - *recent));
    }

    /// The bias is the torque that is measured.
    pub fn take(&mut self) {
        self.followed.copy_from_slice(&self.torque);
    }

    /// The variance of joint `j`'s torque: of all of it, of what the bias does not hold, and of what has changed since just
    /// before a contact.
    pub fn variance(&self, j: usize) -> f64 {
        self.torque.iter().skip(j).step_by(self.nv).map(|torque| torque * torque).sum()
    }

    /// The same of what the bias does not hold.
    pub fn unfollowed(&self, j: usize) -> f64 {
        self.less(&self.followed, j)
    }

    /// The same of what has changed since just before a contact.
    pub fn change(&self, j: usize) -> f64 {
        self.less(&self.recent, j)
    }

    fn less(&self, other: &[f64], j: usize) -> f64 {
        let pairs = self.torque.iter().zip(other).skip(j).step_by(self.nv);
        pairs.map(|(torque, other)| (torque - other).powi(2)).sum()
    }

    /// Adds the covariance of what the bias does not hold to row `i` of a matrix, up to its last column.
    #[inline]
    pub fn add_to_row(&self, i: usize, row: &mut [f64]) {
        for (torque, followed) in self.torque.chunks_exact(self.nv).zip(self.followed.chunks_exact(self.nv)) {
            let own = torque[i] - followed[i];
            row[i] += (OWN * own).powi(2);
            for ((value, torque), followed) in row.iter_mut().zip(torque).zip(followed) {
                *value += own * (torque - followed);
            }
        }
    }

    /// Forgets all steps.
    pub fn reset(&mut self) {
        self.followed.fill(0.0);
        (self.next, self.started) = (0, false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_bias_holds_is_no_error_until_the_pose_changes() {
        let robot = Robot::example_arm();
        let mut kinematics = Kinematics::new(&robot);
        let mut heavier = ModelError { bodies: vec![[0.0; 4]; 7], bias: vec![0.0; 7], viscous: vec![0.0; 7] };
        heavier.bodies[6] = [1.0, 0.0, 0.0, 0.1];
        let mut errors = ModelErrors::new(vec![heavier], 7);
        let (pose, other, still) =
            ([0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.2], [0.3, -0.8, -0.4, -0.9, 0.5, 0.7, 0.2], [0.0; 7]);
        kinematics.set_configuration(&robot, &pose);
        errors.advance(&robot, &kinematics, &still);
        let all = errors.variance(1);
        assert!(all > 1.0 && errors.unfollowed(1) == all && errors.change(1) == 0.0);
        let mut row = [0.0; 2];
        errors.add_to_row(1, &mut row);
        assert!((row[1] - (1.0 + OWN * OWN) * all).abs() < 1e-12 * all);
        (0..7).for_each(|j| errors.follow(j, 1.0));
        assert!(errors.unfollowed(1) < 1e-24);
        kinematics.set_configuration(&robot, &other);
        errors.advance(&robot, &kinematics, &still);
        let moved = errors.unfollowed(1);
        assert!(moved > all && (errors.change(1) - moved).abs() < 1e-12 * moved);
        errors.take();
        (0..7).for_each(|j| errors.forget(j, 1.0));
        assert!((errors.unfollowed(1) - errors.variance(1)).abs() < 1e-12);
        errors.keep(10.0 * RECENT);
        assert!(errors.change(1) < 1e-24);
    }
}
