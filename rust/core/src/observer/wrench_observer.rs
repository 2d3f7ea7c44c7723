//! The external wrench that each sensor sees, observed like the external torque: without an acceleration.
//!
//! What is behind a sensor has a momentum `h` about a fixed point, and `dh/dt = W_gravity + W_external - W_load`, with
//! the wrench `W_load` that it puts on the sensor. Eqs. 13-19 of Vorndamme 2017 find `dh/dt` from the acceleration that
//! the momentum observer gives. That one is late by the observer's low-pass, and so is what is compensated with it: a
//! contact behind one sensor shows for some milliseconds in all others, on light parts that carry much (a foot on the
//! ground) nearly in full. Here `h` itself is observed, as by eqs. 4-6: the wrench of each step is exact in the mean. Its
//! torque goes through the same low-pass as the external torque, so that the two are of one age. The wrench itself has a
//! low-pass for the noise of readings and velocities, or none, and then comes without delay.

use std::sync::Arc;

use nalgebra::{Vector3, Vector6};

use crate::error::{Error, Result};
use crate::observer::Step;
use crate::robot::{Kinematics, Robot};
use crate::sensor::distal_parts::{distal_parts, DistalPart};
use crate::sensor::{sensor_torque, SensorTree};
use crate::spatial::vector::{moved, stack};

/// A gain times the time step from which an observer follows from tick to tick.
const FAST: f64 = 0.5;

/// Momentum or wrench, about a point that rests in the world.
type Spatial = Vector6<f64>;

/// Observes the external wrenches of a robot's sensors.
#[derive(Debug, Clone)]
pub(crate) struct WrenchObserver {
    robot: Arc<Robot>,
    parts: Vec<DistalPart>,
    dt: f64,
    /// The momentum observer's, per velocity variable (1/s).
    gain: Vec<f64>,
    /// Of the wrenches' low-pass (1/s).
    wrench_gain: f64,
    /// `exp(-gain length)` for the `length` of the last step, which is `decay_step` (s).
    decay: Vec<f64>,
    /// The same of the wrenches; zero without a low-pass.
    wrench_decay: f64,
    decay_step: f64,
    /// The fixed point: where the first step's reference origin was, in the world.
    reference: Option<Vector3<f64>>,
    before: Kinematics,
    momentum: Vec<Spatial>,
    momentum_before: Vec<Spatial>,
    /// Gravity's wrench less the load.
    known_rate: Vec<Spatial>,
    known_rate_before: Vec<Spatial>,
    had_reading: Vec<bool>,
    external: Vec<Option<Vector6<f64>>>,
    lagged: Vec<Vec<f64>>,
    /// Of what came during a sensor's last gap, how much the momentum observer may not know by now, per sensor `(nv,)`.
    unobserved: Vec<Vec<f64>>,
    before_gap: Vec<f64>,
    torque: Vec<f64>,
    usable: Vec<bool>,
    /// The robot or an offset changed since the last tick.
    changed: bool,
}

impl WrenchObserver {
    /// For the sensors of a tree, the momentum observer's gain `(nv,)` (1/s) and its time step (s); `wrench_gain` (1/s)
    /// of the low-pass on the wrenches, infinite for no low-pass. By default the smallest of `gain`, and no
    /// low-pass where that forgets within two ticks: it says that velocities can be trusted from tick to tick.
    ///
    /// # Errors
    /// [`Error::Input`] where `wrench_gain` is not positive.
    pub fn new(
        robot: Arc<Robot>,
        tree: &SensorTree,
        gain: &[f64],
        wrench_gain: Option<f64>,
        dt: f64,
    ) -> Result<Self> {
        let wrench_gain = check_wrench_gain(gain, wrench_gain, dt)?;
        let zeros = vec![Spatial::zeros(); tree.len()];
        Ok(Self {
            parts: distal_parts(&robot, tree),
            dt,
            gain: gain.to_vec(),
            wrench_gain,
            decay: gain.iter().map(|gain| (-gain * dt).exp()).collect(),
            wrench_decay: (-wrench_gain * dt).exp(),
            decay_step: dt,
            reference: None,
            before: Kinematics::new(&robot),
            momentum: zeros.clone(),
            momentum_before: zeros.clone(),
            known_rate: zeros.clone(),
            known_rate_before: zeros.clone(),
            had_reading: vec![false; tree.len()],
            external: vec![Some(Spatial::zeros()); tree.len()],
            lagged: vec![vec![0.0; gain.len()]; tree.len()],
            unobserved: vec![vec![0.0; gain.len()]; tree.len()],
            before_gap: vec![0.0; gain.len()],
            torque: vec![0.0; gain.len()],
            usable: vec![true; tree.len()],
            changed: false,
            robot,
        })
    }

