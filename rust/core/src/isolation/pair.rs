//! The wrenches on two bodies from all torques at once (Vorndamme 2017, eq. 28 for two contacts).
//!
//! Unknowns are the wrench on the second body and the sum of both: joints before both bodies feel the sum alone, so
//! the rank deficit (eq. 31) is all in the second wrench, and the first is the difference.

use nalgebra::{Matrix6, SMatrix, Vector6};

use super::region::Region;
use super::rows::TorqueRows;
use super::wrench::{full_rank_inverse, WrenchEstimate, RANK_TOLERANCE, SVD_ITERATIONS};
use super::wrench_rows::WrenchRows;
use crate::robot::Robot;

type Matrix6x12 = SMatrix<f64, 6, 12>;

/// Shares of the directions that the torques leave open.
pub(super) type Open = [f64; 6];

/// The wrenches of two contacts, up to what the torques leave open. Moments are scaled by the lever.
#[derive(Debug, Clone)]
pub(super) struct PairEstimate {
    /// The bodies touched.
    pub bodies: [usize; 2],
    total: Vector6<f64>,
    second: Vector6<f64>,
    /// Its first `deficit` columns can be added to the second wrench and taken from the first; the torques fix the
    /// second wrench along the others.
    pub basis: Matrix6<f64>,
    pub deficit: usize,
    /// Covariance roots of both wrenches.
    roots: [Matrix6<f64>; 2],
    unexplained: f64,
    redundant: usize,
}

/// Joints that feel both contacts, or one.
enum Side {
    Both,
    First,
    Second,
}

/// Least squares; none where the joints before both bodies do not determine the sum of the wrenches.
pub(super) fn estimate_pair(
    robot: &Robot,
    region: &Region,
    rows: &TorqueRows,
    bodies: [usize; 2],
) -> Option<PairEstimate> {
    let mut parts = [WrenchRows::new(), WrenchRows::new(), WrenchRows::new()];
    rows.push_root(&mut parts[Side::Both as usize]);
    for joint in region.chain(robot, bodies[0]) {
        let side = if robot.moves(joint, bodies[1]) { Side::Both } else { Side::First };
        rows.push_joint(robot, joint, &mut parts[side as usize]);
    }
    for joint in region.chain(robot, bodies[1]).filter(|joint| !robot.moves(*joint, bodies[0])) {
        rows.push_joint(robot, joint, &mut parts[Side::Second as usize]);
    }
    let count: usize = parts.iter().map(|part| part.count).sum();

    // Columns: second wrench, sum, right side.
    let mut stacked = SMatrix::<f64, 18, 13>::zeros();
    let mut unexplained = 0.0;
    for (part, (row, on_second, on_total)) in
        parts.iter_mut().zip([(12, 0.0, 1.0), (6, -1.0, 1.0), (0, 1.0, 0.0)])
    {
        if part.count == 0 {
            continue;
        }
        let triangle = part.triangle();
        let factor = triangle.fixed_view::<6, 6>(0, 0);
        stacked.fixed_view_mut::<6, 6>(row, 0).copy_from(&(factor * on_second));
        stacked.fixed_view_mut::<6, 6>(row, 6).copy_from(&(factor * on_total));
        stacked.fixed_view_mut::<6, 1>(row, 12).copy_from(&triangle.fixed_view::<6, 1>(0, 6));
        unexplained += part.unexplained;
    }
    let upper = stacked.qr().r();
    unexplained += upper[(12, 12)] * upper[(12, 12)];
    let block = |row, column| upper.fixed_view::<6, 6>(row, column).into_owned();
    let total_inverse = full_rank_inverse(&block(6, 6))?;
    let total = total_inverse * upper.fixed_view::<6, 1>(6, 12);
    let (factor, coupling) = (block(0, 0), block(0, 6));
    let rhs = upper.fixed_view::<6, 1>(0, 12) - coupling * total;
    let (inverse, basis, deficit) = match full_rank_inverse(&factor) {
        Some(inverse) => (inverse, Matrix6::identity(), 0),
        None => pseudo_inverse(&factor)?,
    };
    let mut root_total = Matrix6x12::zeros();
    root_total.fixed_view_mut::<6, 6>(0, 6).copy_from(&total_inverse);
    let mut root_second = Matrix6x12::zeros();
    root_second.fixed_view_mut::<6, 6>(0, 0).copy_from(&inverse);
    root_second.fixed_view_mut::<6, 6>(0, 6).copy_from(&(-(inverse * coupling * total_inverse)));
    Some(PairEstimate {
        bodies,
        total,
        second: inverse * rhs,
        basis,
        deficit,
        roots: [square_root(&(root_total - root_second)), square_root(&root_second)],
        unexplained,
        redundant: usize::saturating_sub(count + deficit, 12),
    })
}

