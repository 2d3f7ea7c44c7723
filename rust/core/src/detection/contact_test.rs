//! One statistic of all joints and several gains against a level: is the robot touched (algorithm D3)?

use std::sync::Arc;

use super::free_directions::FreeDirections;
use super::friction_errors::FrictionErrors;
use super::model_errors::ModelErrors;
use super::payload_errors::{Load, PayloadErrors};
use super::recent_torque::RecentTorque;
use super::signal::Signal;
use super::slow_errors::SlowErrors;
use super::standstill::Standstill;
use super::timing_errors::TimingErrors;
use super::velocity_covariance::VelocityCovariance;
use crate::math::chi_square::standard_deviations;
use crate::observer::{ObserverBank, Order, Step};
use crate::robot::{Kinematics, Robot};
use crate::torque::{ErrorVariances, ModelError};

/// Gains of the bank (1/s): a slow one sees weak contacts, a fast one hard impacts early.
pub(crate) const GAINS: [f64; 3] = [8.0, 50.0, 200.0];
/// The largest step of an observer, as a share of its time constant, at which its output still means something.
pub(crate) const LARGEST_STEP: f64 = 0.6;
/// Time constant with which slow errors are followed (s): longer than a push by a person, shorter than the time over which
/// gears settle and masses move.
pub(crate) const FOLLOW_TIME: f64 = 3.0;
/// Beyond this share of the level a contact goes on, and slow errors are not followed: what grows slowly may be one.
const SUSPICIOUS: f64 = 0.5;
/// Which of the gains tells when a contact has ended: the slowest still holds its torque.
const PROMPT: usize = 1;
/// A joint is over its own threshold beyond so many standard deviations.
const JOINT_LEVEL: f64 = 5.0;

/// Levels of a statistic for one gain.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Level {
    /// Of the observer (1/s).
    pub gain: f64,
    /// That is exceeded at the chosen rate.
    pub level: f64,
    /// That Gaussian errors exceed at that rate.
    pub gaussian: f64,
}

/// Tests whether the external torque is more than the errors of the untouched robot.
#[derive(Debug, Clone)]
pub(crate) struct ContactTest {
    robot: Arc<Robot>,
    dt: f64,
    /// None: the torque that is given is the only signal.
    bank: Option<ObserverBank>,
    signals: Vec<Signal>,
    /// By signal.
    timing: Vec<TimingErrors>,
    velocity: VelocityCovariance,
    standstill: Standstill,
    slow: SlowErrors,
    friction: FrictionErrors,
    payload: PayloadErrors,
    /// The signal whose covariance is next.
    next: usize,
    started: bool,
    without_bias: Vec<f64>,
    scratch: Vec<f64>,
    /// By signal: the torque without what is free, but with the bias.
    shown: Vec<Vec<f64>>,
    /// By velocity variable: over one where the joint is over its own threshold.
    joints: Vec<f64>,
    suspicious: bool,
    recent: RecentTorque,
    /// Of the errors of a contact's torque (Nm, N).
    deviations: Vec<f64>,
}

impl ContactTest {
    /// A test over a bank of observers, one a level. Slow errors are followed with a time constant (s); `dt` (s) is the
    /// nominal step.
    pub fn new(
        robot: Arc<Robot>,
        variances: &ErrorVariances,
        dt: f64,
        levels: &[Level],
        model_errors: &[ModelError],
        follow_time: f64,
    ) -> Self {
        let nv = robot.nv();
        let gains: Vec<f64> = levels.iter().map(|level| level.gain).collect();
        let signal = |level: &Level| {
            Signal::new(variances, &vec![level.gain; nv], Order::Second, dt, level.level, level.gaussian)
        };
        let timing = |gain: &f64| TimingErrors::new(&vec![*gain; nv], Order::Second);
        ContactTest {
            bank: Some(ObserverBank::new(nv, dt, &gains, Order::Second)),
            signals: levels.iter().map(signal).collect(),
            timing: gains.iter().map(timing).collect(),
            velocity: VelocityCovariance::new(&robot, &variances.velocity),
            standstill: Standstill::new(&variances.velocity),
            slow: SlowErrors::new(
                variances.slow.clone(),
                ModelErrors::new(model_errors.to_vec(), nv),
                follow_time,
            ),
            friction: FrictionErrors::new(nv),
            payload: PayloadErrors::new(nv),
            next: 0,
            started: false,
            without_bias: vec![0.0; nv],
            scratch: vec![0.0; nv],
            shown: vec![vec![0.0; nv]; levels.len()],
            joints: vec![0.0; nv],
            suspicious: false,
            recent: RecentTorque::new(nv),
            deviations: vec![1.0; nv],
            robot,
            dt,
        }
    }

