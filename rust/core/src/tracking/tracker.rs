//! Follows a contact from its onset to its end, and fuses what its torques say of the place (algorithm D4).

use std::sync::Arc;

use super::evidence::TickEvidence;
use super::identities::Identities;
use crate::isolation::{Isolation, SurfaceContact, TorqueNow, LEFT_OUT};
use crate::robot::Robot;

/// Time between two measurements of a contact (s), and between those that are kept as a share of the contact's age: so they are
/// spread over all of it. The newest one is replaced by the next until then, so that a contact that moves is followed.
const INTERVAL: f64 = 0.025;
const INTERVAL_SHARE: f64 = 0.25;
/// A torque that is less than this share of the strongest one of the contact, in standard deviations, tells little.
const STRONG: f64 = 0.6;
/// One that is weak for longer is not that of a contact that ends (s): it may have moved to where it causes less torque.
const LASTING: f64 = 0.25;
/// One that is so many times as large tells more at once.
const GROWN: f64 = 1.3;

/// Follows contacts.
#[derive(Debug, Clone)]
pub(crate) struct ContactTracker {
    robot: Arc<Robot>,
    surface: SurfaceContact,
    identities: Identities,
    /// Standard deviations of a tick's torque without contact (Nm, N).
    deviation: Vec<f64>,
    /// Of the onset, or when the contact moved to another place, and of the last measurement (s); none without contact.
    since: Option<f64>,
    measured: f64,
    /// When the last one was measured that is kept (s).
    kept: f64,
    /// Whether the contact has moved to a place that no answer has shown yet.
    is_elsewhere: bool,
    /// Norm of the torque over its standard deviations: of this tick, the greatest of the measurements, and of those that
    /// the place is from.
    strength: f64,
    strongest: f64,
    concluded: f64,
}

impl ContactTracker {
    /// Follows what the posterior over all surface finds.
    pub fn new(robot: Arc<Robot>, surface: SurfaceContact) -> Self {
        ContactTracker {
            identities: Identities::new(),
            deviation: vec![1.0; surface.rows()],
            surface,
            since: None,
            measured: 0.0,
            kept: 0.0,
            is_elsewhere: false,
            strength: 0.0,
            strongest: 0.0,
            concluded: 0.0,
            robot,
        }
    }

    /// A tick with contact: takes in its evidence, and puts the posterior's answer in place of what closed forms found, where
    /// one contact explains the torques.
    pub fn follow(&mut self, evidence: &TickEvidence<'_>, isolation: &mut Isolation) {
        self.weigh(evidence);
        self.take_in(evidence);
        if self.surface.step() {
            self.concluded = self.strongest;
            if self.surface.is_elsewhere() {
                (self.since, self.is_elsewhere) = (Some(evidence.time), true);
            }
        }
        let outdated = self.strength > GROWN * self.concluded;
        let now = TorqueNow {
            kinematics: evidence.kinematics,
            torque: evidence.newest,
            deviation: &self.deviation,
        };
        self.surface.answer(&now, outdated, isolation);
        let TickEvidence { kinematics, time, .. } = *evidence;
        self.identities.name(isolation, &self.robot, kinematics, self.is_elsewhere, time);
        self.is_elsewhere &= !isolation.contacts.iter().any(|contact| contact.posterior.is_some());
    }

    /// A tick without contact.
    pub fn rest(&mut self) {
        if self.since.take().is_some() {
            self.surface.forget();
            self.identities.end();
            self.is_elsewhere = false;
        }
    }

    /// Forgets all contacts.
    pub fn reset(&mut self) {
        self.rest();
        self.identities.reset();
    }

    /// Keeps a measurement from time to time.
    fn take_in(&mut self, evidence: &TickEvidence<'_>) {
        let age = evidence.time - *self.since.get_or_insert(evidence.time);
        let first = age == 0.0;
        let shares =
            evidence.torque.iter().zip(&self.deviation).map(|(torque, deviation)| torque / deviation);
        let strength = shares.map(|share| share * share).sum::<f64>().sqrt();
        self.strength = strength;
        let grown = strength > GROWN * self.strongest;
        let due = evidence.time - self.measured >= INTERVAL || grown;
        let is_weak = strength < STRONG * self.strongest;
        let ends = is_weak && evidence.time - self.measured < LASTING;
        if !first && (!self.surface.is_done() || !due || ends) {
            return;
        }
        if first || self.strongest < STRONG * strength {
            self.surface.begin();
        }
        self.strongest = if first || is_weak { strength } else { self.strongest.max(strength) };
        self.measured = evidence.time;
        let keep = first || grown || evidence.time - self.kept >= INTERVAL_SHARE * age;
        if keep {
            self.kept = evidence.time;
        }
        let TickEvidence { kinematics, torque, .. } = *evidence;
        self.surface.measure(&TorqueNow { kinematics, torque, deviation: &self.deviation }, keep);
    }

    /// Standard deviations without contact.
    fn weigh(&mut self, evidence: &TickEvidence<'_>) {
        for (k, deviation) in self.deviation.iter_mut().enumerate() {
            let left_out = evidence.left_out.get(k).copied().unwrap_or(false);
            *deviation = evidence.deviation[k] * if left_out { LEFT_OUT } else { 1.0 };
        }
    }
}
