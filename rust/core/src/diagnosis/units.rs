//! Positions, velocities or times in other units than SI.

use super::finding::{FaultCode, Finding};
use crate::robot::{JointKind, Robot};

/// Degrees in a radian.
const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// A factor is taken for that of a unit within this share of it.
const NEAR: f64 = 0.1;

/// Positions beyond their limits by more than the whole range are no positions in radians.
const BEYOND: f64 = 1.0;

/// Whether positions are in degrees: they leave their limits by far, and would not as degrees.
pub(super) fn positions_in_degrees(robot: &Robot, q: &[f64]) -> bool {
    let nq = robot.nq();
    let mut far = false;
    let mut limited = 0;
    for body in robot.bodies[1..].iter().filter(|body| body.kind == JointKind::Revolute) {
        let [lower, upper] = body.position_limits;
        if !(lower.is_finite() && upper.is_finite()) || upper <= lower {
            continue;
        }
        limited += 1;
        let values = q.iter().skip(body.idx_q).step_by(nq);
        let (least, most) =
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
        let range = upper - lower;
        far |= least < lower - BEYOND * range || most > upper + BEYOND * range;
        let fits = |x: f64| x > lower - 0.1 * range && x < upper + 0.1 * range;
        if !(fits(least / DEGREES) && fits(most / DEGREES)) {
            return false;
        }
    }
    far && limited > 0
}

/// The positions of turning joints in radians.
pub(super) fn to_radians(robot: &Robot, q: &mut [f64]) {
    for body in robot.bodies[1..].iter().filter(|body| body.kind == JointKind::Revolute) {
        q.iter_mut().skip(body.idx_q).step_by(robot.nq()).for_each(|x| *x /= DEGREES);
    }
}

/// What a factor between velocities times time and changes of positions says of the units.
pub(super) enum Ratio {
    /// Velocities in degrees per second.
    Degrees,
    /// Time in milli-, micro- or nanoseconds.
    Time(f64, &'static str),
}

pub(super) fn ratio(slope: f64) -> Option<Ratio> {
    let near = |unit: f64| (slope / unit - 1.0).abs() < NEAR;
    if near(1.0 / DEGREES) {
        return Some(Ratio::Degrees);
    }
    [(1e-3, "ms"), (1e-6, "us"), (1e-9, "ns")]
        .into_iter()
        .find(|(unit, _)| near(*unit))
        .map(|(unit, name)| Ratio::Time(unit, name))
}

/// A finding about units, which spoil everything.
pub(super) fn finding(text: &str, factor: f64) -> Finding {
    Finding::new(FaultCode::Units, text.to_string()).sized(factor, "").explaining(1.0).major_if(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_between_velocity_and_position_name_units() {
        assert!(matches!(ratio(0.0175), Some(Ratio::Degrees)));
        assert!(matches!(ratio(1.02e-3), Some(Ratio::Time(_, "ms"))));
        assert!(ratio(1.0).is_none() && ratio(0.5).is_none());
    }
}
