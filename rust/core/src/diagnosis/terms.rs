//! What rows are asked for, and the parts that targets are made of.

use crate::calibration::rows::Term;
use crate::calibration::Reversal;

/// Terms of a joint's own torque that a fault may need, in the order of their unknowns.
pub(super) const OWN: [Term; 4] = [Term::Bias, COULOMB, Term::Viscous, Term::Armature];
/// What rows are asked for: these, and the measured torque.
pub(super) const TERMS: [Term; 5] = [Term::Bias, COULOMB, Term::Viscous, Term::Armature, Term::Torque];
/// Coulomb friction, which turns round with the velocity.
pub(super) const COULOMB: Term = Term::Coulomb(Reversal::Velocity(FRICTION_VELOCITY));

/// Delays of the torque that have a column of their own (s); between two of them columns are interpolated.
pub(super) const DELAYS: [f64; 16] =
    [-0.06, -0.05, -0.04, -0.03, -0.02, -0.01, 0.0, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.08, 0.1, 0.12];

/// Velocity at which Coulomb friction has 76 % of its torque (rad/s; m/s).
const FRICTION_VELOCITY: f64 = 0.03;

/// The parts of a target: torques, the model's torque, gravity's along each axis, delayed torques.
#[derive(Debug, Clone, Copy)]
pub(super) struct Parts {
    pub nv: usize,
}

impl Parts {
    pub fn torque(self, joint: usize) -> usize {
        joint
    }
    pub fn model(self) -> usize {
        self.nv
    }
    pub fn gravity(self, axis: usize) -> usize {
        self.nv + 1 + axis
    }
    pub fn delayed(self, index: usize) -> usize {
        self.nv + 4 + index
    }
    pub fn len(self) -> usize {
        self.nv + 4 + DELAYS.len()
    }
}
