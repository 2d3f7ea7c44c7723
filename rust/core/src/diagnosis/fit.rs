//! How well a hypothesis explains the torques: the logarithm of its marginal likelihood.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::evidence::Evidence;
use super::prior::Prior;
use super::target::Target;
use super::terms::OWN;

/// Rounds in which solution and noise are estimated by turns.
const ROUNDS: usize = 5;

/// The explanation that a hypothesis gives.
#[derive(Debug, Clone)]
pub(super) struct Fit {
    /// Logarithm of the marginal likelihood, up to a constant that all hypotheses share.
    pub score: f64,
    pub x: DVector<f64>,
    /// Standard deviation of what is left, in units of the target, `(nv,)`.
    pub sigma: Vec<f64>,
}

/// Fits all unknowns with their prior, and each joint's noise.
pub(super) fn fit(evidence: &Evidence, target: &Target, prior: &Prior) -> Option<Fit> {
    let unknowns = evidence.unknowns();
    let active = unknowns - if prior.gravity.is_some() { 0 } else { 3 };
    let (precision, log_precision) = precision(evidence, prior, active)?;
    let mut cross = Vec::with_capacity(evidence.nv);
    let mut squares = Vec::with_capacity(evidence.nv);
    for (k, sums) in evidence.sums.iter().enumerate() {
        let c = &target.coefficients[k];
        cross.push(&sums.cross * c);
        squares.push(c.dot(&(&sums.parts * c)).max(0.0));
    }
    let share = evidence.effective / evidence.rows;
    let floor: Vec<f64> =
        evidence.floor.iter().zip(&target.factor).map(|(floor, factor)| floor * factor).collect();
    let mut sigma: Vec<f64> = squares
        .iter()
        .zip(&floor)
        .map(|(square, floor)| (square / evidence.rows).sqrt().max(*floor))
        .collect();
    let mut last = None;
    for _ in 0..ROUNDS {
        let mut matrix = precision.clone();
        let mut right = DVector::zeros(active);
        for (k, sums) in evidence.sums.iter().enumerate() {
            let weight = share / (sigma[k] * sigma[k]);
            let places: Vec<usize> =
                (0..sums.unknowns.nrows()).map(|column| evidence.global(k, column)).collect();
            for (a, &row) in places.iter().enumerate() {
                if row >= active {
                    continue;
                }
                right[row] += weight * cross[k][a];
                for (b, &column) in places.iter().enumerate() {
                    if column <= row {
                        matrix[(row, column)] += weight * sums.unknowns[(a, b)];
                    }
                }
            }
        }
        let factor = Cholesky::new(matrix)?;
        let x = factor.solve(&right);
        let l = factor.l_dirty();
        let log_matrix: f64 = 2.0 * (0..active).map(|k| l[(k, k)].ln()).sum::<f64>();
        let mut score = 0.5 * (log_precision - log_matrix);
        // The prior's share of the misfit.
        score -= 0.5 * x.dot(&(&precision * &x));
        let mut next = Vec::with_capacity(evidence.nv);
        for (k, sums) in evidence.sums.iter().enumerate() {
            let own = DVector::from_iterator(
                sums.unknowns.nrows(),
                (0..sums.unknowns.nrows()).map(|column| {
                    let place = evidence.global(k, column);
                    if place < active {
                        x[place]
                    } else {
                        0.0
                    }
                }),
            );
            let rss = squares[k] - 2.0 * own.dot(&cross[k]) + own.dot(&(&sums.unknowns * &own));
            let mean = (rss / evidence.rows).max(0.0);
            let n = evidence.effective;
            score -= n * sigma[k].ln() + 0.5 * n * mean / (sigma[k] * sigma[k]) - n * target.factor[k].ln();
            next.push(mean.sqrt().max(floor[k]));
        }
        let mut full = DVector::zeros(unknowns);
        full.rows_mut(0, active).copy_from(&x);
        last = Some(Fit { score, x: full, sigma: sigma.clone() });
        sigma = next;
    }
    last
}

/// The inverse of the prior's covariance and the logarithm of its determinant.
fn precision(evidence: &Evidence, prior: &Prior, active: usize) -> Option<(DMatrix<f64>, f64)> {
    let mut matrix = DMatrix::zeros(active, active);
    let mut logarithm = 0.0;
    for (index, spread) in prior.bodies.iter().enumerate() {
        let factor = Cholesky::new(*spread)?;
        let at = index * spread.nrows();
        matrix.view_mut((at, at), spread.shape()).copy_from(&factor.inverse());
        let l = factor.l_dirty();
        logarithm -= 2.0 * (0..spread.nrows()).map(|k| l[(k, k)].ln()).sum::<f64>();
    }
    for (joint, deviations) in prior.own.iter().enumerate() {
        for (term, sd) in deviations.iter().enumerate() {
            let place = evidence.inertial + OWN.len() * joint + term;
            matrix[(place, place)] = 1.0 / (sd * sd);
            logarithm -= 2.0 * sd.ln();
        }
    }
    if let Some(sd) = prior.gravity {
        for place in active - 3..active {
            matrix[(place, place)] = 1.0 / (sd * sd);
            logarithm -= 2.0 * sd.ln();
        }
    }
    Some((matrix, logarithm))
}
