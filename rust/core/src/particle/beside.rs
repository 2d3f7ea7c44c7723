//! What other contacts may do to the torques beside the one that is looked for (algorithm C1).
//!
//! Their places are held to be known, but for a spread; their forces are not. The torques that they may cause are Gaussian, so that
//! integrating them out takes a few directions out of the normal equations: with torques `A x` of unknowns `x` of unit variance, the
//! noise of the measurement has the covariance `I + A A^T`, whose inverse is `I - U U^T` with `U = A L^-T` and `L L^T = I + A^T A`.

use nalgebra::{Cholesky, Const, SMatrix, SVector, Vector6};

use super::instant::Instant;
use super::known::{Known, Unknown, FORCES, PLACES};
use super::options::MOST_CONTACTS;
use super::response::ResponseModel;
use crate::spatial::vector::split;
use crate::torque::NormalEquations;

const UNKNOWNS: usize = (FORCES + PLACES) * (MOST_CONTACTS - 1);
const _: () = assert!(FORCES * MOST_CONTACTS <= UNKNOWNS, "the forces of all contacts are fitted together");
type Unknowns = SVector<f64, UNKNOWNS>;

/// Torques of unknowns, each row over its noise, by row and unknown; and the measured torques.
#[derive(Debug, Clone)]
pub(super) struct Beside {
    rows: Vec<Unknowns>,
    torque: Vec<f64>,
}

impl Beside {
    /// For so many torques.
    pub fn new(torques: usize) -> Self {
        Beside { rows: vec![Unknowns::zeros(); torques], torque: vec![0.0; torques] }
    }

    /// Takes what other contacts may do out of the normal equations of an instant, and out of its torque what they do in all
    /// likelihood beside a contact of its own.
    pub fn take_out(
        &mut self,
        instant: &mut Instant,
        others: &[Known],
        own: Option<&Known>,
        model: &ResponseModel,
    ) {
        if !others.is_empty() {
            self.integrate_out(instant, others, model);
            self.subtract(instant, others, own, model);
        }
    }

    /// Takes on the torques of an instant, and no unknown.
    fn begin(&mut self, instant: &Instant) {
        self.rows.fill(Unknowns::zeros());
        for ((torque, measured), deviation) in
            self.torque.iter_mut().zip(&instant.measured).zip(&instant.deviation)
        {
            *torque = measured / deviation;
        }
    }

    /// Sets the torques of an unknown.
    fn set(&mut self, instant: &Instant, column: usize, link: usize, unknown: &Unknown) {
        let frame = &instant.frames.links[link];
        for (axis, &row) in frame.rows().iter().enumerate() {
            self.rows[row][column] = frame.column(axis).dot(&unknown.wrench);
        }
    }

    /// `I + A^T A`, factored. None where numbers are not finite.
    fn factor(&self) -> Option<Cholesky<f64, Const<UNKNOWNS>>> {
        let gram: SMatrix<f64, UNKNOWNS, UNKNOWNS> = self.rows.iter().map(|row| row * row.transpose()).sum();
        (gram + SMatrix::identity()).cholesky()
    }

    fn integrate_out(&mut self, instant: &mut Instant, others: &[Known], model: &ResponseModel) {
        self.begin(instant);
        let mut mean = Unknowns::zeros();
        let mut column = 0;
        for other in others.iter().take(MOST_CONTACTS - 1) {
            for unknown in other.forces(model).iter().chain(&other.places(model)) {
                self.set(instant, column, other.link, unknown);
                mean[column] = unknown.mean;
                column += 1;
            }
        }
        let Some(factor) = self.factor() else { return };
        // The torques less the mean of what the others do; the rows become those of U.
        let (mut along, mut squared) = (Unknowns::zeros(), 0.0);
        for (row, torque) in self.rows.iter_mut().zip(&mut self.torque) {
            *torque -= row.dot(&mean);
            factor.l_dirty().solve_lower_triangular_mut(row);
            along += *row * *torque;
            squared += *torque * *torque;
        }
        instant.squared = (squared - along.norm_squared()).max(0.0);
        for &link in &instant.frames.wanted {
            let frame = &instant.frames.links[link];
            let (mut shared, mut product) = (SMatrix::<f64, 6, UNKNOWNS>::zeros(), Vector6::zeros());
            for (axis, &row) in frame.rows().iter().enumerate() {
                let felt = frame.column(axis);
                shared += felt * self.rows[row].transpose();
                product += felt * self.torque[row];
            }
            instant.equations[link] = NormalEquations {
                gram: frame.gram() - shared * shared.transpose(),
                product: product - shared * along,
            };
        }
    }

    /// The forces of all contacts are fitted together, and those of the others are subtracted.
    fn subtract(
        &mut self,
        instant: &mut Instant,
        others: &[Known],
        own: Option<&Known>,
        model: &ResponseModel,
    ) {
        self.begin(instant);
        let mut product = Unknowns::zeros();
        for (contact, known) in others.iter().chain(own).take(MOST_CONTACTS).enumerate() {
            for (a, unknown) in known.forces(model).iter().enumerate() {
                let column = FORCES * contact + a;
                self.set(instant, column, known.link, unknown);
                product[column] = unknown.mean;
            }
        }
        let Some(factor) = self.factor() else { return };
        product += self.rows.iter().zip(&self.torque).map(|(row, torque)| row * *torque).sum::<Unknowns>();
        let found = factor.solve(&product);
        let Instant { frames, target, measured, torque, deviation, .. } = instant;
        torque.copy_from_slice(measured);
        for (contact, known) in others.iter().enumerate() {
            let share = |a: usize| found[FORCES * contact + a];
            if share(0) > 0.0 {
                let forces = known.forces(model);
                let force = (0..FORCES).map(|a| split(&forces[a].wrench).0 * share(a)).sum();
                frames.subtract(known.link, &known.point, &force, deviation, torque);
            }
        }
        target.set(frames, torque, deviation);
    }
}

#[cfg(test)]
mod tests;
