//! What is wrong with a robot's model or measurements, from motion without contact.
//!
//! Positions and velocities are compared first, which needs no model. Then every fault of the torque or of the model is tried
//! as a hypothesis: a change of the measured torque, or more room for some parameters than a normal arm needs. The one
//! with the largest marginal likelihood is reported and taken out, and the rest looked at again.

mod assignment;
mod columns;
mod evidence;
mod finding;
mod fit;
mod gravity;
mod hypothesis;
mod limit;
mod motion;
mod order;
mod permutation;
mod prior;
mod report;
mod scale;
mod search;
mod sensor_offset;
mod slow_rows;
mod target;
mod terms;
mod time_step;
mod torque_delay;
mod units;
mod unjudged;
mod velocity;

pub use finding::{FaultCode, Finding, Severity};

use crate::error::{Error, Result};
use crate::robot::Robot;
use crate::sensor::ForceTorqueSensor;
use motion::Motion;

/// Fewer rows say nothing.
const LEAST_ROWS: usize = 30;

/// Shorter logs say nothing (s).
const SHORTEST: f64 = 0.2;

/// What is diagnosed: rows without contact, flat arrays of `n` rows each.
///
/// ```
/// use contactsense::diagnosis::{diagnose, Recording};
///
/// let rows = vec![0.0; 7];
/// let recording = Recording { time: None, q: &rows, v: &rows, tau: &rows, sensors: &[], wrenches: &[] };
/// // One row says nothing.
/// assert!(diagnose(&contactsense::robot::Robot::example_arm(), &recording).is_err());
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Recording<'a> {
    /// `(n,)`, increasing (s); without it the rows are taken at equal steps.
    pub time: Option<&'a [f64]>,
    /// `(n, nq)`.
    pub q: &'a [f64],
    /// `(n, nv)`.
    pub v: &'a [f64],
    /// `(n, nv)`, or `(n, nv - 6)` for a floating base (Nm; N for sliding joints).
    pub tau: &'a [f64],
    /// Of the wrenches, in their order.
    pub sensors: &'a [ForceTorqueSensor],
    /// `(n, sensors)` readings (N, Nm), sensor axes; none where a sensor gave none.
    pub wrenches: &'a [Option<[f64; 6]>],
}

/// What is wrong, the most important first; nothing where all is well.
///
/// # Errors
/// [`Error::Input`] names the array that cannot be used.
pub fn diagnose(robot: &Robot, recording: &Recording<'_>) -> Result<Vec<Finding>> {
    let Recording { time, q, v, tau, sensors, wrenches } = *recording;
    let nv = robot.nv();
    if nv == 0 {
        return Err(Error::input("robot", "must have a joint that moves"));
    }
    let n = v.len() / nv;
    let mut findings = vec![];
    let mut q = q.to_vec();
    let mut v = v.to_vec();
    if units::positions_in_degrees(robot, &q) {
        units::to_radians(robot, &mut q);
        let text = "positions seem to be in degrees: give rad, and velocities in rad/s";
        findings.push(units::finding(text, 180.0 / std::f64::consts::PI));
        if let Some(units::Ratio::Degrees) = units::ratio(Motion::slope(robot, time, &q, &v)) {
            v.iter_mut().for_each(|v| *v = v.to_radians());
        } else if time.is_none() {
            v.iter_mut().for_each(|v| *v = v.to_radians());
        }
    }
    check(robot, time, &q, &v, tau, n)?;
    let mut stamps = time.map(<[f64]>::to_vec);
    if time.is_some() && findings.is_empty() {
        match units::ratio(Motion::slope(robot, time, &q, &v)) {
            Some(units::Ratio::Degrees) => {
                let text = "velocities seem to be in degrees per second: give rad/s";
                findings.push(units::finding(text, 180.0 / std::f64::consts::PI));
                v.iter_mut().for_each(|v| *v = v.to_radians());
            }
            Some(units::Ratio::Time(unit, name)) => {
                findings.push(units::finding(
                    &format!("the time seems to be in {name}: give seconds"),
                    1.0 / unit,
                ));
                stamps.iter_mut().flatten().for_each(|time| *time *= unit);
            }
            None => {
                if let Some(finding) = time.and_then(|time| odd_ratio(robot, time, &q, &v)) {
                    return Ok(vec![finding]);
                }
            }
        }
    }
    if let Some(finding) = too_short(robot, stamps.as_deref(), &q, &v) {
        findings.push(finding);
        return Ok(findings);
    }
    let mut motion = Motion::new(robot, stamps.as_deref(), &q, &v, tau);
    let read = Recording { q: &q, v: &v, ..*recording };
    let steps: Option<Vec<f64>> = stamps.or_else(|| {
        let step = Motion::slope(robot, None, &q, &v);
        Some((0..n).map(|row| row as f64 * step).collect())
    });
    let times = if motion.consecutive { steps.as_deref() } else { None };
    findings.extend(sensor_offset::findings(robot, &read, sensors, wrenches, times)?);
    if motion.consecutive {
        findings.extend(velocity::lag(&mut motion));
    } else if !robot.floating_base() {
        findings.push(not_consecutive(&motion, time.is_some()));
    }
    if robot.floating_base() {
        let what = if motion.consecutive { "torques were" } else { "torques and delays were" };
        let text = format!(
            "{what} not judged: with a floating base the forces of the ground are part of the torques"
        );
        findings.push(Finding::new(FaultCode::NotJudged, text));
    } else if let Some(finding) = unjudged::missing_torques(robot, &motion) {
        findings.push(finding);
    } else {
        if let Some((order, finding)) = order::find(robot, &motion) {
            motion = order::reordered(&motion, &order);
            findings.push(finding);
        }
        let limits = limit::at_limits(robot, &motion);
        findings.extend(limit::findings(robot, &motion, &limits));
        findings.extend(search::search(robot, &motion, &limit::rows_at_limits(&limits, motion.len())));
    }
    rank(&mut findings);
    Ok(findings)
}

