//! Constants that force/torque sensors read too much: what is left of their readings, in their own axes.

use std::sync::Arc;

use nalgebra::{SMatrix, SVector, Vector3, Vector6};

use super::finding::{FaultCode, Finding};
use super::motion::median;
use super::Recording;
use crate::error::{Error, Result};
use crate::robot::{Kinematics, Robot};
use crate::sensor::{ForceTorqueSensor, LoadCompensator};
use crate::spatial::vector::split;

/// Readings looked at: the pose of an arm changes slowly.
const MOST_ROWS: usize = 500;

/// Accelerations are means over so long on both sides (s).
const WINDOW: f64 = 0.03;

/// Offset of a force (N) and of a moment (Nm) that spoils the detection of contacts; half of it is worth a word.
const SPOILING: [f64; 2] = [2.0, 0.25];
const WORTH_A_WORD: f64 = 0.5;

/// What may be fixed behind a sensor in addition: standard deviations of its mass (kg) and first moments (kg m).
const LOAD: [f64; 2] = [1.0, 0.1];

/// Errors are counted up to this many times the usual.
const HUBER: f64 = 2.0;

/// Offset, mass and first moments of what is behind the sensor in addition.
const UNKNOWNS: usize = 10;

/// One finding for each sensor with an offset; `step` is the time between rows, if they follow each other.
pub(super) fn findings(
    robot: &Robot,
    recording: &Recording<'_>,
    sensors: &[ForceTorqueSensor],
    wrenches: &[Option<[f64; 6]>],
    time: Option<&[f64]>,
) -> Result<Vec<Finding>> {
    if sensors.is_empty() {
        return Ok(vec![]);
    }
    let (nq, nv) = (robot.nq(), robot.nv());
    let n = recording.v.len() / nv;
    if wrenches.len() != n * sensors.len() {
        let text = format!("must be ({n}, {}, 6): a reading of every sensor in every row", sensors.len());
        return Err(Error::input("wrenches", text));
    }
    let mut compensator = LoadCompensator::new(Arc::new(robot.clone()), sensors)?;
    let mut kinematics = Kinematics::new(robot);
    let links = sensors.iter().map(|sensor| robot.link(&sensor.link)).collect::<Result<Vec<_>>>()?;
    let step = time.map(|time| median(time.windows(2).map(|pair| pair[1] - pair[0]).collect()));
    let half = step.map_or(0, |step| ((WINDOW / step).round() as usize).clamp(1, n / 4));
    let mut seen: Vec<Vec<(Vector6<f64>, Vector3<f64>)>> = vec![vec![]; sensors.len()];
    for row in (half..n - half).step_by((n / MOST_ROWS).max(1)) {
        let q = &recording.q[row * nq..][..nq];
        let v = &recording.v[row * nv..][..nv];
        let a: Vec<f64> = match time {
            Some(time) => {
                let (before, after) = (row - half, row + half);
                let span = time[after] - time[before];
                (0..nv).map(|k| (recording.v[after * nv + k] - recording.v[before * nv + k]) / span).collect()
            }
            None => vec![0.0; nv],
        };
        kinematics.set_configuration(robot, q);
        let external = compensator.update(q, v, &a, &wrenches[row * sensors.len()..][..sensors.len()])?;
        for (sensor, external) in external.iter().enumerate() {
            if let Some(external) = external {
                let pose = kinematics.link_pose(robot, links[sensor]).compose(&sensors[sensor].pose);
                let (force, moment) = split(external);
                let own = |x: Vector3<f64>| pose.rotation.tr_mul(&x);
                let (force, moment) = (own(force), own(moment));
                let wrench = Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z);
                seen[sensor].push((wrench * sensors[sensor].convention.sign(), own(robot.gravity)));
            }
        }
    }
    Ok(sensors.iter().zip(&seen).filter_map(|(sensor, rows)| finding(sensor, rows)).collect())
}

fn finding(sensor: &ForceTorqueSensor, rows: &[(Vector6<f64>, Vector3<f64>)]) -> Option<Finding> {
    let sign = sensor.convention.sign();
    let offset = offset(rows, sign)?;
    let (force, moment) = split(&offset);
    let size = (force.norm() / SPOILING[0]).max(moment.norm() / SPOILING[1]);
    if size < WORTH_A_WORD {
        return None;
    }
    let scaled = |wrench: &Vector6<f64>| {
        let (force, moment) = split(wrench);
        (force / SPOILING[0]).norm_squared() + (moment / SPOILING[1]).norm_squared()
    };
    let total: f64 = rows.iter().map(|(wrench, _)| scaled(wrench)).sum();
    let left: f64 = rows.iter().map(|(wrench, _)| scaled(&(wrench - offset))).sum();
    let name = &sensor.name;
    let text = format!(
        "sensor '{name}' reads ({:.2}, {:.2}, {:.2}) N and ({:.3}, {:.3}, {:.3}) Nm too much: add it to the \
         `offset` of the sensor",
        force.x, force.y, force.z, moment.x, moment.y, moment.z
    );
    let mut finding = Finding::new(FaultCode::SensorOffset, text);
    finding.sensor = Some(name.clone());
    let by_force = force.norm() / SPOILING[0] >= moment.norm() / SPOILING[1];
    let (value, unit, vector) =
        if by_force { (force.norm(), "N", force) } else { (moment.norm(), "Nm", moment) };
    Some(
        finding
            .sized(value, unit)
            .with_vector(vector.into())
            .explaining(1.0 - left / total)
            .major_if(size > 1.0),
    )
}

/// The constant part of what a sensor reads, beside the weight of what may be fixed behind it; robust against contacts.
fn offset(rows: &[(Vector6<f64>, Vector3<f64>)], sign: f64) -> Option<Vector6<f64>> {
    let mut weights = vec![1.0; rows.len()];
    let mut x = SVector::<f64, UNKNOWNS>::zeros();
    for _ in 0..8 {
        let mut matrix = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::identity() * 1e-9;
        matrix[(6, 6)] = LOAD[0].powi(-2);
        for k in 7..UNKNOWNS {
            matrix[(k, k)] = LOAD[1].powi(-2);
        }
        let mut right = SVector::<f64, UNKNOWNS>::zeros();
        for ((wrench, gravity), weight) in rows.iter().zip(&weights) {
            let columns = columns(gravity, sign);
            matrix += columns.tr_mul(&columns) * *weight;
            right += columns.tr_mul(wrench) * *weight;
        }
        x = matrix.cholesky()?.solve(&right);
        let misfits: Vec<f64> =
            rows.iter().map(|(wrench, gravity)| (wrench - columns(gravity, sign) * x).norm()).collect();
        let usual = median(misfits.clone()).max(1e-9);
        weights = misfits.iter().map(|misfit| (HUBER * usual / misfit.max(1e-12)).min(1.0)).collect();
    }
    (!rows.is_empty()).then(|| x.fixed_rows::<6>(0).into_owned())
}

/// The reading for one of each unknown.
fn columns(gravity: &Vector3<f64>, sign: f64) -> SMatrix<f64, 6, UNKNOWNS> {
    let mut columns = SMatrix::<f64, 6, UNKNOWNS>::zeros();
    for k in 0..6 {
        columns[(k, k)] = 1.0;
    }
    for k in 0..3 {
        columns[(k, 6)] = sign * gravity[k];
        let moment = Vector3::ith(k, 1.0).cross(gravity) * sign;
        for axis in 0..3 {
            columns[(3 + axis, 7 + k)] = moment[axis];
        }
    }
    columns
}
