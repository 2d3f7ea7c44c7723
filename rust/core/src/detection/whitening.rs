//! A torque over its covariance: `r' S^-1 r` by Cholesky's factors.

/// Products of numbers in a tick, about: all of an arm's factor, a tenth of a humanoid's.
const WORK: usize = 400;

/// The lower Cholesky factor of a covariance, worked out over one tick or several.
#[derive(Debug, Clone)]
pub(crate) struct Whitening {
    size: usize,
    /// Rows of the factor, the reciprocal of each diagonal entry in its place: complete, and in the making.
    factor: Vec<f64>,
    growing: Vec<f64>,
    next: usize,
    started: bool,
    /// Of each torque (Nm).
    deviations: Vec<f64>,
    whitened: Vec<f64>,
}

impl Whitening {
    /// Space for so many torques; they count for nothing until a covariance is complete.
    pub fn new(size: usize) -> Self {
        Whitening {
            size,
            factor: vec![0.0; size * size],
            growing: vec![0.0; size * size],
            next: 0,
            started: false,
            deviations: vec![f64::INFINITY; size],
            whitened: vec![0.0; size],
        }
    }

    /// Of torques that are independent of each other, by their standard deviations (Nm).
    pub fn of_deviations(deviations: &[f64]) -> Self {
        let mut whitening = Whitening::new(deviations.len());
        whitening.advance(|i, row| {
            row.fill(0.0);
            row[i] = deviations[i] * deviations[i];
        });
        whitening
    }

    /// A tick's work on the factor of a covariance of which `covariance(i, row)` writes row `i` up to the diagonal; the first
    /// time, all of it. Its diagonal must be positive; a pivot that rounding makes negative is taken for a small share of
    /// its diagonal entry. True where the factor is complete.
    #[inline]
    pub fn advance(&mut self, mut covariance: impl FnMut(usize, &mut [f64])) -> bool {
        let n = self.size;
        let mut work = 0;
        while self.next < n && (work < WORK || !self.started) {
            let i = self.next;
            let (above, rest) = self.growing.split_at_mut(i * n);
            let row = &mut rest[..=i];
            covariance(i, row);
            let variance = row[i];
            self.deviations[i] = variance.sqrt();
            for j in 0..i {
                let other = &above[j * n..=j * n + j];
                let sum: f64 = row[..j].iter().zip(other).map(|(a, b)| a * b).sum();
                row[j] = (row[j] - sum) * other[j];
            }
            let (before, last) = row.split_at_mut(i);
            let pivot = variance - before.iter().map(|a| a * a).sum::<f64>();
            last[0] = 1.0 / pivot.max(SMALLEST_PIVOT * variance).sqrt();
            work += i * i / 2 + i;
            self.next += 1;
        }
        if self.next < n {
            return false;
        }
        std::mem::swap(&mut self.factor, &mut self.growing);
        (self.next, self.started) = (0, true);
        true
    }

    /// Whether the next work begins a covariance.
    pub fn at_start(&self) -> bool {
        self.next == 0
    }

    /// Starts anew with the next covariance.
    pub fn reset(&mut self) {
        (self.next, self.started) = (0, false);
    }

    /// `r' S^-1 r`.
    #[inline]
    pub fn squared_norm(&mut self, torque: &[f64]) -> f64 {
        let n = self.size;
        let mut sum = 0.0;
        for (i, r) in torque.iter().enumerate() {
            let row = &self.factor[i * n..=i * n + i];
            let known: f64 = row[..i].iter().zip(&self.whitened).map(|(a, b)| a * b).sum();
            let value = (r - known) * row[i];
            self.whitened[i] = value;
            sum += value * value;
        }
        sum
    }

    /// The torque of the last [`Whitening::squared_norm`], whitened: of unit covariance.
    pub fn whitened_mut(&mut self) -> &mut [f64] {
        &mut self.whitened
    }

    /// Whitens a torque, which is given by its entries.
    pub fn whiten(&self, entry: impl Fn(usize) -> f64, whitened: &mut [f64]) {
        let n = self.size;
        for i in 0..n {
            let row = &self.factor[i * n..=i * n + i];
            let known: f64 = row[..i].iter().zip(&*whitened).map(|(a, b)| a * b).sum();
            whitened[i] = (entry(i) - known) * row[i];
        }
    }

    /// The torque that [`Whitening::whitened_mut`] is of.
    pub fn unwhiten(&self, torque: &mut [f64]) {
        let n = self.size;
        for (i, torque) in torque.iter_mut().enumerate() {
            let row = &self.factor[i * n..=i * n + i];
            let known: f64 = row[..i].iter().zip(&self.whitened).map(|(a, b)| a * b).sum();
            *torque = known + self.whitened[i] / row[i];
        }
    }

    /// The standard deviation of each torque (Nm).
    pub fn deviations(&self) -> &[f64] {
        &self.deviations
    }
}

/// Rounding leaves this share of a diagonal entry.
const SMALLEST_PIVOT: f64 = 1e-12;

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;

    #[test]
    fn it_is_the_quadratic_form() {
        let root =
            DMatrix::from_fn(5, 5, |i, j| ((3 * i + 7 * j) as f64).sin() + if i == j { 2.0 } else { 0.0 });
        let covariance = &root * root.transpose();
        let torque = DVector::from_fn(5, |i, _| 1.0 + i as f64);
        let mut whitening = Whitening::new(5);
        assert_eq!(whitening.squared_norm(torque.as_slice()), 0.0);
        let row = |i: usize, row: &mut [f64]| {
            row.iter_mut().enumerate().for_each(|(j, value)| *value = covariance[(i, j)]);
        };
        assert!(whitening.advance(row));
        let expected = torque.dot(&covariance.clone().cholesky().expect("positive").solve(&torque));
        assert!((whitening.squared_norm(torque.as_slice()) / expected - 1.0).abs() < 1e-12);
        assert!((whitening.deviations()[2] - covariance[(2, 2)].sqrt()).abs() < 1e-15);
    }
}
