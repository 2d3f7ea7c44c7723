//! Held-out blocks of a log: they choose how far bodies may differ from the description, and say what is left.

use nalgebra::{DMatrix, DVector};

use super::normal::{residual, Joints, Normal};
use super::rows::Row;
use super::solve::{solve, Solution};
use super::unknowns::Unknowns;

/// Consecutive blocks; each is judged by what the others teach.
const BLOCKS: usize = 5;
/// Shares by which bodies may differ from the description: from "as described" to "anything".
pub(super) const CHANGES: [f64; 8] = [1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0, 3.0];
/// Rows of one block.
const FEWEST_ROWS: usize = 10;

/// What is left of each row's torque when the blocks without it are fitted.
#[derive(Debug, Clone)]
pub(super) struct HeldOut {
    /// The share by which bodies may differ.
    pub change: f64,
    /// By row, `(nv,)` (Nm).
    pub residuals: Vec<DVector<f64>>,
    /// By block, what the others teach.
    pub corrections: Vec<DVector<f64>>,
}

/// The block of a row.
pub(super) fn block_of(row: usize, rows: usize) -> usize {
    row * BLOCKS / rows.max(1)
}

/// Whether a log has enough rows to be held out in part.
pub(super) fn enough(rows: usize) -> bool {
    rows >= BLOCKS * FEWEST_ROWS
}

/// The held-out residuals of the best choice among [`CHANGES`].
pub(super) fn hold_out(unknowns: &Unknowns, joints: &Joints, rows: &[Row], used: &[bool]) -> Option<HeldOut> {
    let block = |k: usize| {
        let of_block = move |(row, _): &(usize, &Row)| used[*row] && block_of(*row, rows.len()) == k;
        Normal::of(unknowns, joints, rows.iter().enumerate().filter(of_block).map(|(_, row)| row))
    };
    let blocks: Vec<Normal> = (0..BLOCKS).map(block).collect();
    let others: Vec<Normal> = (0..BLOCKS).map(|k| sum(&blocks, Some(k))).collect();
    let mut best: Option<(f64, HeldOut)> = None;
    for change in CHANGES {
        let fitted = others.iter().map(|normal| solve(unknowns, normal, change));
        let Some(fitted) = fitted.collect::<Option<Vec<Solution>>>() else { continue };
        let corrections: Vec<DVector<f64>> =
            fitted.iter().map(|solution| unknowns.correction(&solution.z)).collect();
        let left = |(index, row): (usize, &Row)| {
            let correction = &corrections[block_of(index, rows.len())];
            DVector::from_fn(joints.weights.len(), |j, _| residual(unknowns, joints, row, j, correction))
        };
        let residuals: Vec<DVector<f64>> = rows.iter().enumerate().map(left).collect();
        let score = score(&residuals, used);
        if best.as_ref().is_none_or(|(so_far, _)| score < *so_far) {
            best = Some((score, HeldOut { change, residuals, corrections }));
        }
    }
    best.map(|(_, held_out)| held_out)
}

/// The fit of all rows, and the covariance of its unknowns.
pub(super) fn fit(
    unknowns: &Unknowns,
    joints: &Joints,
    rows: &[Row],
    used: &[bool],
    change: f64,
) -> Option<(Solution, DMatrix<f64>)> {
    let kept = rows.iter().zip(used).filter(|(_, used)| **used).map(|(row, _)| row);
    let normal = Normal::of(unknowns, joints, kept);
    let solution = solve(unknowns, &normal, change)?;
    let covariance = solution.covariance(unknowns, &normal)?;
    Some((solution, covariance))
}

/// All blocks but one.
fn sum(blocks: &[Normal], without: Option<usize>) -> Normal {
    let mut kept = blocks.iter().enumerate().filter(|(k, _)| Some(*k) != without).map(|(_, block)| block);
    let mut sum = kept.next().cloned().unwrap_or_else(|| blocks[0].clone());
    kept.for_each(|block| sum.add(block));
    sum
}

/// The sum over joints of the logarithm of the mean square: no joint counts more because its torques are larger.
fn score(residuals: &[DVector<f64>], used: &[bool]) -> f64 {
    let joints = residuals.first().map_or(0, DVector::len);
    (0..joints).map(|j| mean_square(residuals, used, j).max(f64::MIN_POSITIVE).ln()).sum()
}

/// Of one joint, over the rows that are used (Nm squared).
pub(super) fn mean_square(residuals: &[DVector<f64>], used: &[bool], joint: usize) -> f64 {
    let squares = residuals.iter().zip(used).filter(|(_, used)| **used).map(|(r, _)| r[joint] * r[joint]);
    let (sum, count) = squares.fold((0.0, 0usize), |(sum, count), square| (sum + square, count + 1));
    sum / count.max(1) as f64
}