    /// One control tick, with poses and velocities of now and checked readings; a sensor without one is left out.
    ///
    /// The first call sets the initial momentum and gives zeros. A sensor that comes back is left out for one more tick.
    /// Over a gap the estimates are kept, as the momentum observer keeps its own.
    pub fn update(
        &mut self,
        kinematics: &Kinematics,
        tree: &SensorTree,
        readings: &[Option<[f64; 6]>],
        step: Step,
    ) {
        let step = if std::mem::take(&mut self.changed) { Step::Gap(step.length(self.dt)) } else { step };
        self.set_step(step.length(self.dt));
        let first = self.reference.is_none();
        let shift = kinematics.origin - *self.reference.get_or_insert(kinematics.origin);
        std::mem::swap(&mut self.momentum, &mut self.momentum_before);
        std::mem::swap(&mut self.known_rate, &mut self.known_rate_before);
        self.pass(kinematics, tree, &shift);
        for (sensor, reading) in readings.iter().enumerate() {
            let known_before =
                self.had_reading[sensor] && (!step.is_gap() || self.external[sensor].is_some());
            self.usable[sensor] = reading.is_some() && (first || known_before);
            if let Some(reading) = reading {
                self.known_rate[sensor] -= load(kinematics, tree, sensor, reading, &shift);
            }
            if !self.usable[sensor] {
                self.external[sensor] = None;
            } else if !first && !step.is_gap() {
                self.observe(kinematics, tree, sensor);
            }
            self.had_reading[sensor] = reading.is_some();
        }
        self.before.origin = kinematics.origin;
        self.before.bodies.copy_from_slice(&kinematics.bodies);
    }

    /// Other gains from the next step on, as in [`WrenchObserver::new`]; estimates go on from where they are.
    ///
    /// # Errors
    /// [`Error::Input`] where `wrench_gain` is not positive; nothing is then changed.
    pub fn set_gain(&mut self, gain: &[f64], wrench_gain: Option<f64>) -> Result<()> {
        self.wrench_gain = check_wrench_gain(gain, wrench_gain, self.dt)?;
        self.gain.copy_from_slice(gain);
        // No step has this length: the decays are computed anew.
        self.decay_step = f64::NAN;
        self.set_step(self.dt);
        Ok(())
    }

    /// Another robot from now on, of other inertias only: the next step is as one over a gap.
    pub fn set_robot(&mut self, robot: &Arc<Robot>, tree: &SensorTree) {
        self.robot = Arc::clone(robot);
        self.parts = distal_parts(robot, tree);
        self.changed = true;
    }

    /// A sensor's external wrench is zero from now on, where it is not left out; the next step is as one over a gap.
    pub fn clear(&mut self, sensor: usize) {
        self.external[sensor] = self.external[sensor].map(|_| Spatial::zeros());
        self.lagged[sensor].fill(0.0);
        self.unobserved[sensor].fill(0.0);
        self.changed = true;
    }

    /// Another gain of the torques' low-pass by velocity variable (1/s), infinite for none; that of the wrenches stays.
    pub fn set_torque_gain(&mut self, gain: impl Fn(usize) -> f64) {
        self.gain.iter_mut().enumerate().for_each(|(k, value)| *value = gain(k));
        self.decay_step = f64::NAN;
        self.set_step(self.dt);
    }

    /// Of the wrenches' low-pass (1/s); infinite without one.
    pub fn wrench_gain(&self) -> f64 {
        self.wrench_gain
    }

    /// Decays for a step of `length` (s), kept for the next of the same length.
    fn set_step(&mut self, length: f64) {
        if length.to_bits() == self.decay_step.to_bits() {
            return;
        }
        self.decay_step = length;
        self.wrench_decay = (-self.wrench_gain * length).exp();
        self.decay.iter_mut().zip(&self.gain).for_each(|(decay, gain)| *decay = (-gain * length).exp());
    }

    /// Momentum behind each sensor and gravity's wrench on it, summed from sensor to sensor (Algorithm 1).
    fn pass(&mut self, kinematics: &Kinematics, tree: &SensorTree, shift: &Vector3<f64>) {
        self.momentum.fill(Spatial::zeros());
        self.known_rate.fill(Spatial::zeros());
        for part in &self.parts {
            let state = &kinematics.bodies[part.body];
            let at = state.position + shift;
            let velocity = state.velocity_at(&state.position);
            let first_moment = state.rotation * part.moment;
            let linear = velocity * part.mass + state.angular.cross(&first_moment);
            let spin = state.rotation * (part.rotational * state.rotation.tr_mul(&state.angular));
            let angular = spin + first_moment.cross(&velocity) + at.cross(&linear);
            self.momentum[part.sensor] += stack(&linear, &angular);
            let weight = (first_moment + at * part.mass).cross(&self.robot.gravity);
            self.known_rate[part.sensor] += stack(&(self.robot.gravity * part.mass), &weight);
        }
        for &sensor in tree.distal_first() {
            if let Some(parent) = tree.fixed_parent(sensor) {
                let (momentum, rate) = (self.momentum[sensor], self.known_rate[sensor]);
                self.momentum[parent] += momentum;
                self.known_rate[parent] += rate;
            }
        }
    }

