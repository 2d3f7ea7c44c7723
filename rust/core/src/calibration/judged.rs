//! The rows of a log as a model sees them that was fitted without these rows.

use std::sync::Arc;

use super::log::Log;
use super::torque_model::TorqueModel;
use crate::error::Result;
use crate::observer::{MomentumObserver, Step};
use crate::robot::{Kinematics, Robot};
use crate::Sample;

/// The gain of the observer does not matter: its momentum is all that is used (1/s).
const GAIN: f64 = 1.0;

/// A part of a log and the model that was fitted without it.
pub(super) struct Judged {
    /// None where the torques are external ones.
    pub robot: Option<Arc<Robot>>,
    pub torque: TorqueModel,
    pub rows: std::ops::Range<usize>,
}

/// What a row of a log tells.
pub(super) struct Told<'a> {
    pub kinematics: &'a Kinematics,
    pub velocity: &'a [f64],
    /// The rate of the momentum without external torque; none where torques are external ones.
    pub known_rate: Option<&'a [f64]>,
    /// The external torque before any low-pass; none in the first row of a stretch.
    pub unexplained: Option<&'a [f64]>,
    /// Since the row before (s).
    pub dt: f64,
    pub starts: bool,
}

impl Judged {
    /// Calls `told` with each row without contact.
    pub fn each_row(
        &self,
        robot: &Arc<Robot>,
        log: &Log<'_>,
        skipped: &[bool],
        step: f64,
        mut told: impl FnMut(&Told<'_>),
    ) -> Result<()> {
        let source = self.robot.as_ref().unwrap_or(robot);
        let mut observer = MomentumObserver::new(Arc::clone(source), step, &[GAIN])?;
        let mut torque = self.torque.clone();
        let mut q = vec![0.0; robot.nq()];
        let (mut v, mut tau) = (vec![0.0; robot.nv()], vec![0.0; robot.nv()]);
        let mut starts = true;
        for index in self.rows.clone() {
            let first = index == self.rows.start;
            let dt = if first { step } else { log.time[index] - log.time[index - 1] };
            if skipped[index] || dt > super::LONGEST_STEPS * step {
                observer.reset();
                torque.reset();
                starts = true;
                continue;
            }
            tau.copy_from_slice(log.tau_of(index));
            v.copy_from_slice(log.v_of(robot, index));
            torque.correct(if starts { 0.0 } else { dt }, &mut v, &mut tau);
            q.copy_from_slice(log.q_of(robot, index));
            robot.advance_configuration(&mut q, &v, -torque.delay());
            observer.advance(&Sample::new(&q, &v, &tau), Step::Of(dt));
            let unexplained = match self.robot {
                Some(_) => observer.unexplained(),
                None => Some(&tau[..]).filter(|_| !starts),
            };
            let known_rate = self.robot.as_ref().and_then(|_| observer.known_rate());
            told(&Told {
                known_rate,
                kinematics: observer.kinematics(),
                velocity: &v,
                unexplained,
                dt,
                starts,
            });
            starts = false;
        }
        Ok(())
    }
}
