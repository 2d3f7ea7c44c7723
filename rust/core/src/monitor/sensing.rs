//! Force/torque sensors in a tick: external wrenches, exclusion of wanted contacts, what is left for detection.

use std::sync::Arc;

use nalgebra::Vector6;

use crate::error::Result;
use crate::isolation::WithoutWanted;
use crate::observer::WrenchObserver;
use crate::observer::{MomentumObserver, Step};
use crate::robot::{Kinematics, Robot};
use crate::sensor::{check_readings, exclude_wanted, leave_out_blind, SensorTree};

/// A wanted sensor that comes back is trusted after so many time constants of the observer, which by then has
/// forgotten what the sensor missed of a force that came and went.
const SETTLING: f64 = 5.0;
/// And once what the observer does not know yet of a force that came and stayed is below this share of every joint's
/// threshold: of the weight of a humanoid on its feet, e^-5 is still over it.
const UNOBSERVED: f64 = 0.1;

/// The sensors of a monitor.
#[derive(Debug, Clone)]
pub(super) struct Sensing {
    wrenches: WrenchObserver,
    /// Sensors in use.
    tree: SensorTree,
    wanted: Vec<bool>,
    /// How long a wanted sensor stays untrusted after a gap (s).
    settling_time: f64,
    unsettled: Vec<f64>,
    /// Whether a sensor has been read for long enough to be trusted in full; of those that are not wanted it is not asked.
    settled: Vec<bool>,
    wanted_torque: Vec<f64>,
    /// Velocity variables that wanted contacts alone load: behind wanted sensors, and at the same joint.
    behind_wanted: Vec<bool>,
    blind: Vec<bool>,
    /// Of each sensor: its external wrench without wanted contacts.
    unwanted: Vec<Option<Vector6<f64>>>,
    trusted: Vec<Option<Vector6<f64>>>,
}

impl Sensing {
    /// `wanted` names sensors; `gain` `(nv,)` and `dt` are the observer's, `wrench_gain` is of the wrenches' low-pass.
    pub fn new(
        robot: &Arc<Robot>,
        tree: SensorTree,
        wanted: &[String],
        gain: &[f64],
        wrench_gain: Option<f64>,
        dt: f64,
    ) -> Result<Self> {
        let is_wanted = tree.wanted(wanted)?;
        let mut behind_wanted = vec![false; gain.len()];
        leave_out_blind(robot, &tree, &is_wanted, |_| true, &mut behind_wanted);
        Ok(Self {
            wrenches: WrenchObserver::new(robot.clone(), &tree, gain, wrench_gain, dt)?,
            settling_time: settling_time(gain),
            unsettled: vec![0.0; tree.len()],
            settled: vec![true; tree.len()],
            wanted_torque: vec![0.0; gain.len()],
            blind: behind_wanted.clone(),
            behind_wanted,
            unwanted: vec![Some(Vector6::zeros()); tree.len()],
            trusted: vec![Some(Vector6::zeros()); tree.len()],
            wanted: is_wanted,
            tree,
        })
    }

    /// Other gains, as in [`Sensing::new`].
    pub fn set_gain(&mut self, gain: &[f64], wrench_gain: Option<f64>) -> Result<()> {
        self.wrenches.set_gain(gain, wrench_gain)?;
        self.settling_time = settling_time(gain);
        Ok(())
    }

    /// As [`WrenchObserver::set_robot`].
    pub fn set_robot(&mut self, robot: &Arc<Robot>) {
        self.wrenches.set_robot(robot, &self.tree);
    }

    /// The wanted contacts' torque is that of an observer of this gain `(nv,)` from the next step on; the wrenches' low-pass
    /// stays.
    pub fn follow_gain(&mut self, gain: &[f64]) {
        self.wrenches.set_torque_gain(|k| gain[k]);
        self.settling_time = settling_time(gain);
    }

    /// The same for an external torque that comes without an observer's lag.
    pub fn follow_without_lag(&mut self) {
        self.wrenches.set_torque_gain(|_| f64::INFINITY);
        self.settling_time = 0.0;
    }

    /// A step of nominally `dt` (s), after the observer's, with checked readings and the joints' thresholds `(nv,)`.
    pub fn update(
        &mut self,
        observer: &MomentumObserver,
        readings: &[Option<[f64; 6]>],
        threshold: &[f64],
        step: Step,
        dt: f64,
    ) {
        self.wrenches.update(observer.kinematics(), &self.tree, readings, step);
        self.tree.set_active(self.wrenches.usable());
        // Over a gap the observer forgets nothing.
        let forgetting = if step.is_gap() { 0.0 } else { step.length(dt) };
        self.find_blind(observer.robot(), threshold, forgetting);
        self.exclude(observer.kinematics());
        for (sensor, trusted) in self.trusted.iter_mut().enumerate() {
            *trusted = self.wrenches.external()[sensor].filter(|_| self.settled[sensor]);
        }
    }

