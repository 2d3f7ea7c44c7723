//! Follows the contacts of a monitor's reports and says what kind each is.

use std::collections::VecDeque;
use std::sync::Arc;

use super::class::ContactClass;
use super::followed::{Followed, Instant, ONSET};
use super::levers::levers;
use super::logits::judge;
use super::prior::{prior, ClassifierOptions};
use crate::error::{Error, Result};
use crate::isolation::Contact;
use crate::monitor::ContactReport;
use crate::robot::jacobian::for_each_column;
use crate::robot::{Kinematics, Robot};
use crate::sample::check_time_step;
use crate::spatial::vector::split;

/// Contacts that are followed at a time.
const MOST: usize = 8;
/// A contact that is not reported for so long has ended; a robot that bounces is back by then (s).
const ENDED: f64 = 0.1;
/// Instants that are kept from before an onset, at most.
const MOST_INSTANTS: usize = 1000;

/// Says of each contact that a monitor reports whether it is clamped, transient or sustained, and whether it is intended.
/// It is no safety function.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::classification::{ClassifierOptions, ContactClassifier};
/// use contactsense::monitor::{ContactMonitor, MonitorOptions};
/// use contactsense::robot::Robot;
/// use contactsense::Sample;
///
/// let robot = Arc::new(Robot::example_arm());
/// let (q, v) = (vec![0.4; 7], vec![0.0; 7]);
/// let weight = robot.inverse_dynamics(&q, &v, &v)?;
/// let mut monitor = ContactMonitor::new(robot.clone(), &MonitorOptions::new(1e-3))?;
/// let mut classifier = ContactClassifier::new(robot, &ClassifierOptions::default())?;
/// for tick in 0..600 {
///     // Somebody presses on the arm at rest.
///     let push = (f64::from(tick) / 300.0).min(1.0) * 8.0;
///     let tau: Vec<f64> = weight.iter().map(|tau| tau - push).collect();
///     let report = monitor.update(&Sample::new(&q, &v, &tau))?;
///     classifier.update(&q, &v, report)?;
/// }
/// let [contact] = classifier.classes() else { panic!("one contact") };
/// assert!(contact.running && contact.features.approach_speed == 0.0);
/// assert!((contact.clamped + contact.transient + contact.sustained - 1.0).abs() < 1e-12);
/// assert_eq!(classifier.reported(), [(0, Some(0))]);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ContactClassifier {
    robot: Arc<Robot>,
    kinematics: Kinematics,
    dt: f64,
    /// Added to the logits for another prior than that of the weights.
    prior: [f64; 4],
    /// Greatest lever of each velocity variable (m, or 1 where its torque is a force).
    levers: Vec<f64>,
    /// Newest last: what was before a contact.
    instants: VecDeque<Instant>,
    velocities: VecDeque<f64>,
    kept: usize,
    oldest: Vec<f64>,
    torque: Vec<f64>,
    followed: Vec<Followed>,
    /// The first of `followed` are in use.
    count: usize,
    /// Contacts since the last reset.
    begun: u64,
    time: Option<f64>,
    classes: Vec<ContactClass>,
    reported: Vec<(u64, Option<usize>)>,
}

impl ContactClassifier {
    /// For the contacts of one robot.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the option.
    pub fn new(robot: Arc<Robot>, options: &ClassifierOptions) -> Result<Self> {
        robot.check_moves()?;
        check_time_step(options.dt)?;
        let nv = robot.nv();
        let kept = ((ONSET / options.dt).ceil() as usize).clamp(1, MOST_INSTANTS);
        Ok(Self {
            kinematics: Kinematics::new(&robot),
            dt: options.dt,
            prior: prior(options)?,
            levers: levers(&robot),
            instants: VecDeque::with_capacity(kept + 1),
            velocities: VecDeque::with_capacity((kept + 1) * nv),
            kept,
            oldest: vec![0.0; nv],
            torque: vec![0.0; nv],
            followed: vec![Followed::with_room(nv); MOST],
            count: 0,
            begun: 0,
            time: None,
            classes: Vec::with_capacity(MOST),
            reported: Vec::with_capacity(MOST),
            robot,
        })
    }

    /// Takes in a tick: `q` and `v` as the monitor got them, and its report. Returns the contacts that run, and those that have
    /// ended with this tick.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the argument; the state is then unchanged.
    pub fn update(&mut self, q: &[f64], v: &[f64], report: &ContactReport) -> Result<&[ContactClass]> {
        self.robot.check_configuration(q)?;
        self.robot.check_tangent("v", v)?;
        if report.collision_torque.len() != self.robot.nv() {
            return Err(Error::input("report", "must be of a monitor of the same robot"));
        }
        let step = match self.time {
            Some(time) if report.time > time => (report.time - time).min(ENDED),
            Some(_) => 0.0,
            None => self.dt,
        };
        self.time = Some(report.time);
        self.classes.clear();
        self.reported.clear();
        let whole = self.instant(&report.collision_torque, v, step);
        if report.collision {
            self.take_in(q, v, report, whole);
        } else {
            self.remember(whole, v);
        }
        self.conclude(report.time);
        Ok(&self.classes)
    }

