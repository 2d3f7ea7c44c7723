//! How the Coulomb friction of each joint turns round.

use nalgebra::{DVector, Matrix4, Vector4};

use super::folds::{block_of, HeldOut};
use super::normal::{own_terms, residual, Joints};
use super::rows::Row;
use super::torque_model::REVERSALS;
use super::unknowns::{Unknowns, TERMS};

/// The reversal of each joint's friction that leaves least on held-out blocks, when the joint's own terms are fitted anew.
pub(super) fn choose_reversals(
    unknowns: &Unknowns,
    joints: &Joints,
    rows: &[Row],
    used: &[bool],
    held_out: &HeldOut,
) -> Vec<usize> {
    let choose = |joint: usize| {
        let now = joints.friction[joint];
        let score = |friction: usize| left_of(unknowns, joints, rows, used, held_out, (joint, friction));
        let mut best = (score(now).unwrap_or(f64::INFINITY), now);
        for friction in (0..REVERSALS.len()).filter(|friction| *friction != now) {
            let left = score(friction).unwrap_or(f64::INFINITY);
            if left < best.0 {
                best = (left, friction);
            }
        }
        best.1
    };
    (0..joints.weights.len()).map(choose).collect()
}

/// The sum of squares over held-out blocks.
fn left_of(
    unknowns: &Unknowns,
    joints: &Joints,
    rows: &[Row],
    used: &[bool],
    held_out: &HeldOut,
    (joint, friction): (usize, usize),
) -> Option<f64> {
    // What the joint's own terms have to explain: the residual with their present part put back.
    let target = |row: &Row, correction: &DVector<f64>| {
        let own = own_terms(row, joint, joints.friction[joint]);
        let present: f64 =
            (0..TERMS).map(|term| own[term] * correction[unknowns.term_column(joint, term)]).sum();
        residual(unknowns, joints, row, joint, correction) + present
    };
    let mut left = 0.0;
    for (block, correction) in held_out.corrections.iter().enumerate() {
        let (mut matrix, mut right) = (Matrix4::zeros(), Vector4::zeros());
        let mut judged = vec![];
        for (index, row) in rows.iter().enumerate().filter(|(index, _)| used[*index]) {
            let own = Vector4::from(own_terms(row, joint, friction));
            let target = target(row, correction);
            if block_of(index, rows.len()) == block {
                judged.push((own, target));
            } else {
                matrix += own * own.transpose();
                right += own * target;
            }
        }
        // As weak a ridge as rounding needs.
        matrix += Matrix4::identity() * (1e-9 * matrix.trace());
        let terms = matrix.cholesky()?.solve(&right);
        left += judged.iter().map(|(own, target)| (target - own.dot(&terms)).powi(2)).sum::<f64>();
    }
    Some(left)
}
