//! Held-out blocks of a log: they choose how far bodies may differ from the description, and say what is left.

use nalgebra::DVector;

use super::normal::{residual, Joints, Normal};
use super::rows::Row;
use super::solve::{solve, Solution};
use super::unknowns::Unknowns;

/// Consecutive blocks; each is judged by what the others teach.
pub(super) const BLOCKS: usize = 5;
/// Shares by which bodies may differ from the description: from what no description knows better, to anything.
pub(super) const CHANGES: [f64; 6] = [0.02, 0.05, 0.1, 0.3, 1.0, 3.0];
/// How far bodies are off as a rule.
pub(super) const USUAL_CHANGE: [f64; 1] = [0.1];
/// Share of a block at each end that is not fitted when others are judged.
const MARGIN: f64 = 0.125;
/// Mean squares that differ by so little (share, by joint) are equally good.
const NO_MATTER: f64 = 0.02;
/// Rows of one block.
const FEWEST_ROWS: usize = 10;

/// What is left of each row's torque when the blocks without it are fitted.
#[derive(Debug, Clone)]
pub(super) struct HeldOut {
    /// The share by which bodies may differ.
    pub change: f64,
    /// By block, the sum over joints of the logarithm of the mean square.
    pub scores: Vec<f64>,
    /// By row, `(nv,)` (Nm).
    pub residuals: Vec<DVector<f64>>,
    /// By block, what the others teach: unknowns, and what they add to the description.
    pub solutions: Vec<DVector<f64>>,
    pub corrections: Vec<DVector<f64>>,
}

/// The block of a row.
pub(super) fn block_of(row: usize, rows: usize) -> usize {
    row * BLOCKS / rows.max(1)
}

/// Whether a row is in a block and not next to another: errors there are alike on both sides.
fn is_inside(row: usize, rows: usize, block: usize) -> bool {
    let place = (row * BLOCKS) as f64 / rows.max(1) as f64 - block as f64;
    (MARGIN..1.0 - MARGIN).contains(&place)
}

/// Whether a log has enough rows to be held out in part.
pub(super) fn enough(rows: usize) -> bool {
    rows >= BLOCKS * FEWEST_ROWS
}

/// The held-out residuals of the best choice among some of [`CHANGES`].
pub(super) fn hold_out(
    unknowns: &Unknowns,
    joints: &Joints,
    rows: &[Row],
    used: &[bool],
    changes: &[f64],
) -> Option<HeldOut> {
    let block = |k: usize| {
        let of_block = move |(row, _): &(usize, &Row)| used[*row] && is_inside(*row, rows.len(), k);
        Normal::of(unknowns, joints, rows.iter().enumerate().filter(of_block).map(|(_, row)| row))
    };
    let blocks: Vec<Normal> = (0..BLOCKS).map(block).collect();
    let others: Vec<Normal> = (0..BLOCKS).map(|k| sum(&blocks, Some(k))).collect();
    let tried = changes.iter().filter_map(|&change| {
        let fitted = others.iter().map(|normal| solve(unknowns, normal, change));
        let fitted = fitted.collect::<Option<Vec<Solution>>>()?;
        let corrections: Vec<DVector<f64>> =
            fitted.iter().map(|solution| unknowns.correction(&solution.z)).collect();
        let left = |(index, row): (usize, &Row)| {
            let correction = &corrections[block_of(index, rows.len())];
            DVector::from_fn(joints.weights.len(), |j, _| residual(unknowns, joints, row, j, correction))
        };
        let residuals: Vec<DVector<f64>> = rows.iter().enumerate().map(left).collect();
        let solutions = fitted.into_iter().map(|solution| solution.z).collect();
        Some(HeldOut { change, scores: scores(&residuals, used), residuals, solutions, corrections })
    });
    nearest_as_good(tried.collect(), joints.weights.len())
}

/// The choice that is nearest to the description among those that are as good as the best, to one standard error over the
/// blocks (Breiman et al. 1984): what a log cannot tell stays as described.
fn nearest_as_good(mut tried: Vec<HeldOut>, joints: usize) -> Option<HeldOut> {
    let mean = |scores: &[f64]| scores.iter().sum::<f64>() / scores.len() as f64;
    let best = tried.iter().map(|tried| &tried.scores).min_by(|a, b| mean(a).total_cmp(&mean(b)))?.clone();
    let as_good = |tried: &HeldOut| {
        let (by, error) = gain(&best, &tried.scores);
        by <= f64::max(error, NO_MATTER * joints as f64)
    };
    let chosen = tried.iter().position(as_good)?;
    Some(tried.swap_remove(chosen))
}

/// By how much blocks have less left than before (logarithms), in the mean, and its standard error.
fn gain(left: &[f64], before: &[f64]) -> (f64, f64) {
    let gains: Vec<f64> = before.iter().zip(left).map(|(before, left)| before - left).collect();
    let count = gains.len() as f64;
    let mean = gains.iter().sum::<f64>() / count;
    let variance = gains.iter().map(|gain| (gain - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}

/// Whether blocks have less left than before (logarithms), by more than one standard error.
pub(super) fn is_less(left: &[f64], before: &[f64]) -> bool {
    let (mean, error) = gain(left, before);
    mean > error
}

/// The fit of all rows.
pub(super) fn fit(
    unknowns: &Unknowns,
    joints: &Joints,
    rows: &[Row],
    used: &[bool],
    change: f64,
) -> Option<Solution> {
    let kept = rows.iter().zip(used).filter(|(_, used)| **used).map(|(row, _)| row);
    let normal = Normal::of(unknowns, joints, kept);
    solve(unknowns, &normal, change)
}

/// All blocks but one.
fn sum(blocks: &[Normal], without: Option<usize>) -> Normal {
    let mut kept = blocks.iter().enumerate().filter(|(k, _)| Some(*k) != without).map(|(_, block)| block);
    let mut sum = kept.next().cloned().unwrap_or_else(|| blocks[0].clone());
    kept.for_each(|block| sum.add(block));
    sum
}

/// By block, the sum over joints of the logarithm of the mean square: no joint counts more because its torques are larger.
pub(super) fn scores(residuals: &[DVector<f64>], used: &[bool]) -> Vec<f64> {
    let joints = residuals.first().map_or(0, DVector::len);
    let score = |block: usize| {
        let rows = (0..residuals.len()).filter(|row| used[*row] && block_of(*row, residuals.len()) == block);
        let rows: Vec<usize> = rows.collect();
        let square = |j: usize| rows.iter().map(|row| residuals[*row][j].powi(2)).sum::<f64>();
        let count = rows.len().max(1) as f64;
        (0..joints).map(|j| (square(j) / count).max(f64::MIN_POSITIVE).ln()).sum()
    };
    (0..BLOCKS).map(score).collect()
}

/// Of one joint, over the rows that are used (Nm squared).
pub(super) fn mean_square(residuals: &[DVector<f64>], used: &[bool], joint: usize) -> f64 {
    let squares = residuals.iter().zip(used).filter(|(_, used)| **used).map(|(r, _)| r[joint] * r[joint]);
    let (sum, count) = squares.fold((0.0, 0usize), |(sum, count), square| (sum + square, count + 1));
    sum / count.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_counts_where_blocks_agree_on_it() {
        let before = [1.0; BLOCKS];
        assert!(is_less(&[0.5; BLOCKS], &before));
        assert!(!is_less(&before, &before));
        assert!(!is_less(&[0.2, 1.5, 0.9, 1.2, 1.0], &before));
    }
}