    /// The same of one torque, that of an observer of a gain a joint.
    pub fn of_one_torque(
        robot: Arc<Robot>,
        variances: &ErrorVariances,
        dt: f64,
        gain: &[f64],
        level: Level,
        model_errors: &[ModelError],
        follow_time: f64,
    ) -> Self {
        let signal = Signal::new(variances, gain, Order::First, dt, level.level, level.gaussian);
        let test = ContactTest::new(robot, variances, dt, &[], model_errors, follow_time);
        let shown = vec![vec![0.0; gain.len()]];
        let timing = vec![TimingErrors::new(gain, Order::First)];
        ContactTest { bank: None, signals: vec![signal], timing, shown, ..test }
    }

    /// A step to a pose and velocities `(nv,)`, with the external torque before any low-pass; none where the step told nothing
    /// of it.
    #[inline]
    pub fn advance(
        &mut self,
        kinematics: &Kinematics,
        v: &[f64],
        moving_torque: Option<&[f64]>,
        unexplained: Option<&[f64]>,
        step: Step,
    ) {
        if let Some(bank) = &mut self.bank {
            bank.advance(unexplained, step);
        }
        self.velocity.advance(&self.robot, kinematics);
        self.slow.of_model_mut().advance(&self.robot, kinematics, v);
        let length = step.length(self.dt);
        let moving = self.standstill.advance(v, length);
        self.friction.advance(v, length);
        self.payload.advance(&self.robot, kinematics, length);
        let Self { signals, timing, velocity, slow, friction, payload, .. } = self;
        let told = unexplained.map(|_| length);
        signals.iter_mut().for_each(|signal| signal.advance(told, moving));
        if let Some(torque) = moving_torque {
            timing.iter_mut().for_each(|timing| timing.advance(torque, told));
        }
        let whiten = |signal: &mut Signal| signal.whiten(velocity, slow, friction, payload);
        if self.started {
            let next = self.next;
            if whiten(&mut signals[next]) {
                self.next = (next + 1) % signals.len();
            }
            let others = signals.iter_mut().enumerate().filter(|(which, _)| *which != next);
            others.filter(|(_, signal)| signal.stale()).for_each(|(_, signal)| _ = whiten(signal));
        } else {
            signals.iter_mut().for_each(|signal| _ = whiten(signal));
        }
        self.started = true;
    }

    /// Compares the torques without bias with their errors, with a lower level where a contact goes on; `torque` `(nv,)` is
    /// the one to look at without a bank. What is in free directions does not count.
    #[inline]
    pub fn evaluate(&mut self, torque: &[f64], in_contact: bool, mut free: Option<&mut FreeDirections>) {
        let share = if in_contact { SUSPICIOUS } else { 1.0 };
        if in_contact && free.is_none() {
            self.forget_what_fell();
        }
        let Self { bank, signals, timing, slow, without_bias, scratch, shown, joints, .. } = self;
        self.suspicious = false;
        joints.fill(0.0);
        let first = usize::from(bank.is_some());
        for (which, signal) in signals.iter_mut().enumerate() {
            let torque = bank.as_ref().map_or(torque, |bank| &bank.torques()[which]);
            for ((value, torque), bias) in without_bias.iter_mut().zip(torque).zip(slow.bias()) {
                *value = torque - bias;
            }
            signal.evaluate(without_bias, first + which, free.as_deref_mut());
            for ((shown, left), bias) in shown[which].iter_mut().zip(&*without_bias).zip(slow.bias()) {
                *shown = left + bias;
            }
            if signal.statistic > SUSPICIOUS * signal.level {
                scratch.copy_from_slice(without_bias);
                timing[which].take_from(scratch);
                signal.evaluate(scratch, first + which, free.as_deref_mut());
            }
            // A lower level does not make slow errors less known.
            self.suspicious |= signal.statistic > SUSPICIOUS * signal.level.max(signal.gaussian_level);
            if signal.statistic <= share * signal.level {
                continue;
            }
            // Errors that are not Gaussian widen the thresholds of single joints as much as that of the statistic.
            let widened = (signal.level / signal.gaussian_level).sqrt();
            let deviations = signal.deviations();
            let shares =
                without_bias.iter().zip(deviations).map(|(torque, deviation)| (torque / deviation).abs());
            let largest = shares.clone().fold(0.0, f64::max);
            let threshold = f64::min(JOINT_LEVEL * widened, largest * ALMOST);
            for (joint, share) in joints.iter_mut().zip(shares) {
                *joint = joint.max(share / threshold);
            }
        }
    }

