//! Configurations, velocities and torques: what a call's arrays must look like.

use super::description::JointKind;
use super::numbers::check_vector;
use super::robot::Robot;
use crate::error::{Error, Result};

/// Unit quaternions and (cos, sin) pairs may be off by this much (squared norm); they are normalised.
const NORM_TOLERANCE: f64 = 1e-3;
/// A slide that is farther from zero is no machine's (m): beside its mass times the square of that, rounding hides the inertias
/// of what it carries, and nothing can be said of accelerations.
const LONGEST_SLIDE: f64 = 1e4;

impl Robot {
    /// The neutral configuration: joints at zero, base at the origin.
    pub fn neutral(&self) -> Vec<f64> {
        let mut q = vec![0.0; self.nq()];
        for body in &self.bodies[1..] {
            match body.kind {
                JointKind::FreeFlyer => q[body.idx_q + 6] = 1.0,
                JointKind::Continuous => q[body.idx_q] = 1.0,
                _ => {}
            }
        }
        q
    }

    /// Checks a configuration: length, finite, unit quaternion and (cos, sin) pairs, sliding joints within 10 km.
    ///
    /// # Errors
    /// [`Error::Input`] names the entry.
    pub fn check_configuration(&self, q: &[f64]) -> Result<()> {
        check_vector("q", q, self.nq())?;
        for body in &self.bodies[1..] {
            let part = match body.kind {
                JointKind::FreeFlyer => &q[body.idx_q + 3..body.idx_q + 7],
                JointKind::Continuous => &q[body.idx_q..body.idx_q + 2],
                JointKind::Prismatic if q[body.idx_q].abs() > LONGEST_SLIDE => {
                    return Err(too_far(body.idx_q, q[body.idx_q]))
                }
                JointKind::Prismatic | JointKind::Revolute => continue,
            };
            let norm: f64 = part.iter().map(|x| x * x).sum();
            if (norm - 1.0).abs() > NORM_TOLERANCE {
                return Err(not_unit(body.kind, body.idx_q, norm.sqrt()));
            }
        }
        Ok(())
    }

    /// Checks that a joint or the base moves: else there is no torque, and no place for a force/torque sensor.
    ///
    /// # Errors
    /// [`Error::Input`] names `robot`.
    pub fn check_moves(&self) -> Result<()> {
        if self.nv() == 0 {
            let text = "it has no joint that moves: neither torques nor sensors can tell anything";
            return Err(Error::input("robot", text));
        }
        Ok(())
    }

    /// Checks a velocity or another vector of length `nv`.
    ///
    /// # Errors
    /// [`Error::Input`] names the argument.
    #[inline]
    pub fn check_tangent(&self, argument: &'static str, values: &[f64]) -> Result<()> {
        check_vector(argument, values, self.nv())
    }

    /// One number for each velocity variable, from as many or from one that holds for all; checked as by
    /// [`check_tangent`](Self::check_tangent).
    pub(crate) fn per_velocity(&self, argument: &'static str, values: &[f64]) -> Result<Vec<f64>> {
        let all = match values {
            [one] => vec![*one; self.nv()],
            _ if values.len() == self.nv() => values.to_vec(),
            _ => {
                let wanted = self.nv();
                return Err(Error::input(
                    argument,
                    format!("expected one number or {wanted}, got {}", values.len()),
                ));
            }
        };
        check_vector(argument, &all, self.nv())?;
        Ok(all)
    }

    /// Checks measured torques: `nv`, or `nv - 6` for a floating base (its six are then zero).
    ///
    /// # Errors
    /// [`Error::Input`] names the argument.
    #[inline]
    pub fn check_torque(&self, argument: &'static str, tau: &[f64]) -> Result<()> {
        if self.floating_base() && tau.len() == self.nv() {
            check_vector(argument, tau, self.nv())
        } else {
            check_vector(argument, tau, self.nv() - self.unactuated())
        }
    }
}

#[cold]
fn not_unit(kind: JointKind, index: usize, norm: f64) -> Error {
    let text = match kind {
        JointKind::FreeFlyer => format!("entries {}..{} are a quaternion (x, y, z, w)", index + 3, index + 7),
        _ => format!("entries {index}..{} are (cos, sin) of a continuous joint", index + 2),
    };
    Error::input("q", format!("{text} and must have norm 1, not {norm:.6}"))
}

#[cold]
fn too_far(index: usize, position: f64) -> Error {
    let text =
        format!("entry {index} of a sliding joint must be within {LONGEST_SLIDE:e} m, not {position:e}");
    Error::input("q", text)
}

/// Writes `tau` as `nv` numbers, with zeros for an unactuated base.
#[inline]
pub(crate) fn spread_torque(tau: &[f64], out: &mut [f64]) {
    let missing = out.len() - tau.len();
    out[..missing].fill(0.0);
    out[missing..].copy_from_slice(tau);
}
