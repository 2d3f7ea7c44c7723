//! How far the unknowns may be from what was found: rows of a log do not err independently.

use std::mem::discriminant;

use nalgebra::{DMatrix, DVector};

use super::folds::{mean_square, HeldOut};
use super::friction::REVERSALS;
use super::hysteresis::WIDTHS;
use super::normal::{columns, kept_back, own_terms, torque, Joints, Normal, Shape};
use super::rows::Row;
use super::solve::{transposed_product, Solution};
use super::unknowns::{Unknowns, COULOMB, HYSTERESIS};

/// The longest lag of a correlation, as a part of the rows.
const LONGEST_LAG: usize = 4;
/// Correlations smaller than this end the sum.
const UNCORRELATED: f64 = 0.05;
/// Stretches of the log whose errors count as independent of each other.
const CLUSTERS: usize = 20;
/// Torque sensors are trimmed to about a per cent (one standard deviation). Masses that follow such an error explain it, so
/// that no log shows it.
pub(super) const TORQUE_SCALE: f64 = 0.01;
/// Hysteresis levels off at another torque than the width found says, and friction turns round within another width: half of
/// the way to the next one that was tried is one standard deviation.
const HALF_WAY: f64 = 0.5;
/// As long as a torque changes by less than this part of the rated one, hysteresis passes on the change as if the scale were
/// smaller by so many shares: a log with such changes alone cannot tell it from lighter bodies. Beyond, it levels off.
const LEVELS_OFF: f64 = 0.01;
const SMALL_CHANGE: f64 = 3.0;
/// The share that gears keep as a rule, where a log does not show more: 3 to 8 %.
const USUAL: f64 = 0.05;

/// Covariances of the unknowns.
pub(super) struct Uncertainty {
    pub stated: DMatrix<f64>,
    /// For torques at other poses: with what hysteresis hides in a log whose torques change little.
    pub elsewhere: DMatrix<f64>,
}

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

/// The covariances of the unknowns. Weights assume that errors have nothing to do with the motion; what hysteresis leaves has.
/// Where the spread of what stretches of the log pull at an unknown, by their held-out residuals, is larger, it counts
/// instead (cluster-robust covariance: Liang and Zeger 1986). What the scale of a torque may be off by, and hysteresis of a
/// form that levels off earlier or later and friction of one that turns round earlier or later, is added as what it would move the unknowns by (consider covariance).
/// `rated` is the torque that each joint is built for (Nm; N).
pub(super) fn covariance(
    unknowns: &Unknowns,
    joints: &Joints,
    rows: &[Row],
    used: &[bool],
    held_out: &HeldOut,
    solution: &Solution,
    rated: &[f64],
) -> Option<Uncertainty> {
    let kept = || rows.iter().zip(used).filter(|(_, used)| **used).map(|(row, _)| row);
    let normal = Normal::of(unknowns, joints, kept());
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
    let spread = spread.zip_map(&jackknife(&held_out.solutions), f64::max);
    // What the description said keeps its part of the uncertainty.
    let wider = |k: usize| {
        let prior = assumed.row(k).component_div(&solution.units.transpose()).norm_squared();
        ((spread[k] + prior) / assumed[(k, k)].max(f64::MIN_POSITIVE)).max(1.0).sqrt()
    };
    let wider: Vec<f64> = (0..unknowns.len()).map(wider).collect();
    let mut stated = DMatrix::from_fn(wider.len(), wider.len(), |a, b| assumed[(a, b)] * wider[a] * wider[b]);
    let mut hidden = DMatrix::zeros(stated.nrows(), stated.ncols());
    for (joint, rated) in rated.iter().enumerate() {
        let moved = |error: &dyn Fn(&Row) -> f64| {
            let mut pull = DVector::zeros(unknowns.columns());
            let mut entries = vec![];
            for row in kept() {
                entries.clear();
                columns(unknowns, joints, row, joint, &mut entries);
                let error = joints.weights[joint] * error(row);
                entries.iter().for_each(|&(column, value)| pull[column] += error * value);
            }
            &assumed * transposed_product(&derivative, &pull)
        };
        let by_scale = moved(&|row| TORQUE_SCALE * torque(row, joint));
        stated.ger(1.0, &by_scale, &by_scale, 1.0);
        let width = joints.shapes[joint].hysteresis;
        let share = width.map_or(0.0, |_| solution.z[unknowns.term(joint, HYSTERESIS)]);
        let [mean, deviation] = moments(kept().map(|row| torque(row, joint)));
        let linear = LEVELS_OFF * rated / deviation.max(f64::MIN_POSITIVE);
        let lost = SMALL_CHANGE * share.max(USUAL) * linear.min(1.0).powi(2);
        let by_small_changes = moved(&|row| lost * (torque(row, joint) - mean));
        hidden.ger(1.0, &by_small_changes, &by_small_changes, 1.0);
        let shape = joints.shapes[joint];
        let friction = solution.z[unknowns.term(joint, COULOMB)];
        for other in next_widths(shape.friction) {
            let share =
                |row: &Row, friction: usize| own_terms(row, joint, Shape { friction, ..shape })[COULOMB];
            let by_reversal =
                moved(&|row| HALF_WAY * friction * (share(row, other) - share(row, shape.friction)));
            stated.ger(1.0, &by_reversal, &by_reversal, 1.0);
        }
        let Some(width) = width else { continue };
        let size =
            |width: usize| rows.iter().map(|row| kept_back(row, joint, width).powi(2)).sum::<f64>().sqrt();
        for other in [width.saturating_sub(1), (width + 1).min(WIDTHS.len() - 1)] {
            let as_large = size(width) / size(other).max(f64::MIN_POSITIVE);
            let by_form = moved(&|row| {
                HALF_WAY * share * (as_large * kept_back(row, joint, other) - kept_back(row, joint, width))
            });
            stated.ger(1.0, &by_form, &by_form, 1.0);
        }
    }
    Some(Uncertainty { elsewhere: &stated + hidden, stated })
}

/// The ways of turning round alike that are the next narrower and the next wider one.
fn next_widths(now: usize) -> impl Iterator<Item = usize> {
    let alike = |k: &usize| discriminant(&REVERSALS[*k]) == discriminant(&REVERSALS[now]);
    let width = |k: &usize| REVERSALS[*k].width();
    let [narrower, wider] = [f64::lt, f64::gt].map(|lies: fn(&f64, &f64) -> bool| {
        (0..REVERSALS.len()).filter(alike).filter(move |k| lies(&width(k), &width(&now)))
    });
    let narrower = narrower.max_by(|a, b| width(a).total_cmp(&width(b)));
    narrower.into_iter().chain(wider.min_by(|a, b| width(a).total_cmp(&width(b))))
}

/// Mean and standard deviation.
fn moments(values: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
    let count = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / count;
    let variance = values.map(|value| (value - mean).powi(2)).sum::<f64>() / count;
    [mean, variance.sqrt()]
}

/// The variance of each unknown by what leaving out each block changes (jackknife: Quenouille 1956).
fn jackknife(solutions: &[DVector<f64>]) -> DVector<f64> {
    let count = solutions.len() as f64;
    let mean = solutions.iter().sum::<DVector<f64>>() / count;
    let squares = solutions.iter().map(|z| (z - &mean).map(|d| d * d)).sum::<DVector<f64>>();
    squares * ((count - 1.0) / count)
}
