//! Observer, bias, detection and isolation on one kinematics pass.

use std::sync::Arc;

use super::bias::BiasTracker;
use super::release::ReleaseDetector;
use super::sensing::Sensing;
use nalgebra::Vector6;

use crate::detection::Detector;
use crate::error::{Error, Result};
use crate::isolation::{ContactIsolator, Isolation, IsolatorOptions};
use crate::observer::MomentumObserver;
use crate::robot::Robot;
use crate::sensor::{is_known, SensorTree};

/// Settings of a [`ContactMonitor`].
#[derive(Debug, Clone)]
pub struct MonitorOptions {
    /// Time between two calls [s].
    pub dt: f64,
    /// Per velocity variable, or one for all [1/s].
    pub observer_gain: Vec<f64>,
    /// Of the low-pass on the sensors' external wrenches [1/s], infinite for no low-pass. If none, the
    /// observer's smallest, and no low-pass where that is at least half the tick rate.
    pub wrench_gain: Option<f64>,
    /// Thresholds, number of contacts, pushing, sensors.
    pub isolation: IsolatorOptions,
    /// A signal stays on for this time after it was last over its threshold [s].
    pub hold_time: f64,
    /// Time constant of the bias that is tracked while nothing touches [s]; none for no tracking.
    pub bias_time_constant: Option<f64>,
    /// With bias tracking: a torque that stands still for this long is no contact, whatever its size [s]; none: a
    /// contact may last for ever.
    pub bias_settle_time: Option<f64>,
}

impl MonitorOptions {
    /// The defaults, for calls every `dt` [s].
    pub fn new(dt: f64) -> Self {
        Self {
            dt,
            observer_gain: vec![50.0],
            wrench_gain: None,
            isolation: IsolatorOptions {
                torque_threshold: vec![0.5],
                wrench_threshold: vec![2.0],
                ..IsolatorOptions::default()
            },
            hold_time: 0.02,
            bias_time_constant: None,
            bias_settle_time: None,
        }
    }
}

/// What the monitor says of one tick.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ContactReport {
    /// Since the first call [s].
    pub time: f64,
    /// Whether there is a contact.
    pub collision: bool,
    /// Whether it began with this tick.
    pub onset: bool,
    /// Region that detection alone gives: indices into [`Robot::links`].
    pub links: Vec<usize>,
    /// Bias-free external torque of all contacts `(nv,)`.
    pub external_torque: Vec<f64>,
    /// The same without wanted contacts (Vorndamme 2017, eq. 20), zero where joints are left out `(nv,)`.
    pub collision_torque: Vec<f64>,
    /// External wrench that each sensor sees, world axes, at its origin; NaN where one is left out [N, Nm].
    pub wrenches: Vec<Vector6<f64>>,
    /// Indices of the sensors without a reading.
    pub sensors_left_out: Vec<usize>,
    /// Indices of the joints whose torques a wanted contact loads unmeasured: behind its sensor, and on the way there
    /// from the base while the sensor gives no reading, and until the observer has forgotten that gap.
    pub joints_left_out: Vec<usize>,
    /// Estimated acceleration `(nv,)`.
    pub acceleration: Vec<f64>,
    /// The contacts.
    pub isolation: Isolation,
}

/// The sense of touch of one robot, called once a control tick.
#[derive(Debug, Clone)]
pub struct ContactMonitor {
    robot: Arc<Robot>,
    dt: f64,
    observer: MomentumObserver,
    bias: Option<BiasTracker>,
    release: ReleaseDetector,
    detector: Detector,
    isolator: ContactIsolator,
    sensing: Option<Sensing>,
    ticks: u64,
    external_torque: Vec<f64>,
    collision_torque: Vec<f64>,
}

