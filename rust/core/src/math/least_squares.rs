//! Dense least squares in a buffer of its own: Householder's factorisation with column pivoting. nalgebra's would
//! allocate at every call.

/// `matrix x = rhs`, filled row by row.
#[derive(Debug, Clone)]
pub(crate) struct LeastSquares {
    /// By columns, each of `capacity` rows; the right side comes last.
    entries: Vec<f64>,
    capacity: usize,
    columns: usize,
    rows: usize,
    pivots: Vec<usize>,
    /// First entry of each reflector, whose place in `entries` the triangle's diagonal takes, and its scale.
    heads: Vec<[f64; 2]>,
    rank: usize,
}

impl LeastSquares {
    /// Space for so many rows and columns.
    pub fn new(rows: usize, columns: usize) -> Self {
        Self {
            entries: vec![0.0; rows * (columns + 1)],
            capacity: rows,
            columns: 0,
            rows: 0,
            pivots: vec![0; columns],
            heads: vec![[0.0; 2]; columns],
            rank: 0,
        }
    }

    /// Starts a system of `columns` unknowns.
    pub fn reset(&mut self, columns: usize) {
        self.columns = columns.min(self.pivots.len());
        self.rows = 0;
        self.rank = 0;
    }

    /// Adds a row of zeros with its right side; to be filled by [`LeastSquares::set`].
    pub fn add_row(&mut self, rhs: f64) {
        if self.rows < self.capacity {
            self.rows += 1;
            let row = self.rows - 1;
            for column in 0..self.columns {
                self.entries[column * self.capacity + row] = 0.0;
            }
            self.entries[self.columns * self.capacity + row] = rhs;
        }
    }

    /// An entry of the last row.
    pub fn set(&mut self, column: usize, value: f64) {
        self.entries[column * self.capacity + self.rows - 1] = value;
    }

    /// Factorises; singular directions smaller than `tolerance` of the largest count as open.
    pub fn factorise(&mut self, tolerance: f64) {
        let Self { entries, capacity, columns, rows, pivots, heads, rank } = self;
        let (capacity, columns, rows) = (*capacity, *columns, *rows);
        pivots.iter_mut().enumerate().for_each(|(i, pivot)| *pivot = i);
        *rank = 0;
        let mut largest = 0.0_f64;
        for k in 0..columns.min(rows) {
            let square = |column: usize| -> f64 {
                entries[column * capacity + k..column * capacity + rows].iter().map(|x| x * x).sum()
            };
            let (best, size) = (k..columns)
                .map(|column| (column, square(column)))
                .fold((k, -1.0), |best, other| if other.1 > best.1 { other } else { best });
            let size = size.sqrt();
            largest = largest.max(size);
            if size.is_nan() || size <= tolerance * largest {
                break;
            }
            if best != k {
                pivots.swap(best, k);
                for row in 0..rows {
                    entries.swap(best * capacity + row, k * capacity + row);
                }
            }
            let (left, right) = entries.split_at_mut((k + 1) * capacity);
            let reflector = &mut left[k * capacity + k..k * capacity + rows];
            let diagonal = -size.copysign(reflector[0]);
            reflector[0] -= diagonal;
            let scale = -1.0 / (diagonal * reflector[0]);
            for column in right.chunks_exact_mut(capacity).take(columns - k) {
                let column = &mut column[k..rows];
                let share: f64 = scale * reflector.iter().zip(&*column).map(|(a, b)| a * b).sum::<f64>();
                column.iter_mut().zip(&*reflector).for_each(|(x, a)| *x -= share * a);
            }
            heads[k] = [reflector[0], scale];
            reflector[0] = diagonal;
            *rank = k + 1;
        }
    }

    /// The part of a vector over the rows that no combination of the columns reaches: its coordinates in a basis of that
    /// space are `vector[rank..rows]` afterwards.
    pub fn project_out(&self, vector: &mut [f64]) {
        for (k, [head, scale]) in self.heads.iter().enumerate().take(self.rank) {
            let tail = &self.entries[k * self.capacity + k + 1..k * self.capacity + self.rows];
            let dot: f64 = tail.iter().zip(&vector[k + 1..self.rows]).map(|(a, x)| a * x).sum();
            let share = scale * (head * vector[k] + dot);
            vector[k] -= share * head;
            vector[k + 1..self.rows].iter_mut().zip(tail).for_each(|(x, a)| *x -= share * a);
        }
    }

    /// What the solution leaves of the right side, in the basis of [`LeastSquares::project_out`].
    pub fn left_over(&self) -> &[f64] {
        let rhs = self.columns * self.capacity;
        &self.entries[rhs + self.rank..rhs + self.rows]
    }

    /// How many combinations of the unknowns the rows determine.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// A solution (the unknowns that are not determined zero) into `x`; returns the sum of squares left over.
    pub fn solve(&self, x: &mut [f64]) -> f64 {
        let rhs = self.columns * self.capacity;
        x[..self.columns].fill(0.0);
        self.back_substitute(x, |row| self.entries[rhs + row]);
        self.left_over().iter().map(|r| r * r).sum()
    }