    /// As [`crate::sensor::LoadCompensator::check_readings`].
    pub fn check_readings(&self, wrenches: &[Option<[f64; 6]>]) -> Result<()> {
        check_readings(&self.tree, wrenches)
    }

    /// External wrenches of all sensors, none where one is left out.
    pub fn external(&self) -> &[Option<Vector6<f64>>] {
        self.wrenches.external()
    }

    /// The same without wanted contacts: zero at a wanted sensor, none where it is not known.
    pub fn unwanted(&self) -> &[Option<Vector6<f64>>] {
        &self.unwanted
    }

    /// The wanted contacts' torque behind the observer's low-pass `(nv,)`.
    pub fn wanted_torque(&self) -> &[f64] {
        &self.wanted_torque
    }

    /// Which velocity variables a wanted contact may load that no sensor measures `(nv,)`.
    pub fn blind(&self) -> &[bool] {
        &self.blind
    }

    /// A sensor's external wrench as it adds to the sensor's reading: its own axes and convention; none where it is left out.
    pub fn external_reading(&self, kinematics: &Kinematics, sensor: usize) -> Option<Vector6<f64>> {
        let wrench = self.wrenches.external()[sensor].as_ref()?;
        Some(self.tree.reading(kinematics, sensor, wrench))
    }

    /// Adds to the offset of a sensor what its external wrench showed; that is zero from now on.
    pub fn add_offset(&mut self, sensor: usize, reading: &Vector6<f64>) {
        let offset = Vector6::from(self.tree.sensors()[sensor].offset) + reading;
        self.tree.set_offset(sensor, offset.into());
        self.wrenches.clear(sensor);
    }

    /// Whether contacts behind a sensor are wanted.
    pub fn has_wanted(&self) -> bool {
        self.wanted.contains(&true)
    }

    /// What is measured without wanted contacts.
    pub fn without_wanted(&self) -> WithoutWanted<'_> {
        WithoutWanted { unwanted: &self.unwanted, all: &self.trusted, blind: &self.blind }
    }

    /// The sensors, those with a reading active.
    pub fn tree(&self) -> &SensorTree {
        &self.tree
    }

    /// External wrenches of all sensors, none where one is left out, or is wanted and not settled.
    pub fn trusted(&self) -> &[Option<Vector6<f64>>] {
        &self.trusted
    }

    /// The observer of the sensors' wrenches, which knows their torques, too.
    pub fn wrenches(&self) -> &WrenchObserver {
        &self.wrenches
    }

    /// Forgets all ticks.
    pub fn reset(&mut self) {
        self.wrenches.reset();
        self.tree.set_active(self.wrenches.usable());
        self.unsettled.fill(0.0);
        self.settled.fill(true);
        self.wanted_torque.fill(0.0);
        self.blind.copy_from_slice(&self.behind_wanted);
        self.unwanted.fill(Some(Vector6::zeros()));
        self.trusted.fill(Some(Vector6::zeros()));
    }

    /// Joints that a wanted contact may load unmeasured.
    fn find_blind(&mut self, robot: &Robot, threshold: &[f64], dt: f64) {
        for sensor in (0..self.tree.len()).filter(|sensor| self.wanted[*sensor]) {
            let unsettled = &mut self.unsettled[sensor];
            *unsettled = if self.tree.is_active(sensor) { *unsettled - dt } else { self.settling_time };
            let mut unobserved = self.wrenches.unobserved_torque(sensor).iter().zip(threshold);
            self.settled[sensor] =
                *unsettled <= 0.0 && unobserved.all(|(torque, threshold)| *torque <= UNOBSERVED * threshold);
        }
        let Self { tree, wanted, settled, blind, .. } = self;
        leave_out_blind(robot, tree, wanted, |sensor| settled[sensor], blind);
    }

    /// Eq. 20 for the torque, and the same for the wrenches of sensors nearer to the base.
    fn exclude(&mut self, kinematics: &Kinematics) {
        let Self { tree, wanted, settled, wrenches, unwanted, wanted_torque, .. } = self;
        wanted_torque.fill(0.0);
        let is_trusted = |sensor: usize| settled[sensor];
        exclude_wanted(kinematics, tree, wanted, is_trusted, wrenches.external(), unwanted, |sensor, _| {
            let lagged = wrenches.lagged_torque(sensor);
            wanted_torque.iter_mut().zip(lagged).for_each(|(sum, torque)| *sum += torque);
        });
    }
}

/// How long a wanted sensor stays untrusted after a gap (s), with the observer's `gain` `(nv,)` (1/s).
fn settling_time(gain: &[f64]) -> f64 {
    SETTLING / gain.iter().copied().fold(f64::INFINITY, f64::min)
}