    /// What the last tick said.
    pub fn classes(&self) -> &[ContactClass] {
        &self.classes
    }

    /// Of each of [`classes`](Self::classes): which contact it is, counted from 0 since the last reset, and its place among the
    /// contacts of the report, if the report had it. The number stays where a contact goes on under another `id`.
    pub fn reported(&self) -> &[(u64, Option<usize>)] {
        &self.reported
    }

    /// Forgets all contacts.
    pub fn reset(&mut self) {
        self.count = 0;
        self.begun = 0;
        self.time = None;
        self.reported.clear();
        self.instants.clear();
        self.velocities.clear();
        self.classes.clear();
    }

    /// The robot.
    pub fn robot(&self) -> &Arc<Robot> {
        &self.robot
    }

    fn instant(&self, torque: &[f64], v: &[f64], step: f64) -> Instant {
        let squares = torque.iter().zip(&self.levers).map(|(torque, lever)| (torque / lever).powi(2));
        let power = torque.iter().zip(v).map(|(torque, v)| torque * v).sum();
        Instant { force: squares.sum::<f64>().sqrt(), power, step }
    }

    fn remember(&mut self, instant: Instant, v: &[f64]) {
        if self.instants.len() == self.kept {
            self.instants.pop_front();
            self.velocities.drain(..v.len());
        }
        self.instants.push_back(instant);
        self.velocities.extend(v);
    }

    fn take_in(&mut self, q: &[f64], v: &[f64], report: &ContactReport, whole: Instant) {
        let contacts = &report.isolation.contacts;
        let several = contacts.len() > 1 && contacts.iter().all(|each| each.wrench.is_some());
        if !several {
            // One, or several whose torques are not known apart: all of the torque is of the first.
            let id = contacts.first().and_then(|contact| contact.track.as_ref()).map(|track| track.id);
            if let Some(which) = self.find(id, contacts.len() < 2, report.time, v) {
                let place = (!contacts.is_empty()).then_some(0);
                self.followed[which].take_in(whole, &report.collision_torque, report.time, place);
            }
            return;
        }
        self.kinematics.set_configuration(&self.robot, q);
        for (place, contact) in contacts.iter().enumerate() {
            self.set_torque(contact);
            let instant = self.instant(&self.torque, v, whole.step);
            let id = contact.track.as_ref().map(|track| track.id);
            if let Some(which) = self.find(id, false, report.time, v) {
                self.followed[which].take_in(instant, &self.torque, report.time, Some(place));
            }
        }
    }

    /// The torque of one contact.
    fn set_torque(&mut self, contact: &Contact) {
        let Self { robot, kinematics, torque, .. } = self;
        torque.fill(0.0);
        let Some(wrench) = contact.wrench else { return };
        let (force, moment) = split(&wrench);
        let origin = kinematics.link_pose(robot, contact.link).translation - kinematics.origin;
        for_each_column(robot, kinematics, robot[contact.link].body, &origin, |k, column| {
            let (linear, angular) = split(&column);
            torque[k] = linear.dot(&force) + angular.dot(&moment);
        });
    }

    /// The contact with this id; a single one goes on under any. A new one where there is none; none where there is no room.
    fn find(&mut self, id: Option<u64>, alone: bool, time: f64, v: &[f64]) -> Option<usize> {
        let used = &mut self.followed[..self.count];
        let same = |known: &Followed| known.id == id && id.is_some();
        let free = |known: &Followed| known.id.is_none() && known.last < time;
        if let Some(which) = used.iter().position(same).or_else(|| used.iter().position(free)) {
            used[which].id = used[which].id.or(id);
            return Some(which);
        }
        if alone && self.count == 1 {
            self.followed[0].id = id.or(self.followed[0].id);
            return Some(0);
        }
        if self.count == MOST {
            return None;
        }
        let first = self.count == 0 && !self.instants.is_empty();
        if first {
            let oldest = self.velocities.iter().take(v.len());
            self.oldest.iter_mut().zip(oldest).for_each(|(kept, old)| *kept = *old);
        } else {
            self.oldest.copy_from_slice(v);
        }
        let new = &mut self.followed[self.count];
        new.begin(self.begun, id, time, &self.oldest);
        self.begun += 1;
        if first {
            self.instants.iter().for_each(|instant| new.recall(*instant));
        }
        self.count += 1;
        Some(self.count - 1)
    }

    /// Says what each contact is, and drops those that have ended.
    fn conclude(&mut self, time: f64) {
        let mut which = 0;
        while which < self.count {
            let ended = time - self.followed[which].last > ENDED;
            self.classes.push(judge(&self.followed[which], !ended, &self.prior));
            let followed = &mut self.followed[which];
            self.reported.push((followed.number, followed.place.take()));
            if ended {
                self.count -= 1;
                self.followed.swap(which, self.count);
            } else {
                which += 1;
            }
        }
    }
}
