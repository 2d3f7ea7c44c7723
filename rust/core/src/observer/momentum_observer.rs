//! The generalised momentum observer (Vorndamme 2017, eqs. 4-6) and its acceleration (eqs. 8-9).

use std::sync::Arc;

use super::step::Step;
use crate::calibration::{Calibration, TorqueModel};
use crate::error::{Error, Result};
use crate::robot::configuration::spread_torque;
use crate::robot::{ForwardDynamics, Kinematics, MomentumPass, Robot};
use crate::sample::{check_time_step, ExternalSample, Sample};

/// Estimates the external torque from `q`, `v` and the motors' torque, without acceleration.
///
/// Each component is the true external torque behind a first-order low-pass with time constant `1 / gain`. The step
/// is exact for a constant external torque, second-order in `dt` and stable for any `gain * dt`.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::observer::MomentumObserver;
/// use contactsense::robot::Robot;
/// use contactsense::Sample;
///
/// let robot = Arc::new(Robot::example_arm());
/// let (q, v) = (vec![0.4; 7], vec![0.0; 7]);
/// // At rest the motors hold the weight, and 2 Nm from outside on the second joint.
/// let mut tau = robot.inverse_dynamics(&q, &v, &v)?;
/// tau[1] -= 2.0;
/// let mut observer = MomentumObserver::new(robot, 1e-3, &[50.0])?;
/// for _ in 0..500 {
///     observer.update(&Sample::new(&q, &v, &tau))?;
/// }
/// assert!((observer.external_torque()[1] - 2.0).abs() < 1e-6);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct MomentumObserver {
    robot: Arc<Robot>,
    /// Corrects velocities and torques, where the robot is calibrated.
    calibration: Option<TorqueModel>,
    dt: f64,
    gain: Vec<f64>,
    /// `exp(-gain dt)` for the `dt` of the constructor.
    decay: Vec<f64>,
    kinematics: Kinematics,
    pass: MomentumPass,
    forward: ForwardDynamics,
    momentum: Vec<f64>,
    momentum_before: Vec<f64>,
    /// `tau_m - tau_f + C^T v - g` now and at the step before.
    known_rate: Vec<f64>,
    known_rate_before: Vec<f64>,
    external_torque: Vec<f64>,
    /// What the change of momentum over the last step says of the external torque, before any low-pass.
    unexplained: Vec<f64>,
    /// `tau_m - tau_f`.
    motor_torque: Vec<f64>,
    /// Of a calibrated robot: where it was when the velocities and torques were what they are.
    configuration: Vec<f64>,
    velocity: Vec<f64>,
    total_torque: Vec<f64>,
    acceleration: Vec<f64>,
    acceleration_is_current: bool,
    started: bool,
    /// Whether the last step was integrated: neither the first nor one over a gap or a change of the robot.
    integrated: bool,
    /// The robot changed since the last step.
    changed: bool,
    /// Whether the external torque of the last step was given.
    external: bool,
}

impl MomentumObserver {
    /// An observer that is called every `dt` (s), with a `gain` (1/s) per velocity variable (or one for all).
    ///
    /// # Errors
    /// [`Error::Input`] where `dt` or a gain is not positive and finite, or their number is wrong.
    pub fn new(robot: Arc<Robot>, dt: f64, gain: &[f64]) -> Result<Self> {
        robot.check_moves()?;
        check_time_step(dt)?;
        let nv = robot.nv();
        let gain = check_gain(&robot, gain)?;
        let zeros = vec![0.0; nv];
        Ok(Self {
            dt,
            decay: gain.iter().map(|gain| (-gain * dt).exp()).collect(),
            gain,
            kinematics: Kinematics::new(&robot),
            pass: MomentumPass::new(&robot),
            forward: ForwardDynamics::new(&robot),
            momentum: zeros.clone(),
            momentum_before: zeros.clone(),
            known_rate: zeros.clone(),
            known_rate_before: zeros.clone(),
            external_torque: zeros.clone(),
            unexplained: zeros.clone(),
            motor_torque: zeros.clone(),
            velocity: zeros.clone(),
            total_torque: zeros.clone(),
            acceleration: zeros,
            acceleration_is_current: true,
            started: false,
            integrated: false,
            changed: false,
            external: false,
            calibration: None,
            configuration: vec![0.0; robot.nq()],
            robot,
        })
    }