    /// A slow observer still holds a torque that a faster one shows to have fallen: it takes over that one's. Otherwise the
    /// contacts of people who push twice a second would be one.
    #[inline]
    fn forget_what_fell(&mut self) {
        let Self { bank: Some(bank), signals, slow, without_bias, .. } = self else { return };
        for slower in (0..signals.len().saturating_sub(1)).rev() {
            let signal = &mut signals[slower + 1];
            let mut is_over = |which: usize| {
                let torque = bank.torques()[which].iter().zip(slow.bias());
                without_bias
                    .iter_mut()
                    .zip(torque)
                    .for_each(|(value, (torque, bias))| *value = torque - bias);
                signal.squared_norm(without_bias) > SUSPICIOUS * signal.level
            };
            if is_over(slower) && !is_over(slower + 1) {
                bank.take_over(slower, slower + 1);
            }
        }
    }

    /// A step of `dt` (s): slow errors are followed, or not where something may touch the robot.
    #[inline]
    pub fn follow(&mut self, dt: f64, touched: bool) {
        let Some(slowest) = self.shown.first() else { return };
        self.recent.advance(slowest, dt, touched);
        if touched || self.payload.settling() {
            self.slow.lose(slowest, dt);
        } else {
            self.slow.follow(slowest, dt);
        }
    }

    /// Another robot from now on, of other inertias only: loads are taken away and added.
    pub fn set_robot(&mut self, robot: &Arc<Robot>, loads: [Option<Load>; 2]) {
        self.robot = Arc::clone(robot);
        self.payload.change(loads);
        // All covariances hold the change at once.
        self.signals.iter_mut().for_each(Signal::restart);
        self.started = false;
    }

    /// What a contact does to the torque behind the observer that shows it most clearly, and the standard deviations of its errors:
    /// since just before the contact where that is known, and else without bias.
    pub fn contact_signal(&mut self) -> (&[f64], &[f64]) {
        let Self { signals, slow, without_bias, shown, recent, velocity, friction, deviations, .. } = self;
        let clear = |(signal, _): &(&Signal, &Vec<f64>)| signal.statistic / signal.level;
        let clearest = signals.iter().zip(&*shown).max_by(|a, b| clear(a).total_cmp(&clear(b)));
        let Some((signal, torque)) = clearest else { return (without_bias, deviations) };
        let before = recent.before();
        let bias = before.map_or(slow.bias(), |(torque, _)| torque);
        for ((value, torque), bias) in without_bias.iter_mut().zip(torque).zip(bias) {
            *value = torque - bias;
        }
        for (i, deviation) in deviations.iter_mut().enumerate() {
            let share = signal.model_share(i);
            let slow = match before {
                Some((_, age)) => slow.change(i, share, age) + slow.of_model().change(i),
                None => slow.variance(i, share) + slow.of_model().unfollowed(i),
            };
            *deviation = (signal.fast_variance(i, velocity, friction) + slow).sqrt();
        }
        (without_bias, deviations)
    }

    /// The torque that tells when a contact has ended.
    pub fn prompt(&self) -> &[f64] {
        self.shown.get(PROMPT).or(self.shown.first()).map_or(&[], |torque| torque)
    }

    /// The gains of the bank, slow to fast (1/s); none without one.
    pub fn gains(&self) -> &[f64] {
        self.bank.as_ref().map_or(&[], ObserverBank::gains)
    }

    /// Leaves of the reported torque, free of bias, what is not in free directions.
    pub fn leave(&mut self, torque: &mut [f64], free: &mut FreeDirections) {
        if let Some(signal) = self.signals.first_mut() {
            free.leave(0, signal.whitening_mut(), torque);
        }
    }