impl ContactMonitor {
    /// A monitor for a robot.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the option.
    pub fn new(robot: Arc<Robot>, options: &MonitorOptions) -> Result<Self> {
        let nv = robot.nv();
        if let Some(time) = options.bias_settle_time.filter(|time| !(time.is_finite() && *time > 0.0)) {
            return Err(Error::Input(format!(
                "bias_settle_time: must be positive and finite [s], or none, not {time}"
            )));
        }
        let observer =
            MomentumObserver::new(robot.clone(), options.dt, &options.observer_gain).map_err(|error| {
                match error {
                    Error::Input(text) if text.starts_with("gain") => {
                        Error::Input(format!("observer_{text}"))
                    }
                    other => other,
                }
            })?;
        let tree = SensorTree::new(&robot, &options.isolation.sensors)?;
        let threshold = &options.isolation.torque_threshold;
        let detector = Detector::with_sensors(
            robot.clone(),
            threshold,
            &tree,
            &options.isolation.wrench_threshold,
            options.hold_time,
        )?;
        let sensing = Sensing::new(
            &robot,
            tree,
            &options.isolation.wanted_contacts,
            observer.gain(),
            options.wrench_gain,
            options.dt,
        )?;
        Ok(Self {
            observer,
            detector,
            sensing: (!options.isolation.sensors.is_empty()).then_some(sensing),
            bias: options.bias_time_constant.map(|constant| BiasTracker::new(nv, constant)).transpose()?,
            release: ReleaseDetector::new(nv, options.bias_settle_time),
            isolator: ContactIsolator::new(robot.clone(), &options.isolation)?,
            dt: options.dt,
            ticks: 0,
            external_torque: vec![0.0; nv],
            collision_torque: vec![0.0; nv],
            robot,
        })
    }

    /// One control tick. `tau` and `friction` are `(nv,)`, or `(nv - 6,)` for a floating base; `wrenches` the sensors'
    /// readings, a NaN where one has none. Without sensors there are none.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the argument; the state is then unchanged.
    pub fn update(
        &mut self,
        q: &[f64],
        v: &[f64],
        tau: &[f64],
        friction: Option<&[f64]>,
        wrenches: Option<&[[f64; 6]]>,
    ) -> Result<()> {
        self.check_wrenches(wrenches)?;
        let first = self.ticks == 0;
        self.external_torque.copy_from_slice(self.observer.update(q, v, tau, friction, None)?);
        self.ticks += 1;
        self.collision_torque.copy_from_slice(&self.external_torque);
        if let (Some(sensing), Some(readings)) = (&mut self.sensing, wrenches) {
            sensing.update(&self.observer, readings, self.dt);
            let wanted = sensing.wanted_torque();
            self.collision_torque.iter_mut().zip(wanted).for_each(|(torque, wanted)| *torque -= wanted);
        }
        let ready = self.remove_bias(first);
        if ready {
            let unwanted = self.sensing.as_ref().map_or(&[][..], Sensing::unwanted);
            self.detector.update_sensed(&self.collision_torque, unwanted, self.dt);
        }
        if self.detector.collision() {
            self.isolate();
        } else {
            self.isolator.clear();
        }
        Ok(())
    }

    /// The contacts behind the torque and the wrenches.
    fn isolate(&mut self) {
        let kinematics = self.observer.kinematics();
        match &self.sensing {
            Some(sensing) => {
                let (wrenches, lag) = (sensing.trusted(), Some(sensing.wrenches()));
                self.isolator.isolate_at(kinematics, &self.external_torque, wrenches, lag);
            }
            None => {
                self.isolator.isolate_at(kinematics, &self.external_torque, &[], None);
            }
        }
    }

    fn check_wrenches(&self, wrenches: Option<&[[f64; 6]]>) -> Result<()> {
        match (&self.sensing, wrenches) {
            (Some(sensing), Some(wrenches)) => sensing.check_readings(wrenches),
            (Some(sensing), None) => sensing.check_readings(&[]),
            (None, Some(rows)) if !rows.is_empty() => {
                Err(Error::Input("wrenches: the monitor was made without sensors".into()))
            }
            (None, _) => Ok(()),
        }
    }