/// Velocities that follow the positions but for a factor that is no unit's.
fn odd_ratio(robot: &Robot, time: &[f64], q: &[f64], v: &[f64]) -> Option<Finding> {
    let factor = 1.0 / Motion::odd_ratio(robot, time, q, v)?;
    let text = format!(
        "velocities times time are {factor:.4} times the changes of the positions: velocities, positions or time are in \
         other units than SI, and nothing else was judged"
    );
    Some(units::finding(&text, factor))
}

/// Rows that follow each other within a moment, in which no robot moves.
fn too_short(robot: &Robot, time: Option<&[f64]>, q: &[f64], v: &[f64]) -> Option<Finding> {
    let seconds = Motion::seconds(robot, time, q, v).filter(|seconds| *seconds < SHORTEST)?;
    let known = if time.is_some() {
        ""
    } else {
        ", as positions and velocities tell, which may be in other units than SI"
    };
    let text = format!("the log lasts {seconds:.2e} s in all{known}: nothing was judged; record ten seconds");
    Some(Finding::new(FaultCode::NotJudged, text).major_if(true))
}

/// Why delays and rotor inertias cannot be judged.
fn not_consecutive(motion: &Motion, timed: bool) -> Finding {
    let unmoved = motion.v.iter().all(|v| *v == 0.0);
    // Without time, or at rest in pose after pose, rows in any order are no mistake.
    let wrong = timed && !unmoved && !motion.stands_still();
    let text = if motion.stands_still() {
        "the robot does not move: only gravity and constant torques were judged; record ten seconds in which all joints move"
    } else if wrong {
        "velocities do not belong to positions at these times: delays and rotor inertias were not judged, the rest from the \
         slowest rows alone"
    } else {
        "rows do not follow each other in time, or velocities do not belong to positions: delays and rotor inertias were \
         not judged, the rest from the slowest rows alone"
    };
    Finding::new(FaultCode::NotJudged, text.into()).major_if(wrong)
}

/// Major before minor, and among equals what was not judged last; else in the order found, which is that of the evidence.
fn rank(findings: &mut [Finding]) {
    findings
        .sort_by_key(|finding| (finding.severity != Severity::Major, finding.code == FaultCode::NotJudged));
}

fn check(robot: &Robot, time: Option<&[f64]>, q: &[f64], v: &[f64], tau: &[f64], n: usize) -> Result<()> {
    if let Some(time) = time.filter(|time| time.len() != n) {
        return Err(Error::input("time", format!("must have one number a row, {n}, not {}", time.len())));
    }
    let steps: Vec<f64>;
    let time = match time {
        Some(time) => time,
        None => {
            steps = (0..n).map(|row| row as f64).collect();
            &steps
        }
    };
    crate::calibration::Log { time, q, v, tau }.check(robot)?;
    if time.len() < LEAST_ROWS {
        return Err(Error::input("q", format!("must have at least {LEAST_ROWS} rows, not {}", time.len())));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::motion::tests::sines;
    use super::*;

    fn found(q: &[f64], v: &[f64], tau: &[f64]) -> Vec<Finding> {
        let recording = Recording { time: None, q, v, tau, sensors: &[], wrenches: &[] };
        diagnose(&Robot::example_arm(), &recording).expect("a log that can be used")
    }

    #[test]
    fn a_log_without_fault_is_met_with_silence() {
        let (_, q, v, tau) = sines(1e-2, 1500);
        assert_eq!(found(&q, &v, &tau), []);
    }

    #[test]
    fn two_faults_are_named_one_after_the_other() {
        let (_, q, v, mut tau) = sines(1e-2, 1500);
        for row in tau.chunks_exact_mut(7) {
            row[1] *= -1.0;
            row[3] += 4.0;
        }
        let found = found(&q, &v, &tau);
        let named: Vec<_> = found.iter().map(|f| (f.code, f.joint.as_deref(), f.severity)).collect();
        assert_eq!(named.len(), 2, "{found:?}");
        assert!(named.contains(&(FaultCode::Sign, Some("joint_2"), Severity::Major)), "{found:?}");
        assert!(named.contains(&(FaultCode::Bias, Some("joint_4"), Severity::Major)), "{found:?}");
    }

    #[test]
    fn arrays_of_another_length_are_refused() {
        let (_, q, v, tau) = sines(1e-2, 100);
        let short = Recording { time: None, q: &q, v: &v, tau: &tau[7..], sensors: &[], wrenches: &[] };
        let refused = diagnose(&Robot::example_arm(), &short).expect_err("a row is missing");
        assert!(refused.to_string().contains("tau"), "{refused}");
        let few =
            Recording { time: None, q: &q[..70], v: &v[..70], tau: &tau[..70], sensors: &[], wrenches: &[] };
        assert!(diagnose(&Robot::example_arm(), &few).expect_err("ten rows").to_string().contains("30 rows"));
    }
}
