//! What noise of the velocities does to the external torque at a pose: `M S_v M`, worked out a column a tick.

use crate::robot::{Kinematics, MassMatrixPass, Robot};

/// The product of the mass matrix, the variances of the velocities and the mass matrix, of a pose a few ticks ago.
#[derive(Debug, Clone)]
pub(crate) struct VelocityCovariance {
    mass: MassMatrixPass,
    /// Of the velocities (rad^2/s^2).
    variances: Vec<f64>,
    column: Vec<f64>,
    /// Rows of a symmetric matrix of which the lower half is used: complete, and in the making.
    complete: Vec<f64>,
    growing: Vec<f64>,
    next: usize,
    started: bool,
}

impl VelocityCovariance {
    /// For standard deviations of the velocities `(nv,)`.
    pub fn new(robot: &Robot, velocity: &[f64]) -> Self {
        let nv = robot.nv();
        VelocityCovariance {
            mass: MassMatrixPass::new(robot),
            variances: velocity.iter().map(|deviation| deviation * deviation).collect(),
            column: vec![0.0; nv],
            complete: vec![0.0; nv * nv],
            growing: vec![0.0; nv * nv],
            next: 0,
            started: false,
        }
    }

    /// A column's work; the first time, all of it.
    #[inline]
    pub fn advance(&mut self, robot: &Robot, kinematics: &Kinematics) {
        let nv = self.column.len();
        let columns = if self.started { 1 } else { nv };
        for _ in 0..columns {
            if self.next == 0 {
                self.mass.begin(robot, kinematics);
                self.growing.fill(0.0);
            }
            self.add_column(robot);
            self.next += 1;
            if self.next == nv {
                std::mem::swap(&mut self.complete, &mut self.growing);
                self.next = 0;
            }
        }
        self.started = true;
    }

    fn add_column(&mut self, robot: &Robot) {
        self.mass.column(robot, self.next, &mut self.column);
        let (variance, nv) = (self.variances[self.next], self.column.len());
        for (i, row) in self.growing.chunks_exact_mut(nv).enumerate() {
            let factor = variance * self.column[i];
            row[..=i].iter_mut().zip(&self.column).for_each(|(value, other)| *value += factor * other);
        }
    }

    /// Row `i` up to its diagonal.
    #[inline]
    pub fn row(&self, i: usize) -> &[f64] {
        let nv = self.column.len();
        &self.complete[i * nv..=i * nv + i]
    }

    /// Starts anew with the next pose.
    pub fn reset(&mut self) {
        (self.next, self.started) = (0, false);
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;

    #[test]
    fn it_is_the_product_of_matrices() {
        let robot = Robot::example_arm();
        let velocity = [0.01, 0.02, 0.03, 0.01, 0.05, 0.02, 0.04];
        let mut covariance = VelocityCovariance::new(&robot, &velocity);
        for seed in 0..3 {
            let q = robot.random_configuration(seed);
            let mut kinematics = Kinematics::new(&robot);
            kinematics.set_configuration(&robot, &q);
            // A pose that was begun before is finished first.
            (0..14).for_each(|_| covariance.advance(&robot, &kinematics));
            let mass = robot.mass_matrix(&q).expect("a configuration");
            let squares = DVector::from_iterator(7, velocity.iter().map(|v| v * v));
            let product = &mass * DMatrix::from_diagonal(&squares) * &mass;
            for i in 0..7 {
                for (j, value) in covariance.row(i).iter().enumerate() {
                    assert!((value - product[(i, j)]).abs() < 1e-12);
                }
            }
        }
    }
}
