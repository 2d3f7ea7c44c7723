//! The shape of each joint's friction and hysteresis: how friction turns round, and after which torque hysteresis levels off.

use nalgebra::{SMatrix, SVector};

use super::folds::{block_of, is_less, HeldOut, BLOCKS};
use super::friction::REVERSALS;
use super::hysteresis::WIDTHS;
use super::normal::{own_terms, residual, Joints, Shape};
use super::rows::Row;
use super::unknowns::{Unknowns, HYSTERESIS, TERMS};

/// White noise moves the elements of hysteresis too: the first width is at least so many of its standard deviations.
pub(super) const CLEAR_OF_NOISE: f64 = 3.0;

/// What each joint's own terms are chosen by.
pub(super) struct Choice<'a> {
    pub unknowns: &'a Unknowns,
    pub joints: &'a Joints,
    pub rows: &'a [Row],
    pub used: &'a [bool],
    pub held_out: &'a HeldOut,
    /// The first of the widths of hysteresis that is clear of noise, by joint.
    pub clear: &'a [usize],
}

impl Choice<'_> {
    /// The shapes that leave least on held-out blocks, when the joints' own terms are fitted anew. Hysteresis is kept only
    /// where it leaves less by more than one standard error over the blocks.
    /// All joints have it that may as long as shapes are not yet `settled`: without it, inertias explain what it does.
    pub fn shapes(&self, settled: bool) -> Vec<Shape> {
        (0..self.joints.weights.len()).map(|joint| self.shape(joint, settled)).collect()
    }

    fn shape(&self, joint: usize, settled: bool) -> Shape {
        let now = self.joints.shapes[joint];
        let others = (0..REVERSALS.len()).map(|friction| Shape { friction, ..now });
        let (with, _) = self.best(joint, now, others);
        let without = Shape { hysteresis: None, ..with };
        let widths = self.clear[joint]..WIDTHS.len();
        let (best, left) = self.best(joint, without, widths.map(|k| Shape { hysteresis: Some(k), ..with }));
        match self.left_of(joint, without) {
            _ if !settled => Shape { hysteresis: best.hysteresis.or(now.hysteresis), ..best },
            Some(before) if !is_less(&left.map(f64::ln), &before.map(f64::ln)) => without,
            _ => best,
        }
    }

    /// The one of some shapes that leaves least, `first` unless another one leaves less.
    fn best(
        &self,
        joint: usize,
        first: Shape,
        others: impl Iterator<Item = Shape>,
    ) -> (Shape, [f64; BLOCKS]) {
        let mut best = (first, self.left_of(joint, first).unwrap_or([f64::INFINITY; BLOCKS]));
        for shape in others.filter(|shape| *shape != first) {
            if let Some(left) = self.left_of(joint, shape) {
                if left.iter().sum::<f64>() < best.1.iter().sum() {
                    best = (shape, left);
                }
            }
        }
        best
    }

    /// The sum of squares over each held-out block.
    fn left_of(&self, joint: usize, shape: Shape) -> Option<[f64; BLOCKS]> {
        let Choice { unknowns, joints, rows, used, held_out, .. } = self;
        // What the joint's own terms have to explain: the residual with their present part put back.
        let target = |row: &Row, block: usize| {
            let correction = &held_out.corrections[block];
            let own = own_terms(row, joint, joints.shapes[joint]);
            let present: f64 =
                (0..TERMS).map(|term| own[term] * correction[unknowns.term_column(joint, term)]).sum();
            residual(unknowns, joints, row, joint, correction) + present
        };
        let mut left = [0.0; BLOCKS];
        for (block, left) in left.iter_mut().enumerate() {
            let (mut matrix, mut right) =
                (SMatrix::<f64, TERMS, TERMS>::zeros(), SVector::<f64, TERMS>::zeros());
            let mut judged = vec![];
            for (index, row) in rows.iter().enumerate().filter(|(index, _)| used[*index]) {
                let own = SVector::from(own_terms(row, joint, shape));
                let target = target(row, block);
                if block_of(index, rows.len()) == block {
                    judged.push((own, target));
                } else {
                    matrix += own * own.transpose();
                    right += own * target;
                }
            }
            // As weak a ridge as rounding needs.
            matrix += SMatrix::identity() * (1e-9 * matrix.trace());
            let terms = matrix.cholesky()?.solve(&right);
            // A torque that runs ahead is no hysteresis.
            if terms[HYSTERESIS] < 0.0 {
                return None;
            }
            *left = judged.iter().map(|(own, target)| (target - own.dot(&terms)).powi(2)).sum::<f64>();
        }
        Some(left)
    }
}
