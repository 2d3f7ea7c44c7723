//! Rows that act on one wrench, reduced to a triangle as they come.

use nalgebra::{SMatrix, Vector6};

/// Balances moments against forces in rank decisions: a typical lever arm [m].
pub(super) const LEVER: f64 = 0.3;
/// Rows that one factorisation takes in: six of the triangle so far and six new ones.
const BLOCK: usize = 12;

/// The triangle so far, and rows that it has not taken in yet.
#[derive(Debug, Clone)]
pub(super) struct WrenchRows {
    rows: SMatrix<f64, BLOCK, 7>,
    filled: usize,
    pub count: usize,
    /// Sum of squares that no wrench explains.
    pub unexplained: f64,
}

impl WrenchRows {
    pub fn new() -> Self {
        Self { rows: SMatrix::zeros(), filled: 0, count: 0, unexplained: 0.0 }
    }

    /// A torque with its column and weight.
    #[inline]
    pub fn push(&mut self, axis: &Vector6<f64>, torque: f64, weight: f64) {
        if self.filled == BLOCK {
            self.reduce();
        }
        for i in 0..3 {
            self.rows[(self.filled, i)] = axis[i] * weight;
            self.rows[(self.filled, 3 + i)] = axis[3 + i] * weight / LEVER;
        }
        self.rows[(self.filled, 6)] = torque * weight;
        self.filled += 1;
        self.count += 1;
    }

    /// The upper triangle of a QR factorisation and its right side; moments scaled by [`LEVER`].
    pub fn triangle(&mut self) -> SMatrix<f64, 6, 7> {
        self.reduce();
        self.rows.fixed_view::<6, 7>(0, 0).into_owned()
    }

    /// What the right side leaves over is added to `unexplained`.
    fn reduce(&mut self) {
        let upper = self.rows.qr().r();
        self.unexplained += upper[(6, 6)] * upper[(6, 6)];
        self.rows.fill(0.0);
        self.rows.fixed_view_mut::<6, 7>(0, 0).copy_from(&upper.fixed_view::<6, 7>(0, 0));
        self.filled = 6;
    }
}
