//! What the normal forces of several contacts do to the rows of one measurement, with the forces across the normals integrated out.

// Rows and columns of matrices: the equations are written with their numbers.
#![allow(clippy::needless_range_loop)]

/// Directions of a force: along the inward normal, and two across it.
const DIRECTIONS: usize = 3;
/// Sweeps over the contacts for their forces at one pose: moves are led by them, nothing is weighed with them.
const SWEEPS: usize = 8;

/// Normal equations of the forces along the normals, of one contact or several.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SeveralPushes<const N: usize> {
    /// Inner products of the torques of unit forces [1/N^2].
    pub gain: [[f64; N]; N],
    /// Theirs with the target [1/N].
    pub product: [f64; N],
    /// Squared norm of the part of the target that friction does not explain.
    pub target: f64,
    /// What the freedom of friction costs in log-likelihood.
    pub penalty: f64,
}

impl<const N: usize> SeveralPushes<N> {
    /// The squared torques that forces leave over.
    pub fn misfit(&self, forces: &[f64; N]) -> f64 {
        let mut misfit = self.target;
        for i in 0..N {
            let felt: f64 = (0..N).map(|j| self.gain[i][j] * forces[j]).sum();
            misfit += forces[i] * (felt - 2.0 * self.product[i]);
        }
        misfit.max(0.0)
    }

    /// The forces within a range that explain the target about best, each along its normal [N].
    pub fn forces(&self, [least, greatest]: [f64; 2]) -> [f64; N] {
        let mut forces = [least; N];
        for _ in 0..SWEEPS {
            for i in 0..N {
                let others: f64 = (0..N).filter(|j| *j != i).map(|j| self.gain[i][j] * forces[j]).sum();
                if self.gain[i][i] > 0.0 {
                    forces[i] = ((self.product[i] - others) / self.gain[i][i]).clamp(least, greatest);
                }
            }
        }
        forces
    }
}

/// Inner products of the torques of unit forces in all directions of several contacts, and theirs with a target.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AllDirections<const N: usize> {
    pub gram: [[[[f64; DIRECTIONS]; DIRECTIONS]; N]; N],
    pub product: [[f64; DIRECTIONS]; N],
    /// Squared norm of the target.
    pub target: f64,
}

impl<const N: usize> AllDirections<N> {
    /// Along the normals alone.
    pub fn bare(&self) -> SeveralPushes<N> {
        SeveralPushes {
            gain: self.gram.map(|row| row.map(|block| block[0][0])),
            product: self.product.map(|product| product[0]),
            target: self.target,
            penalty: 0.0,
        }
    }

    /// Integrates out the forces across the normals one by one, where they have a standard deviation (N).
    pub fn without_friction(mut self, deviation: [Option<f64>; N]) -> SeveralPushes<N> {
        let mut penalty = 0.0;
        for (contact, deviation) in deviation.into_iter().enumerate() {
            let Some(slack) = deviation.map(|deviation| deviation * deviation) else { continue };
            for direction in 1..DIRECTIONS {
                let pivot = self.gram[contact][contact][direction][direction] + slack.recip();
                if !pivot.is_finite() {
                    continue;
                }
                penalty += 0.5 * (pivot * slack).ln();
                self.eliminate(contact, direction, pivot);
            }
        }
        SeveralPushes { penalty, target: self.target.max(0.0), ..self.bare() }
    }

    /// A step of Gaussian elimination.
    fn eliminate(&mut self, contact: usize, direction: usize, pivot: f64) {
        let row: [[f64; DIRECTIONS]; N] = std::array::from_fn(|j| self.gram[contact][j][direction]);
        let product = self.product[contact][direction];
        for i in 0..N {
            for a in 0..DIRECTIONS {
                let share = row[i][a] / pivot;
                self.product[i][a] -= share * product;
                for j in 0..N {
                    for b in 0..DIRECTIONS {
                        self.gram[i][j][a][b] -= share * row[j][b];
                    }
                }
            }
        }
        self.target -= product * product / pivot;
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Cholesky, DMatrix, DVector};

    use super::*;

    #[test]
    fn friction_of_two_contacts_is_integrated_out_as_a_covariance_would() {
        let columns = DMatrix::from_fn(7, 6, |i, j| ((1 + i * 3 + j * 5) as f64 * 0.7).sin());
        let target = DVector::from_fn(7, |i, _| 3.0 * (i as f64 * 1.3).cos());
        let gram = columns.tr_mul(&columns);
        let product = columns.tr_mul(&target);
        let all = AllDirections::<2> {
            gram: std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    std::array::from_fn(|a| std::array::from_fn(|b| gram[(3 * i + a, 3 * j + b)]))
                })
            }),
            product: std::array::from_fn(|i| std::array::from_fn(|a| product[3 * i + a])),
            target: target.norm_squared(),
        };
        let deviation = [2.0, 0.5];
        let found = all.without_friction(deviation.map(Some));
        let mut covariance = DMatrix::<f64>::identity(7, 7);
        for (contact, deviation) in deviation.iter().enumerate() {
            for a in 1..3 {
                let column = columns.column(3 * contact + a);
                covariance += column * column.transpose() * (deviation * deviation);
            }
        }
        let factor = Cholesky::new(covariance).expect("positive");
        for i in 0..2 {
            let solved = factor.solve(&columns.column(3 * i).into_owned());
            for j in 0..2 {
                assert!((found.gain[j][i] - columns.column(3 * j).dot(&solved)).abs() < 1e-12);
            }
            assert!((found.product[i] - target.dot(&solved)).abs() < 1e-12);
        }
        assert!((found.target - target.dot(&factor.solve(&target))).abs() < 1e-12);
        assert!((found.penalty - 0.5 * factor.determinant().ln()).abs() < 1e-12);
    }

    #[test]
    fn forces_stay_in_their_range() {
        let pushes = SeveralPushes::<2> {
            gain: [[2.0, 0.5], [0.5, 1.0]],
            product: [2.0 * 10.0 + 0.5 * 20.0, 0.5 * 10.0 + 20.0],
            target: 0.0,
            penalty: 0.0,
        };
        let free = pushes.forces([1.0, 100.0]);
        assert!((free[0] - 10.0).abs() < 1e-3 && (free[1] - 20.0).abs() < 1e-3, "{free:?}");
        assert_eq!(pushes.forces([1.0, 5.0]), [5.0, 5.0]);
    }
}
