//! Changes of a body that leave it a rigid body: a congruence of its pseudo-inertia (Rucker and Wensing 2022).
//!
//! Mass stays positive and the density of the body non-negative whatever the numbers, so a fit needs no constraint, and
//! "towards the description" is a distance from zero: shares of mass and size, and a shift of the centre of mass.

use nalgebra::{Matrix3, SMatrix, SymmetricEigen, Vector3};

use crate::robot::inertial_parameters::{of_inertia, to_inertia, Parameters};

/// A body as mass, centre of mass and second moments of mass about it.
#[derive(Debug, Clone, Copy)]
pub(super) struct PseudoInertia {
    mass: f64,
    com: Vector3<f64>,
    spread: Matrix3<f64>,
}

/// Numbers of a change: logarithm of mass, stretches and shears of the body, shift of its centre of mass (m).
pub(super) const CHANGES: usize = 10;
pub(super) type Change = [f64; CHANGES];
const MASS: usize = 0;
const STRETCH: usize = 1;
const SHEAR: usize = 4;
const SHIFT: usize = 7;

/// A body that is smaller counts as this large: its centre may be as far off (m).
const SMALLEST_SIZE: f64 = 0.02;
const MOST_STEPS: usize = 1000;
/// Step of a derivative: half the digits of a number.
const STEP: f64 = 1e-6;

impl PseudoInertia {
    /// The nearest rigid body to published parameters, which need not be one's; none without mass.
    pub fn nearest(parameters: &Parameters) -> Option<Self> {
        let (mass, com, inertia) = to_inertia(parameters);
        if mass <= 0.0 {
            return None;
        }
        let spread = Matrix3::from_diagonal_element(0.5 * inertia.trace()) - inertia;
        let found = SymmetricEigen::try_new(spread, f64::EPSILON, MOST_STEPS)?;
        let bounded = Matrix3::from_diagonal(&found.eigenvalues.map(|moment| moment.max(0.0)));
        Some(PseudoInertia {
            mass,
            com,
            spread: found.eigenvectors * bounded * found.eigenvectors.transpose(),
        })
    }

    /// Radius of gyration (m).
    pub fn size(&self) -> f64 {
        (self.spread.trace() / self.mass).sqrt().max(SMALLEST_SIZE)
    }

    /// The parameters of the changed body.
    pub fn changed(&self, change: &Change) -> Parameters {
        let growth = change[MASS].exp();
        let [a, b, c] = [0, 1, 2].map(|axis| change[STRETCH + axis].exp());
        let shape = Matrix3::new(a, change[SHEAR], change[SHEAR + 1], 0.0, b, change[SHEAR + 2], 0.0, 0.0, c);
        let spread = shape * self.spread * shape.transpose() * growth;
        let com = self.com + Vector3::from_column_slice(&change[SHIFT..]);
        let inertia = Matrix3::from_diagonal_element(spread.trace()) - spread;
        of_inertia(growth * self.mass, &com, &inertia)
    }

    /// The derivative of [`changed`](Self::changed), one column for each number of the change.
    pub fn derivative(&self, change: &Change) -> SMatrix<f64, 10, CHANGES> {
        let mut derivative = SMatrix::<f64, 10, CHANGES>::zeros();
        for column in 0..CHANGES {
            let at = |step: f64| {
                let mut moved = *change;
                moved[column] += step;
                SMatrix::<f64, 10, 1>::from_column_slice(&self.changed(&moved))
            };
            derivative.set_column(column, &((at(STEP) - at(-STEP)) / (2.0 * STEP)));
        }
        derivative
    }

    /// What counts as a change of size one: a share of mass or size, or the body's size for its centre.
    pub fn units(&self) -> Change {
        let mut units = [0.5; CHANGES];
        units[MASS] = 1.0;
        units[SHIFT..].fill(self.size());
        units
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;

    #[test]
    fn no_change_is_the_body_itself() {
        for parameters in Robot::example_arm().inertial_parameters() {
            let body = PseudoInertia::nearest(&parameters).unwrap();
            for (changed, before) in body.changed(&[0.0; CHANGES]).iter().zip(&parameters) {
                assert!((changed - before).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn any_change_is_a_rigid_body() {
        let parameters = Robot::example_arm().inertial_parameters()[2];
        let body = PseudoInertia::nearest(&parameters).unwrap();
        for seed in 0..50 {
            let mut change = [0.0; CHANGES];
            for (k, number) in change.iter_mut().enumerate() {
                *number = 3.0 * ((seed * 17 + k * 5) as f64).sin();
            }
            let (mass, _, inertia) = to_inertia(&body.changed(&change));
            let mut moments = inertia.symmetric_eigenvalues();
            moments.as_mut_slice().sort_by(f64::total_cmp);
            assert!(mass > 0.0 && moments[0] > 0.0);
            assert!(moments[0] + moments[1] > moments[2] * (1.0 - 1e-9));
        }
    }

    #[test]
    fn what_no_rigid_body_has_becomes_the_nearest_that_one_has() {
        // Moments 1, 1, 3 break the triangle inequality.
        let parameters =
            of_inertia(2.0, &Vector3::x(), &Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 3.0)));
        let (_, _, inertia) =
            to_inertia(&PseudoInertia::nearest(&parameters).unwrap().changed(&[0.0; CHANGES]));
        let moments = inertia.diagonal();
        assert!((moments.x + moments.y - moments.z).abs() < 1e-9);
    }
}