    /// The mean external wrench of the step since the last tick, and its low-passes.
    fn observe(&mut self, kinematics: &Kinematics, tree: &SensorTree, sensor: usize) {
        let Some(reference) = self.reference else { return };
        let about = |wrench: &Spatial, state: &Kinematics| {
            let arm = tree.position(state, sensor) + (state.origin - reference);
            moved(wrench, &-arm)
        };
        let known = (self.known_rate[sensor] + self.known_rate_before[sensor]) * 0.5;
        let rate = (self.momentum[sensor] - self.momentum_before[sensor]) / self.decay_step;
        // After a gap the low-passes start anew.
        let mean = rate - known;
        let now = about(&mean, kinematics);
        let before = self.external[sensor];
        let fresh = before.is_none();
        self.external[sensor] = Some(before.map_or(now, |before| now + (before - now) * self.wrench_decay));
        let lagged = &mut self.lagged[sensor];
        let unobserved = &mut self.unobserved[sensor];
        if fresh {
            self.before_gap.copy_from_slice(lagged);
        }
        sensor_torque(&self.robot, kinematics, tree, sensor, &now, &mut self.torque);
        for ((lagged, torque), decay) in lagged.iter_mut().zip(&self.torque).zip(&self.decay) {
            *lagged = if fresh { 0.5 * torque } else { decay * *lagged + (1.0 - decay) * 0.5 * torque };
        }
        sensor_torque(&self.robot, &self.before, tree, sensor, &about(&mean, &self.before), &mut self.torque);
        for ((lagged, torque), decay) in lagged.iter_mut().zip(&self.torque).zip(&self.decay) {
            *lagged += if fresh { 0.5 * torque } else { (1.0 - decay) * 0.5 * torque };
        }
        unobserved.iter_mut().zip(&self.decay).for_each(|(unobserved, decay)| *unobserved *= decay);
        if fresh {
            let change = lagged.iter().zip(&self.before_gap);
            unobserved.iter_mut().zip(change).for_each(|(sum, (now, before))| *sum += (now - before).abs());
        }
    }

    /// External wrenches: (force, moment) on the robot at each sensor's origin, world axes (N, Nm), the mean since the
    /// last tick behind the low-pass, if any; none where a sensor is left out.
    pub fn external(&self) -> &[Option<Vector6<f64>>] {
        &self.external
    }

    /// A sensor's `J(S)^T F_ext,S` as the momentum observer knows it by now `(nv,)`.
    pub fn lagged_torque(&self, sensor: usize) -> &[f64] {
        &self.lagged[sensor]
    }

    /// Bounds how far [`WrenchObserver::lagged_torque`] is ahead of the momentum observer after a gap `(nv,)`, for a force
    /// that changed once meanwhile, or has been there from the start.
    pub fn unobserved_torque(&self, sensor: usize) -> &[f64] {
        &self.unobserved[sensor]
    }

    /// Which sensors are in use.
    pub fn usable(&self) -> &[bool] {
        &self.usable
    }

    /// Forgets all ticks.
    pub fn reset(&mut self) {
        self.reference = None;
        self.had_reading.fill(false);
        self.external.fill(Some(Vector6::zeros()));
        self.lagged.iter_mut().for_each(|row| row.fill(0.0));
        self.unobserved.iter_mut().for_each(|row| row.fill(0.0));
        self.usable.fill(true);
        self.changed = false;
    }
}

/// What a reading says the sensor carries: world axes, about the fixed point.
fn load(
    kinematics: &Kinematics,
    tree: &SensorTree,
    sensor: usize,
    reading: &[f64; 6],
    shift: &Vector3<f64>,
) -> Spatial {
    let [force, moment] = tree.exerted(kinematics, sensor, reading);
    let at = tree.position(kinematics, sensor) + shift;
    stack(&force, &(moment + at.cross(&force)))
}

/// The gain of the wrenches' low-pass (1/s), by default from the momentum observer's `gain` and time step `dt` (s).
fn check_wrench_gain(gain: &[f64], wrench_gain: Option<f64>, dt: f64) -> Result<f64> {
    let slowest = gain.iter().copied().fold(f64::INFINITY, f64::min);
    let default = if slowest * dt < FAST { slowest } else { f64::INFINITY };
    let wrench_gain = wrench_gain.unwrap_or(default);
    if wrench_gain.is_nan() || wrench_gain <= 0.0 {
        return Err(Error::input("wrench_gain", format!("must be positive [1/s], not {wrench_gain}")));
    }
    Ok(wrench_gain)
}
