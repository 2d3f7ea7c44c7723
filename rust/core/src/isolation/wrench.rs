//! The wrench on one body by the weighted pseudoinverse of its Jacobian (Vorndamme 2017, eq. 23).

use nalgebra::{Matrix3x6, Matrix6, Vector3, Vector6};

use super::wrench_rows::{WrenchRows, LEVER};
use crate::math::chi_square::upper_limit;
use crate::robot::jacobian::for_each_column;
use crate::robot::{Kinematics, Robot};
use crate::spatial::basis;
use crate::spatial::vector::{split, stack};

/// Singular values below this share of the largest count as zero.
pub(super) const RANK_TOLERANCE: f64 = 1e-7;
/// An SVD of a finite 6 x 6 matrix converges within a few sweeps; this bounds the time.
pub(super) const SVD_ITERATIONS: usize = 200;
/// Standard deviation of a torque in thresholds: thresholds are taken to lie three standard deviations above zero.
pub(super) const DEVIATION: f64 = 1.0 / 3.0;
/// Unknowns of a force on a line of action: a contact is checked only by torques beyond these.
pub(super) const LINE_UNKNOWNS: usize = 5;
/// A hypothesis is unlikely if its chi-square exceeds the best one's by this: a likelihood ratio of 100.
pub(super) const UNLIKELY: f64 = 9.21;

/// The kinematics' origin, which the moments of all wrenches refer to: so a rank is the same wherever it is asked for.
pub(super) const ORIGIN: Vector3<f64> = Vector3::new(0.0, 0.0, 0.0);

/// What the torques of a chain say of a wrench on its last body.
#[derive(Debug, Clone)]
pub(super) struct WrenchEstimate {
    pub force: Vector3<f64>,
    /// About [`ORIGIN`].
    pub moment: Vector3<f64>,
    pub rank: usize,
    /// `root * root^T` is the covariance of the wrench if each torque's standard deviation is its threshold.
    root: Matrix6<f64>,
    /// Sum of squares that no wrench explains, in thresholds, and how many torques are redundant.
    unexplained: f64,
    redundant: usize,
    /// Standard deviation of a torque in tolerances.
    deviation: f64,
}

/// Least squares over the chain of `body`, each torque weighted by its threshold.
pub(super) fn estimate_wrench(
    robot: &Robot,
    kinematics: &Kinematics,
    body: usize,
    torque: &[f64],
    threshold: &[f64],
) -> WrenchEstimate {
    let mut rows = WrenchRows::new();
    for_each_column(robot, kinematics, body, &ORIGIN, |k, column| {
        rows.push(&column, torque[k], 1.0 / threshold[k]);
    });
    WrenchEstimate::from_rows(rows)
}

/// The inverse of a triangle that is safely regular: its norm bounds the smallest singular value from below.
pub(super) fn full_rank_inverse(factor: &Matrix6<f64>) -> Option<Matrix6<f64>> {
    let inverse = factor.solve_upper_triangular(&Matrix6::identity())?;
    let condition = factor.norm() * inverse.norm();
    (condition.is_finite() && condition < 1.0 / RANK_TOLERANCE).then_some(inverse)
}

/// Minimum-norm solution, its covariance root and the rank.
pub(super) fn minimum_norm(factor: &Matrix6<f64>, rhs: &Vector6<f64>) -> (Vector6<f64>, Matrix6<f64>, usize) {
    let Some(svd) = factor.try_svd(true, true, f64::EPSILON, SVD_ITERATIONS) else {
        return (Vector6::zeros(), Matrix6::zeros(), 0);
    };
    let tolerance = RANK_TOLERANCE * svd.singular_values.max();
    let rank = svd.singular_values.iter().filter(|value| **value > tolerance).count();
    match svd.pseudo_inverse(tolerance) {
        Ok(inverse) => (inverse * rhs, inverse, rank),
        Err(_) => (Vector6::zeros(), Matrix6::zeros(), rank),
    }
}

impl WrenchEstimate {
    /// Least squares; minimum norm where the rows leave the wrench open.
    pub fn from_rows(mut rows: WrenchRows) -> Self {
        let triangle = rows.triangle();
        let factor: Matrix6<f64> = triangle.fixed_view::<6, 6>(0, 0).into_owned();
        let rhs: Vector6<f64> = triangle.fixed_view::<6, 1>(0, 6).into_owned();
        let (solution, root, rank) = match full_rank_inverse(&factor) {
            Some(inverse) => (inverse * rhs, inverse, 6),
            None => minimum_norm(&factor, &rhs),
        };
        let redundant = rows.count.saturating_sub(6);
        Self::new(&solution, root, rank, rows.unexplained, redundant)
    }

    /// Of a solution and its covariance's root whose moments are scaled by the lever.
    pub fn new(
        solution: &Vector6<f64>,
        mut root: Matrix6<f64>,
        rank: usize,
        unexplained: f64,
        redundant: usize,
    ) -> Self {
        for i in 3..6 {
            root.row_mut(i).unscale_mut(LEVER);
        }
        let (force, moment) = split(solution);
        Self { force, moment: moment / LEVER, rank, root, unexplained, redundant, deviation: DEVIATION }
    }

    /// The point of the line of action nearest to [`ORIGIN`] (Vorndamme 2017, eq. 26), and its direction.
    pub fn line_of_action(&self) -> Option<(Vector3<f64>, Vector3<f64>)> {
        let size = self.force.norm();
        if size.is_nan() || size < f64::MIN_POSITIVE.sqrt() {
            return None;
        }
        let start = self.force.cross(&self.moment) / (size * size);
        Some((start, self.force / size))
    }