impl PairEstimate {
    /// The wrenches with the open part given; both estimates carry the misfit of both.
    pub fn wrenches(&self, open: &Open) -> [WrenchEstimate; 2] {
        // Open directions were chosen so that a force has no moment along itself: they check nothing.
        let redundant = (self.redundant + 1).saturating_sub(self.deficit);
        let [first, second] = self.scaled(open);
        [(first, &self.roots[0]), (second, &self.roots[1])].map(|(wrench, root)| {
            let rank = 6 - self.deficit;
            WrenchEstimate::new(&wrench, *root, rank, self.unexplained, redundant)
        })
    }

    /// The sum of both wrenches, the moment scaled by the lever.
    pub fn total(&self) -> Vector6<f64> {
        self.total
    }

    /// Both wrenches, moments scaled by the lever.
    pub fn scaled(&self, open: &Open) -> [Vector6<f64>; 2] {
        let mut second = self.second;
        for (column, share) in self.basis.column_iter().zip(open).take(self.deficit) {
            second += column * *share;
        }
        [self.total - second, second]
    }

    /// Sum of squares of what no two wrenches explain, in tolerances.
    pub fn unexplained_squares(&self) -> f64 {
        self.unexplained
    }

    /// Root mean square of what no two wrenches explain, in tolerances.
    pub fn unexplained_share(&self) -> f64 {
        (self.unexplained / self.redundant.max(1) as f64).sqrt()
    }

    /// How many conditions the two forces were not fitted to.
    pub fn checks(&self) -> usize {
        (self.redundant + 2).saturating_sub(self.deficit.min(2))
    }

    /// Root mean square of what contradicts two forces without moment, in tolerances.
    pub fn misfit(&self, wrenches: &[WrenchEstimate; 2]) -> f64 {
        let moments = wrenches.iter().map(|wrench| wrench.moment_along().powi(2)).sum::<f64>();
        ((self.unexplained + moments) / self.checks().max(1) as f64).sqrt()
    }
}

/// A 6 x 6 root of the same covariance.
fn square_root(root: &Matrix6x12) -> Matrix6<f64> {
    root.transpose().qr().r().transpose()
}

/// Pseudoinverse, a basis with the null space in its first columns, and their number.
fn pseudo_inverse(factor: &Matrix6<f64>) -> Option<(Matrix6<f64>, Matrix6<f64>, usize)> {
    let svd = factor.try_svd(true, true, f64::EPSILON, SVD_ITERATIONS)?;
    let tolerance = RANK_TOLERANCE * svd.singular_values.max();
    let right = svd.v_t.as_ref()?;
    let mut basis = Matrix6::zeros();
    let (mut deficit, mut last) = (0, 6);
    for (value, row) in svd.singular_values.iter().zip(right.row_iter()) {
        let column = if *value <= tolerance {
            deficit += 1;
            deficit - 1
        } else {
            last -= 1;
            last
        };
        basis.set_column(column, &row.transpose());
    }
    Some((svd.pseudo_inverse(tolerance).ok()?, basis, deficit))
}
