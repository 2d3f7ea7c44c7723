//! Which torque belongs to which joint: the assignment of least cost (Kuhn 1955, Munkres 1957).

use nalgebra::DMatrix;

/// For each row the column such that the sum of the costs is least; the matrix is square and finite.
pub(super) fn assign(cost: &DMatrix<f64>) -> Vec<usize> {
    let n = cost.nrows();
    // Potentials of rows and columns; rows and columns are counted from 1, 0 stands for none.
    let (mut u, mut v) = (vec![0.0; n + 1], vec![0.0; n + 1]);
    let mut row_of = vec![0; n + 1];
    let mut way = vec![0; n + 1];
    for row in 1..=n {
        row_of[0] = row;
        let mut column = 0;
        let mut least = vec![f64::INFINITY; n + 1];
        let mut used = vec![false; n + 1];
        while row_of[column] != 0 {
            used[column] = true;
            let current = row_of[column];
            let (mut delta, mut next) = (f64::INFINITY, 0);
            for j in 1..=n {
                if used[j] {
                    continue;
                }
                let reduced = cost[(current - 1, j - 1)] - u[current] - v[j];
                if reduced < least[j] {
                    least[j] = reduced;
                    way[j] = column;
                }
                if least[j] < delta {
                    delta = least[j];
                    next = j;
                }
            }
            for j in 0..=n {
                if used[j] {
                    u[row_of[j]] += delta;
                    v[j] -= delta;
                } else {
                    least[j] -= delta;
                }
            }
            column = next;
        }
        while column != 0 {
            row_of[column] = row_of[way[column]];
            column = way[column];
        }
    }
    let mut columns = vec![0; n];
    for column in 1..=n {
        columns[row_of[column] - 1] = column - 1;
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cheapest_assignment_is_found() {
        let cost = DMatrix::from_row_slice(3, 3, &[4.0, 1.0, 3.0, 2.0, 0.0, 5.0, 3.0, 2.0, 2.0]);
        assert_eq!(assign(&cost), [1, 0, 2]);
        // Of all orders of random costs, by trying them.
        let stream = |k: usize| ((k as f64 * 12.9898).sin() * 43758.5453).fract();
        for round in 0..20 {
            let cost = DMatrix::from_fn(4, 4, |i, j| stream(100 * round + 4 * i + j));
            let found = assign(&cost);
            let sum = |order: &[usize]| order.iter().enumerate().map(|(i, j)| cost[(i, *j)]).sum::<f64>();
            let mut least = f64::INFINITY;
            for code in 0..256 {
                let order: Vec<usize> = (0..4).map(|k| (code >> (2 * k)) & 3).collect();
                let mut seen = order.clone();
                seen.sort_unstable();
                if seen == [0, 1, 2, 3] {
                    least = least.min(sum(&order));
                }
            }
            assert!((sum(&found) - least).abs() < 1e-12);
        }
    }
}