    /// The `index`-th direction that the rows leave open, into `x`.
    pub fn open_direction(&self, index: usize, x: &mut [f64]) {
        let column = self.rank + index;
        x[..self.columns].fill(0.0);
        self.back_substitute(x, |row| -self.entries[column * self.capacity + row]);
        x[self.pivots[column]] = 1.0;
    }

    /// The row of one unknown in a root of the solution's covariance (for rows of unit variance), into `x`: as many
    /// entries as the rank. Zeros for an unknown that the rows leave open.
    pub fn covariance_root_row(&self, unknown: usize, x: &mut [f64]) {
        x[..self.rank].fill(0.0);
        let Some(place) = self.pivots[..self.rank].iter().position(|pivot| *pivot == unknown) else { return };
        // A row of the triangle's inverse: forward substitution on its transpose.
        for column in place..self.rank {
            let above = &self.entries[column * self.capacity + place..column * self.capacity + column];
            let sum: f64 = above.iter().zip(&x[place..column]).map(|(r, y)| r * y).sum();
            x[column] = (f64::from(column == place) - sum) / self.entries[column * self.capacity + column];
        }
    }

    /// Solves the triangle for a right side.
    fn back_substitute(&self, x: &mut [f64], rhs: impl Fn(usize) -> f64) {
        for row in (0..self.rank).rev() {
            let mut value = rhs(row);
            for column in row + 1..self.rank {
                value -= self.entries[column * self.capacity + row] * x[self.pivots[column]];
            }
            x[self.pivots[row]] = value / self.entries[row * self.capacity + row];
        }
    }
}

/// Whether a misfit is above the limit, or not a number.
pub(crate) fn exceeds(misfit: f64, limit: f64) -> bool {
    misfit.is_nan() || misfit > limit
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;

    fn system(matrix: &DMatrix<f64>, rhs: &DVector<f64>) -> LeastSquares {
        let mut system = LeastSquares::new(matrix.nrows(), matrix.ncols());
        system.reset(matrix.ncols());
        for (row, value) in matrix.row_iter().zip(rhs.iter()) {
            system.add_row(*value);
            row.iter().enumerate().for_each(|(column, value)| system.set(column, *value));
        }
        system.factorise(1e-9);
        system
    }

    proptest! {
        #[test]
        fn agrees_with_the_normal_equations(entries in prop::collection::vec(-1.0..1.0, 70), deficit in 0_usize..3) {
            let mut matrix = DMatrix::from_column_slice(9, 7, &entries[..63]);
            for k in 0..deficit {
                let copy = matrix.column(k) * 2.0 - matrix.column(3);
                matrix.set_column(6 - k, &copy);
            }
            // Random matrices come arbitrarily near to a lower rank: what they determine is then a matter of rounding.
            let mut squares: Vec<f64> = matrix.tr_mul(&matrix).symmetric_eigenvalues().iter().copied().collect();
            squares.sort_by(f64::total_cmp);
            prop_assume!(squares[deficit] > 1e-4);
            let rhs = DVector::from_column_slice(&entries[61..70]);
            let system = system(&matrix, &rhs);
            prop_assert_eq!(system.rank(), 7 - deficit);
            let mut x = vec![0.0; 7];
            let left = system.solve(&mut x);
            // Least squares: what is left is perpendicular to all columns.
            let residual = &rhs - &matrix * DVector::from_column_slice(&x);
            prop_assert!(matrix.tr_mul(&residual).norm() < 1e-9);
            prop_assert!((left - residual.norm_squared()).abs() < 1e-9);
            // A column added would take its projection out of the rest.
            let mut extra = entries[7..16].to_vec();
            system.project_out(&mut extra);
            let column = DVector::from_column_slice(&entries[7..16]);
            let kept = &extra[system.rank()..];
            let along: f64 = kept.iter().zip(system.left_over()).map(|(a, b)| a * b).sum();
            prop_assert!((along - column.dot(&residual)).abs() < 1e-9);
            for index in 0..deficit {
                system.open_direction(index, &mut x);
                let direction = DVector::from_column_slice(&x);
                prop_assert!((&matrix * &direction).norm() < 1e-8 * direction.norm());
            }
            if deficit == 0 {
                let normal = matrix.tr_mul(&matrix).cholesky().expect("of full rank");
                prop_assert!((DVector::from_column_slice(&x) - normal.solve(&matrix.tr_mul(&rhs))).norm() < 1e-6);
                let mut root = DMatrix::zeros(7, 7);
                for unknown in 0..7 {
                    system.covariance_root_row(unknown, &mut x);
                    root.row_mut(unknown).copy_from(&DVector::from_column_slice(&x).transpose());
                }
                let covariance = &root * root.transpose();
                let identity = covariance * matrix.tr_mul(&matrix);
                prop_assert!((identity - DMatrix::identity(7, 7)).norm() < 1e-4);
            }
        }
    }
}
