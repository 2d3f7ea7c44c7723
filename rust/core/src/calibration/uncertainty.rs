//! How far the unknowns may be from what was found: rows of a log do not err independently.

use nalgebra::{DMatrix, DVector};

use super::folds::{mean_square, HeldOut};
use super::normal::{columns, Joints, Normal};
use super::rows::Row;
use super::solve::{transposed_product, Solution};
use super::unknowns::Unknowns;

/// The longest lag of a correlation, as a part of the rows.
const LONGEST_LAG: usize = 4;
/// Correlations smaller than this end the sum.
const UNCORRELATED: f64 = 0.05;
/// Stretches of the log whose errors count as independent of each other.
const CLUSTERS: usize = 20;

/// How much a row of one joint counts: one over its mean square, and over the number of rows that err together.
pub(super) fn weight(residuals: &[DVector<f64>], used: &[bool], joint: usize) -> f64 {
    let square = mean_square(residuals, used, joint).max(f64::MIN_POSITIVE);
    1.0 / (square * correlated_rows(residuals, joint, square))
}

/// So many rows say as much as one whose error is independent of the others'.
fn correlated_rows(residuals: &[DVector<f64>], joint: usize, square: f64) -> f64 {
    let count = residuals.len();
    let mut sum = 1.0;
    for lag in 1..count / LONGEST_LAG {
        let products = (lag..count).map(|k| residuals[k][joint] * residuals[k - lag][joint]);
        let correlation = products.sum::<f64>() / ((count - lag) as f64 * square);
        if correlation < UNCORRELATED {
            break;
        }
        sum += 2.0 * correlation;
    }
    sum
}

/// The covariance of the unknowns. Weights assume that errors have nothing to do with the motion; what hysteresis leaves has.
/// Where the spread of what stretches of the log pull at an unknown, by their held-out residuals, is larger, it counts
/// instead (cluster-robust covariance: Liang and Zeger 1986).
pub(super) fn covariance(
    unknowns: &Unknowns,
    joints: &Joints,
    rows: &[Row],
    used: &[bool],
    held_out: &HeldOut,
    solution: &Solution,
) -> Option<DMatrix<f64>> {
    let kept = rows.iter().zip(used).filter(|(_, used)| **used).map(|(row, _)| row);
    let normal = Normal::of(unknowns, joints, kept);
    let assumed = solution.covariance(unknowns, &normal)?;
    let derivative = unknowns.derivative(&solution.z);
    let mut pulls = vec![DVector::zeros(unknowns.columns()); CLUSTERS];
    let mut entries = vec![];
    for (index, row) in rows.iter().enumerate().filter(|(index, _)| used[*index]) {
        let pull = &mut pulls[index * CLUSTERS / rows.len()];
        for (joint, weight) in joints.weights.iter().enumerate() {
            entries.clear();
            columns(unknowns, joints, row, joint, &mut entries);
            let error = weight * held_out.residuals[index][joint];
            entries.iter().for_each(|&(column, value)| pull[column] += error * value);
        }
    }
    let mut spread = DVector::<f64>::zeros(unknowns.len());
    for pull in &pulls {
        let moved = &assumed * transposed_product(&derivative, pull);
        spread += moved.component_mul(&moved);
    }
    let jack = {
        let b = held_out.solutions.len() as f64;
        let mean = held_out.solutions.iter().sum::<DVector<f64>>() / b;
        let mut s = DVector::<f64>::zeros(unknowns.len());
        for z in &held_out.solutions {
            let d = z - &mean;
            s += d.component_mul(&d) * ((b - 1.0) / b);
        }
        s
    };
    let mode = std::env::var("CAL_COV").unwrap_or_default();
    // What the description said keeps its part of the uncertainty.
    let wider = |k: usize| {
        let prior = assumed.row(k).component_div(&solution.units.transpose()).norm_squared();
        let robust = spread[k] + prior;
        let j = jack[k] + prior;
        let r = match mode.as_str() {
            "0" => 0.0,
            "j" => j,
            "jr" => j.max(robust),
            "only" => return (robust / assumed[(k, k)]).sqrt(),
            "onlyj" => return (j / assumed[(k, k)]).sqrt(),
            _ => robust,
        };
        (r / assumed[(k, k)].max(f64::MIN_POSITIVE)).max(1.0).sqrt()
    };
    let wider: Vec<f64> = (0..unknowns.len()).map(wider).collect();
    Some(DMatrix::from_fn(wider.len(), wider.len(), |a, b| assumed[(a, b)] * wider[a] * wider[b]))
}