    /// Whether one is so large that slow errors are not followed.
    pub fn suspicious(&self) -> bool {
        self.suspicious
    }

    /// By velocity variable: over one where the joint is over its own threshold. At least one is where a statistic is over
    /// its level.
    pub fn joints(&self) -> &[f64] {
        &self.joints
    }

    /// By gain, `r' S^-1 r`.
    pub fn statistics(&self) -> impl Iterator<Item = f64> + '_ {
        self.signals.iter().map(|signal| signal.statistic)
    }

    /// How unlikely the torque is without contact: so many standard deviations a Gaussian number would be off as rarely, the
    /// largest of all gains.
    #[inline]
    pub fn significance(&self) -> f64 {
        let nv = self.joints.len();
        let of_signal = |signal: &Signal| {
            standard_deviations(nv, signal.statistic * signal.gaussian_level / signal.level)
        };
        self.signals.iter().map(of_signal).fold(0.0, f64::max)
    }

    /// What is known of slow errors.
    pub fn slow(&self) -> &SlowErrors {
        &self.slow
    }

    /// The same, to be changed.
    pub fn slow_mut(&mut self) -> &mut SlowErrors {
        &mut self.slow
    }

    /// Forgets all steps.
    pub fn reset(&mut self) {
        if let Some(bank) = &mut self.bank {
            bank.reset();
        }
        self.signals.iter_mut().for_each(Signal::reset);
        self.timing.iter_mut().for_each(TimingErrors::reset);
        self.velocity.reset();
        self.standstill.reset();
        self.slow.reset();
        self.friction.reset();
        self.payload.reset();
        self.recent.reset();
        self.joints.fill(0.0);
        (self.next, self.started, self.suspicious) = (0, false, false);
    }
}

/// The largest share must lie over the threshold.
const ALMOST: f64 = 0.999;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::torque::NoiseModel;

    const DT: f64 = 1e-3;

    /// Of an arm with noise of all kinds, in a pose without motion.
    struct Scene {
        test: ContactTest,
        kinematics: Kinematics,
    }

    impl Scene {
        fn new() -> Self {
            let robot = Arc::new(Robot::example_arm());
            let noise = NoiseModel {
                torque: vec![0.05],
                velocity: vec![2e-3],
                model: vec![0.05],
                ..NoiseModel::default()
            };
            let variances = noise.variances(&robot).expect("valid");
            let levels = GAINS.map(|gain| Level { gain, level: 40.0, gaussian: 40.0 });
            let test = ContactTest::new(Arc::clone(&robot), &variances, DT, &levels, &[], FOLLOW_TIME);
            let mut kinematics = Kinematics::new(&robot);
            kinematics.set_configuration(&robot, &[0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.2]);
            Scene { test, kinematics }
        }

        /// So many ticks with a torque on the fourth joint (Nm).
        fn run(&mut self, ticks: usize, torque: f64, touched: bool) {
            let mut unexplained = [0.0; 7];
            unexplained[3] = torque;
            for _ in 0..ticks {
                self.test.advance(&self.kinematics, &[0.0; 7], None, Some(&unexplained), Step::Nominal);
                self.test.evaluate(&[], touched, None);
                self.test.follow(DT, touched);
            }
        }
    }

    #[test]
    fn a_contact_is_read_from_a_fast_observer_at_first_and_from_a_slow_one_later() {
        let mut scene = Scene::new();
        scene.run(3000, 0.0, false);
        scene.run(20, 5.0, true);
        let (torque, deviation) = scene.test.contact_signal();
        let (early, uncertain) = (torque[3], deviation[3]);
        // The slowest observer holds 4 % of it yet.
        assert!(early > 2.5, "{early}");
        scene.run(1000, 5.0, true);
        let (torque, deviation) = scene.test.contact_signal();
        assert!((torque[3] - 5.0).abs() < 0.01 && deviation[3] < uncertain, "{torque:?} {deviation:?}");
    }

    #[test]
    fn the_end_of_a_contact_shows_before_the_slowest_observer_has_forgotten_it() {
        let mut scene = Scene::new();
        scene.run(3000, 0.0, false);
        scene.run(500, 2.0, true);
        let held = scene.test.prompt()[3];
        scene.run(60, 0.0, true);
        assert!((held - 2.0).abs() < 0.01 && scene.test.prompt()[3] < 0.05, "{held}");
    }
}