    /// The same of a calibrated robot: velocities and torques are corrected, and inertias are those that its motion showed.
    /// Torques, velocities and the pose are those of one time, when the latest of the measured signals was what it is.
    ///
    /// # Errors
    /// [`Error::Input`] also where the calibration is of another robot.
    pub fn calibrated(robot: &Robot, dt: f64, gain: &[f64], calibration: &Calibration) -> Result<Self> {
        let robot = Arc::new(calibration.corrected(robot)?);
        Ok(Self { calibration: Some(TorqueModel::new(calibration)), ..Self::new(robot, dt, gain)? })
    }

    /// One control tick; returns the external torque `(nv,)`.
    ///
    /// The sample's `dt` replaces the constructor's for this step; wrenches are not looked at. The first call sets the
    /// initial momentum and returns zeros.
    ///
    /// # Errors
    /// [`Error::Input`] names the argument; the state is then unchanged.
    pub fn update(&mut self, sample: &Sample<'_>) -> Result<&[f64]> {
        sample.check(&self.robot)?;
        Ok(self.advance(sample, sample.dt.map_or(Step::Nominal, Step::Of)))
    }

    /// The same of a checked sample; over a gap the estimate is kept, and the next step starts from here.
    pub(crate) fn advance(&mut self, sample: &Sample<'_>, step: Step) -> &[f64] {
        let Sample { q, v, tau, friction, .. } = *sample;
        std::mem::swap(&mut self.momentum, &mut self.momentum_before);
        std::mem::swap(&mut self.known_rate, &mut self.known_rate_before);
        self.velocity.copy_from_slice(v);
        spread_torque(tau, &mut self.motor_torque);
        let mut configuration = q;
        if let Some(calibration) = &mut self.calibration {
            if !self.started {
                calibration.reset();
            }
            let length = if self.started { step.length(self.dt) } else { 0.0 };
            calibration.correct(length, &mut self.velocity, &mut self.motor_torque);
            if calibration.delay() > 0.0 {
                self.configuration.copy_from_slice(q);
                self.robot.advance_configuration(
                    &mut self.configuration,
                    &self.velocity,
                    -calibration.delay(),
                );
                configuration = &self.configuration;
            }
        }
        let v = &self.velocity;
        self.kinematics.set_configuration(&self.robot, configuration);
        self.kinematics.set_velocity(&self.robot, v);
        self.pass.evaluate(&self.robot, &self.kinematics, v, &mut self.momentum, &mut self.known_rate);
        if let Some(friction) = friction {
            let missing = self.motor_torque.len() - friction.len();
            self.motor_torque[missing..].iter_mut().zip(friction).for_each(|(tau, f)| *tau -= f);
        }
        self.known_rate.iter_mut().zip(&self.motor_torque).for_each(|(rate, tau)| *rate += tau);
        self.integrated = self.started && !step.is_gap() && !std::mem::take(&mut self.changed);
        if self.integrated {
            self.integrate(step);
        }
        (self.started, self.external) = (true, false);
        self.acceleration_is_current = false;
        &self.external_torque
    }

    /// A step with a checked external torque that is given: no momentum is observed, and nothing is low-passed. `alone`: the
    /// torque before is none of this step, the first or one over a gap.
    pub(crate) fn follow(&mut self, sample: &ExternalSample<'_>, alone: bool) {
        match sample.v {
            Some(v) => self.velocity.copy_from_slice(v),
            None => self.velocity.fill(0.0),
        }
        self.kinematics.set_configuration(&self.robot, sample.q);
        self.kinematics.set_velocity(&self.robot, &self.velocity);
        self.unexplained.copy_from_slice(&self.external_torque);
        self.external_torque.copy_from_slice(sample.tau_ext);
        if let Some(calibration) = &self.calibration {
            calibration.correct_external(&mut self.external_torque);
        }
        for (mean, now) in self.unexplained.iter_mut().zip(&self.external_torque) {
            *mean = if alone { *now } else { 0.5 * (*mean + now) };
        }
        // The motors' torque is not known.
        self.acceleration.fill(f64::NAN);
        (self.acceleration_is_current, self.integrated, self.changed) = (true, true, false);
        self.external = true;
    }

