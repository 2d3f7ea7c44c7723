//! Scale and sign of each torque, where a log tells them from masses.

use nalgebra::{SMatrix, SVector};

use super::complete_fit::Fit;
use super::folds::{hold_out, is_less, scores, HeldOut, CHANGES};
use super::normal::{own_terms, scaled, torque, Joints, Shape};
use super::rows::Row;
use super::uncertainty::weight;
use super::unknowns::{Unknowns, ARMATURE, BIAS, COULOMB, VISCOUS};
use crate::error::Result;

/// A scale that is nearer to one is the masses' business: descriptions are no better.
const LEAST: f64 = 0.1;
/// A scale may be one if it is at most so many standard errors away.
const SIGNIFICANT: f64 = 3.0;
/// Of neighbouring rows so many err together, as a rule.
const TOGETHER: f64 = 10.0;
/// One of the two torques, bias, friction, viscous friction and rotor inertia.
const COLUMNS: usize = 5;
/// Any shape: scale is told by motion, not by where it turns round.
const SHAPE: Shape = Shape { friction: 0, hysteresis: None };

/// Factors from measured to true torque: other than one only where held-out blocks leave less by more than one standard error,
/// whatever masses do. `unknowns_of` makes the unknowns for rows whose torques were multiplied.
pub(super) fn torque_scales(
    rows: &[Row],
    joints: usize,
    unknowns_of: impl Fn(&[f64], &[Row]) -> Unknowns,
) -> Vec<f64> {
    let found: Vec<f64> = (0..joints).map(|joint| likely(rows, joint)).collect();
    let mut scales = vec![1.0; joints];
    if found == scales {
        return scales;
    }
    let judge = |scales: &[f64]| judge(rows, scales, &unknowns_of);
    let mut best = judge(&scales);
    // All, their signs alone, and each alone: whichever leaves least.
    let signs: Vec<f64> = found.iter().map(|k| k.signum()).collect();
    let mut trials = vec![found.clone(), signs];
    trials.extend((0..joints).filter(|j| found[*j] != 1.0).map(|j| {
        let mut alone = vec![1.0; joints];
        alone[j] = found[j];
        alone
    }));
    let sum = |left: &Vec<f64>| left.iter().sum::<f64>();
    let judged = trials.into_iter().filter_map(|trial| judge(&trial).map(|left| (trial, left)));
    if let Some((trial, left)) = judged.min_by(|(_, a), (_, b)| sum(a).total_cmp(&sum(b))) {
        if best.as_ref().is_none_or(|best| is_less(&left, best)) {
            (scales, best) = (trial, Some(left));
        }
    }
    // A joint that does not need its scale has none; one whose size says nothing has only its sign.
    for joint in 0..joints {
        for simpler in [1.0, scales[joint].signum()] {
            let mut without = scales.clone();
            without[joint] = simpler;
            if without != scales {
                let left = judge(&without);
                if left.as_ref().is_some_and(|left| best.as_ref().is_none_or(|best| !is_less(best, left))) {
                    (scales, best) = (without, left);
                }
            }
        }
    }
    scales
}

/// The scales that are needed when each joint has the friction and hysteresis that its fit found, and the fit with them. A
/// gear with hysteresis passes on small changes of a torque as if its scale were smaller: a scale stays where held-out blocks
/// leave less with it than with hysteresis alone.
pub(super) fn needed(
    mut scales: Vec<f64>,
    fit_of: impl Fn(&[f64]) -> Result<Fit>,
) -> Result<(Vec<f64>, Fit)> {
    let mut fit = fit_of(&scales)?;
    for joint in 0..scales.len() {
        let mut without = scales.clone();
        without[joint] = scales[joint].signum();
        if without == scales {
            continue;
        }
        let Ok(simpler) = fit_of(&without) else { continue };
        let (with, alone) = left_of([&fit, &simpler], [&scales, &without]);
        if !is_less(&with, &alone) {
            (scales, fit) = (without, simpler);
        }
    }
    Ok((scales, fit))
}

