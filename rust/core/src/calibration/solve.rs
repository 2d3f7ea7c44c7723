//! The most likely unknowns of a set of rows: Gauss-Newton steps on normal equations, with bounds.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::normal::Normal;
use super::unknowns::{Column, Unknowns};

/// Steps of Gauss and Newton; changes of a share converge in three or four, payloads in ten.
const MOST_STEPS: usize = 20;
/// A shorter step than a thousandth of the whole gains nothing.
const MOST_HALVINGS: usize = 10;
/// A step this small (standard deviations before the log is seen) is the last.
const SMALL_STEP: f64 = 1e-4;

/// The most likely unknowns, and their covariance.
#[derive(Debug, Clone)]
pub(super) struct Solution {
    pub z: DVector<f64>,
    /// One standard deviation of each before the log was seen.
    pub units: DVector<f64>,
}

impl Solution {
    /// The covariance, as if no unknown were bounded.
    pub fn covariance(&self, unknowns: &Unknowns, normal: &Normal) -> Option<DMatrix<f64>> {
        let information = information(&unknowns.derivative(&self.z), &normal.h);
        let matrix = in_units(&information, &self.units, &(0..self.z.len()).collect::<Vec<_>>());
        let inverse = Cholesky::new(matrix)?.inverse();
        Some(DMatrix::from_fn(self.z.len(), self.z.len(), |a, b| {
            inverse[(a, b)] * self.units[a] * self.units[b]
        }))
    }
}

/// Solves for the unknowns when `change` is the share by which bodies may differ from the description.
pub(super) fn solve(unknowns: &Unknowns, normal: &Normal, change: f64) -> Option<Solution> {
    let units = unknowns.units(change);
    let floors = unknowns.floors();
    let count = unknowns.len();
    let mut z = DVector::zeros(count);
    for _ in 0..MOST_STEPS {
        let columns = unknowns.derivative(&z);
        let left = &normal.g - &normal.h * unknowns.correction(&z);
        let information = information(&columns, &normal.h);
        let slope = transposed_product(&columns, &left);
        let aim = bounded_step(&information, &slope, &z, &units, &floors)?;
        let next = downhill(unknowns, normal, &units, &z, aim);
        let step = (&next - &z).component_div(&units).amax();
        z = next;
        if step < SMALL_STEP {
            break;
        }
    }
    z.iter().all(|x| x.is_finite()).then_some(Solution { z, units })
}

/// The farthest of ever shorter steps towards `aim` that lowers the misfit: far from a solution the quadratic model errs.
fn downhill(
    unknowns: &Unknowns,
    normal: &Normal,
    units: &DVector<f64>,
    z: &DVector<f64>,
    aim: DVector<f64>,
) -> DVector<f64> {
    let misfit = |z: &DVector<f64>| {
        let x = unknowns.correction(z);
        (&normal.h * &x).dot(&x) - 2.0 * normal.g.dot(&x) + z.component_div(units).norm_squared()
    };
    let now = misfit(z);
    let mut next = aim;
    for _ in 0..MOST_HALVINGS {
        if misfit(&next) <= now {
            return next;
        }
        next = (z + next) * 0.5;
    }
    z.clone()
}

/// The minimum of the quadratic model, with unknowns held at their floor where it lies below.
fn bounded_step(
    information: &DMatrix<f64>,
    slope: &DVector<f64>,
    z: &DVector<f64>,
    units: &DVector<f64>,
    floors: &[f64],
) -> Option<DVector<f64>> {
    let mut free: Vec<usize> = (0..z.len()).collect();
    let mut next = z.clone();
    loop {
        let held: Vec<usize> = (0..z.len()).filter(|k| free.binary_search(k).is_err()).collect();
        let matrix = in_units(information, units, &free);
        let right = DVector::from_fn(free.len(), |i, _| {
            let a = free[i];
            let moved: f64 = held.iter().map(|&b| information[(a, b)] * (floors[b] - z[b])).sum();
            (slope[a] - moved) * units[a] - z[a] / units[a]
        });
        let factor = Cholesky::new(matrix)?;
        let step = factor.solve(&right);
        for (i, &a) in free.iter().enumerate() {
            next[a] = z[a] + step[i] * units[a];
        }
        let below: Vec<usize> = free.iter().copied().filter(|&a| next[a] < floors[a]).collect();
        if below.is_empty() {
            return Some(next);
        }
        for k in below {
            next[k] = floors[k];
            free.retain(|a| *a != k);
        }
    }
}

/// The information of some unknowns with the prior's, in units of the prior: its part is the identity, and the factorisation
/// is safe.
fn in_units(information: &DMatrix<f64>, units: &DVector<f64>, free: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(free.len(), free.len(), |i, j| {
        let (a, b) = (free[i], free[j]);
        information[(a, b)] * units[a] * units[b] + if i == j { 1.0 } else { 0.0 }
    })
}

/// `J' H J`.
fn information(columns: &[Column], h: &DMatrix<f64>) -> DMatrix<f64> {
    let mut product = DMatrix::zeros(h.nrows(), columns.len());
    for (k, column) in columns.iter().enumerate() {
        for (i, value) in column.values.iter().enumerate() {
            product.column_mut(k).axpy(*value, &h.column(column.first + i), 1.0);
        }
    }
    let mut information = DMatrix::zeros(columns.len(), columns.len());
    for (k, column) in columns.iter().enumerate() {
        for other in 0..columns.len() {
            let parts = column.values.iter().enumerate();
            information[(k, other)] = parts.map(|(i, v)| v * product[(column.first + i, other)]).sum();
        }
    }
    information
}

/// `J' x`.
pub(super) fn transposed_product(columns: &[Column], x: &DVector<f64>) -> DVector<f64> {
    let entry = |column: &Column| -> f64 {
        column.values.iter().enumerate().map(|(i, value)| value * x[column.first + i]).sum()
    };
    DVector::from_iterator(columns.len(), columns.iter().map(entry))
}
