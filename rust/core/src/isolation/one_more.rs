//! How well one more wrench would explain the torques that the wrenches of [`Stacked`] leave over: least squares in the
//! space that those do not reach, without a factorisation of its own.

use super::found::Scene;
use super::stacked::Stacked;

/// Components of a wrench.
const COMPONENTS: usize = 6;
/// A component of which less than this share is not in the others yet is no unknown of its own.
const INDEPENDENT: f64 = 1e-6;

impl Stacked {
    /// Projects the rows of the last estimate; to be called before [`Stacked::misfit_with`].
    pub fn prepare_one_more(&mut self) {
        let count = self.system.rows();
        for (row, projected) in self.projected.chunks_exact_mut(count.max(1)).take(count).enumerate() {
            projected.fill(0.0);
            projected[row] = 1.0;
            self.system.project_out(projected);
        }
    }

    /// Root mean square of what is left if a wrench on `body` is estimated, too, moments along the forces aside, in
    /// tolerances; none where the rows do not determine it.
    pub fn misfit_with(&mut self, scene: Scene, body: usize) -> Option<f64> {
        let (rank, count) = (self.system.rank(), self.system.rows());
        let rest = count - rank;
        if rest < COMPONENTS {
            return None;
        }
        let mut left: f64 = self.system.left_over().iter().map(|x| x * x).sum();
        let chain = scene.robot.chain(body);
        self.columns[..COMPONENTS * rest].fill(0.0);
        let mut sizes = [0.0; COMPONENTS];
        for (row, entry) in self.rows.iter().enumerate() {
            if entry.joint.is_some_and(|joint| !chain.contains(&joint)) {
                continue;
            }
            let projected = &self.projected[row * count + rank..(row + 1) * count];
            for (component, column) in self.columns.chunks_exact_mut(rest).take(COMPONENTS).enumerate() {
                let axis = entry.axis[component];
                sizes[component] += axis * axis;
                column.iter_mut().zip(projected).for_each(|(x, p)| *x += axis * p);
            }
        }
        for (component, unprojected) in sizes.iter().enumerate() {
            let (done, open) = self.columns.split_at_mut(component * rest);
            let column = &mut open[..rest];
            for other in done.chunks_exact(rest) {
                let share: f64 = other.iter().zip(&*column).map(|(a, x)| a * x).sum();
                column.iter_mut().zip(other).for_each(|(x, a)| *x -= share * a);
            }
            let size = column.iter().map(|x| x * x).sum::<f64>().sqrt();
            if size.is_nan() || size <= INDEPENDENT * unprojected.sqrt() {
                return None;
            }
            column.iter_mut().for_each(|x| *x /= size);
            let along: f64 = column.iter().zip(self.system.left_over()).map(|(a, r)| a * r).sum();
            left -= along * along;
        }
        let checks = rest - COMPONENTS + self.contacts + 1;
        Some((left.max(0.0) / checks as f64).sqrt())
    }
}