    /// Subtracts the bias, which follows the collision torque while nothing touches. False during its first average.
    fn remove_bias(&mut self, first: bool) -> bool {
        let Self { bias, sensing, detector, release, collision_torque, external_torque, dt, .. } = self;
        let Some(bias) = bias else {
            leave_out(sensing, collision_torque, None);
            return true;
        };
        // A joint that is left out has no torque to follow.
        leave_out(sensing, collision_torque, Some(bias.bias()));
        let ready = bias.ready();
        let threshold = detector.threshold();
        let over = |((torque, bias), threshold): ((&f64, &f64), &f64)| (torque - bias).abs() > *threshold;
        let felt = sensing.as_ref().is_some_and(|sensing| {
            let mut wrenches = sensing.unwanted().iter().enumerate();
            wrenches.any(|(sensor, wrench)| detector.is_wrench_over(sensor, wrench))
        });
        let touched = ready
            && (detector.collision()
                || felt
                || collision_torque.iter().zip(bias.bias()).zip(threshold).any(over));
        if touched {
            // A sensor that feels a contact knows better than a torque that stands still.
            if release.update(collision_torque, bias.bias(), threshold, *dt) && !felt {
                bias.set(release.remainder());
                release.reset();
                detector.reset();
            }
        } else {
            release.reset();
            // The first call has no torque yet.
            if !first {
                bias.follow(collision_torque, *dt);
            }
        }
        for torque in [collision_torque, external_torque] {
            torque.iter_mut().zip(bias.bias()).for_each(|(torque, bias)| *torque -= bias);
        }
        ready
    }

    /// The last tick's report.
    pub fn report(&mut self) -> ContactReport {
        let mut report = ContactReport::default();
        self.report_into(&mut report);
        report
    }

    /// Writes the last tick's report into `report`, whose buffers are reused.
    pub fn report_into(&mut self, report: &mut ContactReport) {
        report.time = self.time();
        report.collision = self.detector.collision();
        report.onset = self.detector.onset();
        report.links.clear();
        report.links.extend_from_slice(self.detector.links());
        report.external_torque.clone_from(&self.external_torque);
        report.collision_torque.clone_from(&self.collision_torque);
        report.wrenches.clear();
        report.sensors_left_out.clear();
        report.joints_left_out.clear();
        if let Some(sensing) = &self.sensing {
            report.wrenches.extend_from_slice(sensing.external());
            let left_out = |sensor: &usize| !is_known(&sensing.external()[*sensor]);
            report.sensors_left_out.extend((0..sensing.external().len()).filter(left_out));
            let is_blind = |body: &usize| sensing.blind()[self.robot.velocity_range(*body)].contains(&true);
            report.joints_left_out.extend((1..self.robot.body_count()).filter(is_blind).map(|body| body - 1));
        }
        report.acceleration.clear();
        report.acceleration.extend_from_slice(self.observer.acceleration());
        report.isolation.clone_from(self.isolator.isolation());
    }

    /// Forgets all ticks, the bias too.
    pub fn reset(&mut self) {
        self.observer.reset();
        self.detector.reset();
        self.isolator.clear();
        self.external_torque.fill(0.0);
        self.collision_torque.fill(0.0);
        if let Some(sensing) = &mut self.sensing {
            sensing.reset();
        }
        self.ticks = 0;
        self.release.reset();
        if let Some(bias) = &mut self.bias {
            bias.reset();
        }
    }

    /// Since the first call [s].
    pub fn time(&self) -> f64 {
        self.ticks.saturating_sub(1) as f64 * self.dt
    }

    /// The sensors' names.
    pub fn sensor_names(&self) -> &[String] {
        self.sensing.as_ref().map_or(&[], |sensing| sensing.tree().names())
    }

    /// The robot watched.
    pub fn robot(&self) -> &Arc<Robot> {
        &self.robot
    }
}

/// Puts `value`, or zero, for the torques of joints that are left out.
fn leave_out(sensing: &Option<Sensing>, torque: &mut [f64], value: Option<&[f64]>) {
    let Some(sensing) = sensing else { return };
    for (k, torque) in torque.iter_mut().enumerate().filter(|(k, _)| sensing.blind()[*k]) {
        *torque = value.map_or(0.0, |value| value[k]);
    }
}
