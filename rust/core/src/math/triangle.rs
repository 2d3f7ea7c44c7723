//! The triangle of a QR factorisation of five columns, to which rows are added one by one: a Gram matrix would square the
//! condition.

use nalgebra::{Matrix2, Matrix5};

const COLUMNS: usize = 5;

/// The upper triangle `R` with `R^T R = A^T A`, of the rows added so far.
#[derive(Debug, Clone)]
pub(crate) struct Triangle(Matrix5<f64>);

impl Triangle {
    /// Of no rows.
    pub fn empty() -> Self {
        Triangle(Matrix5::zeros())
    }

    /// Of the unit rows: each unknown has a prior with unit variance.
    pub fn identity() -> Self {
        Triangle(Matrix5::identity())
    }

    /// Adds a row, by Givens rotations.
    pub fn add(&mut self, mut row: [f64; COLUMNS]) {
        for k in 0..COLUMNS {
            let radius = self.0[(k, k)].hypot(row[k]);
            if radius == 0.0 {
                continue;
            }
            let (cos, sin) = (self.0[(k, k)] / radius, row[k] / radius);
            for (column, entry) in row.iter_mut().enumerate().skip(k) {
                let above = self.0[(k, column)];
                self.0[(k, column)] = cos * above + sin * *entry;
                *entry = cos * *entry - sin * above;
            }
        }
    }

    /// A square root of the covariance of the last two unknowns, whatever the others are; the triangle must have begun with the
    /// identity.
    pub fn last_two(&self) -> Matrix2<f64> {
        let (a, b, c) = (self.0[(3, 3)], self.0[(3, 4)], self.0[(4, 4)]);
        Matrix2::new(1.0 / a, -b / (a * c), 0.0, 1.0 / c)
    }

    /// How many singular values are greater than a share of the largest one.
    pub fn rank(&self, tolerance: f64) -> usize {
        let values = self.0.singular_values();
        values.iter().filter(|value| **value > tolerance * values.max()).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SMatrix;

    /// Rows without any order.
    fn rows() -> SMatrix<f64, 7, 5> {
        SMatrix::from_fn(|row, column| (1.7 * ((row + 1) * (column * column + 2)) as f64).sin())
    }

    #[test]
    fn the_covariance_is_that_of_the_normal_equations() {
        let rows = rows();
        let mut triangle = Triangle::identity();
        rows.row_iter().for_each(|row| triangle.add(std::array::from_fn(|k| row[k])));
        let gram = Matrix5::identity() + rows.transpose() * rows;
        let covariance = gram.try_inverse().expect("is positive definite");
        let root = triangle.last_two();
        let error = root * root.transpose() - covariance.fixed_view::<2, 2>(3, 3);
        assert!(error.norm() < 1e-14, "{error}");
    }

    #[test]
    fn the_rank_is_the_number_of_independent_rows() {
        let rows = rows();
        let mut triangle = Triangle::empty();
        assert_eq!(triangle.rank(1e-9), 0);
        for count in 1..=7 {
            let row = rows.row(count - 1);
            triangle.add(std::array::from_fn(|k| row[k]));
            triangle.add(std::array::from_fn(|k| 2.0 * row[k] - rows[(0, k)]));
            assert_eq!(triangle.rank(1e-9), count.min(5));
        }
    }
}
