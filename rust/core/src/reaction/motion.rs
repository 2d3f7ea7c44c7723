//! Stop, retreat and gravity compensation, a call a tick each.

use std::sync::Arc;

use super::gravity::carry;
use super::limits::ReactionLimits;
use crate::error::{Error, Result};
use crate::robot::{Kinematics, Robot};
use crate::sample::check_time_step;

/// Reactions to a contact of one robot: each call is one control tick and returns the next command. Whatever the arguments,
/// commanded velocities, accelerations and torques stay within the limits. It is no safety function.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::reaction::{Reaction, ReactionLimits};
/// use contactsense::robot::Robot;
///
/// let robot = Arc::new(Robot::example_arm());
/// let limits = ReactionLimits { acceleration: vec![2.0; 7], ..ReactionLimits::of(&robot) };
/// let mut reaction = Reaction::new(robot, 1e-3, limits)?;
/// let v = [0.1, -0.2, 0.0, 0.0, 0.0, 0.0, 0.0];
/// let mut command = vec![0.0; 7];
/// for _ in 0..100 {
///     command.copy_from_slice(reaction.stop(&v)?);
/// }
/// // 0.2 rad/s at 2 rad/s^2.
/// assert!(command.iter().all(|command| command.abs() < 1e-9));
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Reaction {
    robot: Arc<Robot>,
    kinematics: Kinematics,
    dt: f64,
    limits: ReactionLimits,
    /// The last commanded velocities; valid once a stop or a retreat has begun.
    command: Vec<f64>,
    begun: bool,
    /// Of a retreat: its age (s), whether each joint has come to rest first, and its way since (rad, m).
    age: f64,
    rested: Vec<bool>,
    way: Vec<f64>,
    torque: Vec<f64>,
}

impl Reaction {
    /// Reactions within `limits`, called every `dt` (s).
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the argument.
    pub fn new(robot: Arc<Robot>, dt: f64, limits: ReactionLimits) -> Result<Self> {
        robot.check_moves()?;
        check_time_step(dt)?;
        let nv = robot.nv();
        limits.check(nv)?;
        Ok(Self {
            kinematics: Kinematics::new(&robot),
            dt,
            limits,
            command: vec![0.0; nv],
            begun: false,
            age: 0.0,
            rested: vec![false; nv],
            way: vec![0.0; nv],
            torque: vec![0.0; nv],
            robot,
        })
    }

    /// The next velocity of a stop along the direction of the motion; the first call takes `v` as the velocity to brake from.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the argument; the state is then unchanged.
    pub fn stop(&mut self, v: &[f64]) -> Result<&[f64]> {
        self.robot.check_tangent("v", v)?;
        self.begin(v);
        let time = self.braking_time();
        let left = if time > self.dt { 1.0 - self.dt / time } else { 0.0 };
        self.command.iter_mut().for_each(|command| *command *= left);
        Ok(&self.command)
    }

    /// The next velocity of a retreat: each joint comes to rest, then follows the torque of the collision by `admittance` (rad/s
    /// of Nm, m/s of N) until the way or the time is used up.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the argument; the state is then unchanged.
    pub fn retract(&mut self, v: &[f64], collision_torque: &[f64], admittance: f64) -> Result<&[f64]> {
        self.robot.check_tangent("v", v)?;
        self.robot.check_tangent("collision_torque", collision_torque)?;
        if !(admittance.is_finite() && admittance > 0.0) {
            return Err(Error::input("admittance", format!("must be positive, got {admittance}")));
        }
        self.begin(v);
        self.age += self.dt;
        let scale = self.scale(collision_torque, admittance);
        let over = self.age > self.limits.duration;
        for (k, torque) in collision_torque.iter().enumerate() {
            let change = self.limits.acceleration[k] * self.dt;
            let command = self.command[k];
            self.rested[k] |= command.abs() <= change;
            let free = if over || !self.rested[k] { 0.0 } else { self.free_speed(k) };
            let wanted = (scale * torque).clamp(-free, free);
            let next = wanted.clamp(command - change, command + change);
            self.command[k] = next;
            if self.rested[k] {
                self.way[k] += next.abs() * self.dt;
            }
        }
        Ok(&self.command)
    }

    /// The torque that carries the weight and brakes by `damping` (Nm s/rad, N s/m), within the limits.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the argument.
    pub fn gravity_compensation(&mut self, q: &[f64], v: &[f64], damping: f64) -> Result<&[f64]> {
        self.robot.check_configuration(q)?;
        self.robot.check_tangent("v", v)?;
        if !(damping.is_finite() && damping >= 0.0) {
            return Err(Error::input("damping", format!("must not be negative, got {damping}")));
        }
        self.kinematics.set_configuration(&self.robot, q);
        carry(&self.robot, &self.kinematics, &mut self.torque);
        for ((torque, v), limit) in self.torque.iter_mut().zip(v).zip(&self.limits.torque) {
            *torque = (*torque - damping * v).clamp(-limit, *limit);
        }
        Ok(&self.torque)
    }

    /// The next call begins a new reaction.
    pub fn reset(&mut self) {
        self.begun = false;
        self.age = 0.0;
        self.rested.fill(false);
        self.way.fill(0.0);
    }

    /// The robot.
    pub fn robot(&self) -> &Arc<Robot> {
        &self.robot
    }

    /// What is never exceeded.
    pub fn limits(&self) -> &ReactionLimits {
        &self.limits
    }