    /// Torque of one joint column that this wrench causes.
    pub fn torque_on(&self, column: &Vector6<f64>) -> f64 {
        let (linear, angular) = split(column);
        linear.dot(&self.force) + angular.dot(&self.moment)
    }

    /// Standard deviation of the force as a share of it.
    pub fn force_spread(&self) -> f64 {
        self.root.fixed_rows::<3>(0).norm() / self.force.norm() * self.torque_deviation()
    }

    /// Two displacements of the line at a point of it, across the line and each other, by one standard deviation (m).
    pub fn displacements(&self, point: &Vector3<f64>) -> [Vector3<f64>; 2] {
        let root = self.displacement_root(point);
        let along = self.force / self.force.norm();
        let first = basis::across(&along);
        [first, along.cross(&first)].map(|direction| direction * root.tr_mul(&direction).norm())
    }

    /// The same along the axes of the ellipse that holds one standard deviation, the longer first.
    pub fn principal_displacements(&self, point: &Vector3<f64>) -> [Vector3<f64>; 2] {
        let root = self.displacement_root(point);
        let along = self.force / self.force.norm();
        let first = basis::across(&along);
        let second = along.cross(&first);
        let [on_first, on_second] = [first, second].map(|direction| root.tr_mul(&direction));
        let (difference, product) =
            (on_first.norm_squared() - on_second.norm_squared(), on_first.dot(&on_second));
        let (sin, cos) = (0.5 * f64::atan2(2.0 * product, difference)).sin_cos();
        [first * cos + second * sin, second * cos - first * sin]
            .map(|direction| direction * root.tr_mul(&direction).norm())
    }

    /// A root of the covariance of the line's point next to `point`, across the line.
    fn displacement_root(&self, point: &Vector3<f64>) -> Matrix3x6<f64> {
        let lever = point.cross_matrix();
        let across = self.force.cross_matrix() / self.force.norm_squared();
        let mut map = Matrix3x6::zeros();
        map.fixed_view_mut::<3, 3>(0, 0).copy_from(&(-(across * lever)));
        map.fixed_view_mut::<3, 3>(0, 3).copy_from(&across);
        map * self.root * self.torque_deviation()
    }

    /// For tolerances that were wider than what the errors of the torques are taken to be, by at least this share.
    pub fn narrow(&mut self, share: f64) {
        self.deviation = DEVIATION * share;
    }

    /// Standard deviation of a torque in thresholds: more than [`DEVIATION`] where the torques contradict one force, and
    /// never less, since one or two redundant torques agree by chance.
    fn torque_deviation(&self) -> f64 {
        self.misfit().max(self.deviation)
    }

    /// Sum of squares of what contradicts a single force without moment, in standard deviations of the torques, and
    /// how many independent checks that is.
    pub fn chi_square(&self) -> (f64, usize) {
        let moment = self.moment_along();
        ((self.unexplained + moment * moment) / (DEVIATION * DEVIATION), self.redundant + 1)
    }

    /// Whether the moment along the force is no more than noise. Beside many redundant torques it would not be noticed, and
    /// it is what two contacts on one chain differ by from one.
    pub fn is_force(&self) -> bool {
        (self.moment_along() / DEVIATION).powi(2) <= upper_limit(1)
    }

    /// Whether there are more torques than components of the wrench.
    pub fn is_redundant(&self) -> bool {
        self.redundant > 0
    }

    /// How far the torque of a joint that was not used is from what the wrench causes there, in standard deviations of
    /// the difference; `threshold` is the joint's.
    pub fn innovation(&self, column: &Vector6<f64>, torque: f64, threshold: f64) -> f64 {
        let spread = self.root.tr_mul(column).norm().hypot(threshold) * DEVIATION;
        (self.torque_on(column) - torque).abs() / spread
    }

    /// Root mean square of what contradicts a single force without moment, in thresholds.
    pub fn misfit(&self) -> f64 {
        let moment = self.moment_along();
        ((self.unexplained + moment * moment) / (self.redundant + 1) as f64).sqrt()
    }

    /// The moment along the force, in standard deviations of it for torques that err by one tolerance: a force on a
    /// line has none.
    pub fn moment_along(&self) -> f64 {
        let size = self.force.norm();
        let along = self.force.dot(&self.moment) / size;
        let gradient = stack(&(self.moment / size), &(self.force / size));
        let deviation = self.root.tr_mul(&gradient).norm();
        if deviation > 0.0 {
            along / deviation
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;

    #[test]
    fn principal_displacements_are_the_axes_of_the_covariance() {
        let robot = Robot::example_arm();
        let mut kinematics = Kinematics::new(&robot);
        kinematics.set_configuration(&robot, &[0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.0]);
        let torque = [0.4, -12.0, 3.0, 2.5, -1.2, 0.7, 0.3];
        let wrench = estimate_wrench(&robot, &kinematics, robot.body_count() - 1, &torque, &[0.1; 7]);
        let point = Vector3::new(0.2, -0.1, 0.4);
        let [far, near] = wrench.principal_displacements(&point);
        let root = wrench.displacement_root(&point);
        let covariance = root * root.transpose();
        for axis in [far, near] {
            let left = covariance * axis - axis * axis.norm_squared();
            assert!(left.norm() < 1e-9 * covariance.norm() * axis.norm(), "{left}");
            assert!(axis.dot(&wrench.force).abs() < 1e-9 * axis.norm() * wrench.force.norm());
        }
        assert!(far.norm() >= near.norm() && near.norm() > 0.0);
    }
}