    /// `r' = gain (dp/dt - known rate - r)`, exactly over a step on which `dp/dt - known rate` is constant.
    fn integrate(&mut self, step: Step) {
        let length = step.length(self.dt);
        let inverse = 1.0 / length;
        for j in 0..self.external_torque.len() {
            let rate = (self.momentum[j] - self.momentum_before[j]) * inverse;
            let unexplained = rate - 0.5 * (self.known_rate[j] + self.known_rate_before[j]);
            self.unexplained[j] = unexplained;
            let decay = match step {
                Step::Nominal => self.decay[j],
                _ => (-self.gain[j] * length).exp(),
            };
            self.external_torque[j] = unexplained + decay * (self.external_torque[j] - unexplained);
        }
    }

    /// The mean external torque `(nv,)` of the last step as the change of momentum shows it, without low-pass; none before the
    /// second step and over a gap.
    pub(crate) fn unexplained(&self) -> Option<&[f64]> {
        self.integrated.then_some(&self.unexplained[..])
    }

    /// The rate of the momentum at the last step without external torque: of the motors' torque, gravity and velocities; none where
    /// the external torque was given.
    pub(crate) fn known_rate(&self) -> Option<&[f64]> {
        (!self.external).then_some(&self.known_rate[..])
    }

    /// The corrected velocity `(nv,)` of the last step.
    pub(crate) fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// Forgets all steps; the next call is a first call.
    pub fn reset(&mut self) {
        (self.started, self.integrated, self.changed) = (false, false, false);
        self.external_torque.fill(0.0);
        self.acceleration.fill(0.0);
        self.acceleration_is_current = true;
    }

    /// The estimated external torque `(nv,)` of the last step.
    pub fn external_torque(&self) -> &[f64] {
        &self.external_torque
    }

    /// The estimated acceleration `(nv,)` at the last step: forward dynamics with the external torque
    /// (Vorndamme 2017, eq. 9). Zeros before the first step.
    pub fn acceleration(&mut self) -> &[f64] {
        if !self.acceleration_is_current {
            let torques = self.motor_torque.iter().zip(&self.external_torque);
            self.total_torque.iter_mut().zip(torques).for_each(|(sum, (motor, ext))| *sum = motor + ext);
            let Self { robot, forward, kinematics, velocity, total_torque, acceleration, .. } = self;
            forward.evaluate(robot, kinematics, velocity, total_torque, acceleration);
            self.acceleration_is_current = true;
        }
        &self.acceleration
    }

    /// Time between two calls that is assumed where none is given (s).
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// Another gain from the next step on, one for all velocity variables or one for each (1/s). The external torque goes on
    /// from where it is.
    ///
    /// # Errors
    /// [`Error::Input`] where a gain is not positive and finite, or their number is wrong; nothing is then changed.
    pub fn set_gain(&mut self, gain: &[f64]) -> Result<()> {
        self.gain = check_gain(&self.robot, gain)?;
        self.decay = self.gain.iter().map(|gain| (-gain * self.dt).exp()).collect();
        Ok(())
    }

    /// Another robot from now on, of other inertias only. The external torque goes on from where it is; the next step, over
    /// which the momentum jumps, tells nothing of it.
    pub(crate) fn set_robot(&mut self, robot: &Arc<Robot>) {
        self.robot = Arc::clone(robot);
        self.changed = true;
    }

    /// The gain `(nv,)` (1/s).
    pub fn gain(&self) -> &[f64] {
        &self.gain
    }

    /// Poses and velocities of the last step.
    pub fn kinematics(&self) -> &Kinematics {
        &self.kinematics
    }

    /// The robot observed.
    pub fn robot(&self) -> &Arc<Robot> {
        &self.robot
    }
}

/// A gain per velocity variable (1/s).
fn check_gain(robot: &Robot, gain: &[f64]) -> Result<Vec<f64>> {
    let gain = robot.per_velocity("gain", gain)?;
    if gain.iter().any(|gain| *gain <= 0.0) {
        return Err(Error::input("gain", "must be positive [1/s]"));
    }
    Ok(gain)
}