    fn begin(&mut self, v: &[f64]) {
        if !self.begun {
            self.begun = true;
            for ((command, v), limit) in self.command.iter_mut().zip(v).zip(&self.limits.velocity) {
                *command = v.clamp(-limit, *limit);
            }
        }
    }

    /// Until all joints stand still (s), together.
    fn braking_time(&self) -> f64 {
        let times = self.command.iter().zip(&self.limits.acceleration).map(|(v, limit)| v.abs() / limit);
        times.fold(0.0, f64::max)
    }

    /// Velocity over torque: the admittance, less where a joint would be too fast.
    fn scale(&self, torque: &[f64], admittance: f64) -> f64 {
        let limited = torque.iter().zip(&self.limits.velocity);
        let least = limited.map(|(torque, limit)| limit / torque.abs().max(f64::MIN_POSITIVE));
        least.fold(admittance, f64::min)
    }

    /// Speed from which a joint still comes to rest within the way that is left (rad/s, m/s).
    fn free_speed(&self, k: usize) -> f64 {
        let left = (self.limits.distance - self.way[k]).max(0.0);
        let change = self.limits.acceleration[k] * self.dt;
        // Moved by n steps of falling speed: v dt + v^2 / (2 a) at most.
        (change * change + 2.0 * self.limits.acceleration[k] * left).sqrt() - change
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn reaction() -> Reaction {
        let robot = Arc::new(Robot::example_arm());
        let mut limits = ReactionLimits::of(&robot);
        limits.torque = vec![20.0; 7];
        limits.acceleration = vec![3.0, 5.0, 7.0, 9.0, 2.0, 1.0, 4.0];
        limits.velocity = vec![0.5; 7];
        Reaction::new(robot, 1e-3, limits).expect("limits that make sense")
    }

    fn numbers(most: f64) -> impl Strategy<Value = Vec<f64>> {
        proptest::collection::vec(-most..most, 7)
    }

    proptest! {
        #[test]
        fn a_retreat_keeps_its_limits(
            v in numbers(3.0), torques in proptest::collection::vec(numbers(1e6), 1..40), admittance in 1e-6..1e6,
        ) {
            let mut reaction = reaction();
            let mut last: Vec<f64> = v.iter().map(|v| v.clamp(-0.5, 0.5)).collect();
            let mut way = [0.0; 7];
            for tick in 0..1500 {
                let torque = &torques[tick / 37 % torques.len()];
                let next = reaction.retract(&v, torque, admittance).unwrap().to_vec();
                for k in 0..7 {
                    prop_assert!(next[k].abs() <= 0.5 + 1e-12);
                    prop_assert!((next[k] - last[k]).abs() <= reaction.limits.acceleration[k] * 1e-3 + 1e-12);
                    if reaction.rested[k] {
                        way[k] += next[k].abs() * 1e-3;
                    }
                    prop_assert!(way[k] <= reaction.limits.distance + 1e-9, "{}", way[k]);
                }
                last = next;
            }
            prop_assert!(last.iter().all(|v| v.abs() < 1e-9));
        }

        #[test]
        fn a_stop_keeps_its_limits_and_its_direction(v in numbers(3.0)) {
            let mut reaction = reaction();
            let first: Vec<f64> = v.iter().map(|v| v.clamp(-0.5, 0.5)).collect();
            let mut last = first.clone();
            for _ in 0..700 {
                let next = reaction.stop(&v).unwrap().to_vec();
                for k in 0..7 {
                    prop_assert!((next[k] - last[k]).abs() <= reaction.limits.acceleration[k] * 1e-3 + 1e-12);
                    prop_assert!(next[k] * first[k] >= 0.0 && next[k].abs() <= last[k].abs());
                }
                last = next;
            }
            prop_assert!(last.iter().all(|v| *v == 0.0));
        }

        #[test]
        fn torques_are_clipped(q in numbers(3.0), v in numbers(1e4), damping in 0.0..1e6) {
            let mut reaction = reaction();
            let torque = reaction.gravity_compensation(&q, &v, damping).unwrap();
            prop_assert!(torque.iter().all(|torque| torque.abs() <= 20.0));
        }
    }

    #[test]
    fn the_weight_is_that_of_inverse_dynamics() {
        let robot = Arc::new(Robot::example_arm());
        let limits = ReactionLimits { torque: vec![1e6; 7], ..ReactionLimits::of(&robot) };
        let mut reaction = Reaction::new(robot.clone(), 1e-3, limits).unwrap();
        let (q, still) = ([0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.1], [0.0; 7]);
        let expected = robot.inverse_dynamics(&q, &still, &still).unwrap();
        let torque = reaction.gravity_compensation(&q, &still, 3.0).unwrap();
        for (torque, expected) in torque.iter().zip(&expected) {
            assert!((torque - expected).abs() < 1e-9);
        }
    }

    #[test]
    fn what_is_no_number_is_refused_and_changes_nothing() {
        let mut reaction = reaction();
        let v = [0.2; 7];
        reaction.stop(&v).unwrap();
        let before = reaction.command.clone();
        let mut bad = v;
        bad[3] = f64::NAN;
        assert!(reaction.stop(&bad).is_err());
        assert!(reaction.retract(&v, &bad, 1.0).is_err());
        assert!(reaction.retract(&v, &v, f64::NAN).is_err());
        assert!(reaction.gravity_compensation(&bad, &v, 1.0).is_err());
        assert_eq!(reaction.command, before);
    }
}