/// What held-out blocks of two fits leave in the rows that both use, in units of the measured torque.
fn left_of(fits: [&Fit; 2], scales: [&[f64]; 2]) -> (Vec<f64>, Vec<f64>) {
    let used: Vec<bool> = fits[0].used.iter().zip(&fits[1].used).map(|(a, b)| *a && *b).collect();
    let left = |k: usize| measured(scores(&fits[k].held_out.residuals, &used), scales[k]);
    (left(0), left(1))
}

/// Scores of residuals of scaled torques, in units of the measured ones.
fn measured(scores: Vec<f64>, scales: &[f64]) -> Vec<f64> {
    let growth: f64 = scales.iter().map(|scale| 2.0 * scale.abs().ln()).sum();
    scores.iter().map(|score| score - growth).collect()
}

/// The factor from a joint's measured torque to that of the description, friction and bias aside; one where it may be one.
///
/// Errors of what a line is fitted over make it flat: of the measured torque over the description's as well as the other way
/// round. The truth lies between the two slopes, and both must tell that it is not one.
fn likely(rows: &[Row], joint: usize) -> f64 {
    let (Some(forth), Some(inverse)) = (Slope::new(rows, joint, false), Slope::new(rows, joint, true)) else {
        return 1.0;
    };
    let (over_measured, over_model) = (forth.value, 1.0 / inverse.value);
    let is_same_side = over_measured * over_model > 0.0 && (over_measured - 1.0) * (over_model - 1.0) > 0.0;
    let scale = (over_measured * over_model).sqrt().copysign(over_measured);
    if forth.is_one() || inverse.is_one() || !is_same_side || !scale.is_finite() || scale == 0.0 {
        // Its sign may be told nevertheless, by friction as well.
        return if forth.value < 0.0 && !forth.is_one() { -1.0 } else { 1.0 };
    }
    if (scale + 1.0).abs() <= LEAST {
        -1.0
    } else {
        scale
    }
}

/// Of a line through a joint's torques: the description's over the measured, or the other way round.
struct Slope {
    value: f64,
    error: f64,
}

impl Slope {
    fn new(rows: &[Row], joint: usize, over_model: bool) -> Option<Slope> {
        let (mut matrix, mut right) =
            (SMatrix::<f64, COLUMNS, COLUMNS>::zeros(), SVector::<f64, COLUMNS>::zeros());
        let mut square = 0.0;
        for row in rows {
            let own = own_terms(row, joint, SHAPE);
            let (measured, model) = (torque(row, joint), torque(row, joint) - row.unexplained[joint]);
            let (over, fitted) = if over_model { (model, measured) } else { (measured, model) };
            let columns = SVector::from([over, own[BIAS], own[COULOMB], own[VISCOUS], own[ARMATURE]]);
            matrix += columns * columns.transpose();
            right += columns * fitted;
            square += fitted * fitted;
        }
        let inverse = matrix.try_inverse()?;
        let found = inverse * right;
        let left = (square - found.dot(&right)).max(0.0) / rows.len() as f64;
        Some(Slope { value: found[0], error: (left * TOGETHER * inverse[(0, 0)]).sqrt() })
    }

    /// Whether it may be one.
    fn is_one(&self) -> bool {
        (self.value - 1.0).abs() <= f64::max(LEAST, SIGNIFICANT * self.error) || self.value.is_nan()
    }
}

/// What held-out blocks leave with these scales, in units of the measured torque.
fn judge(rows: &[Row], scales: &[f64], unknowns_of: impl Fn(&[f64], &[Row]) -> Unknowns) -> Option<Vec<f64>> {
    let rows: Vec<Row> = rows.iter().map(|row| scaled(row, scales)).collect();
    let unknowns = unknowns_of(scales, &rows);
    let used = vec![true; rows.len()];
    let unexplained: Vec<_> = rows.iter().map(|row| row.unexplained.clone()).collect();
    let weights = (0..scales.len()).map(|j| weight(&unexplained, &used, j)).collect();
    let joints = Joints { weights, shapes: vec![SHAPE; scales.len()] };
    let HeldOut { scores, .. } = hold_out(&unknowns, &joints, &rows, &used, &CHANGES)?;
    Some(measured(scores, scales))
}
