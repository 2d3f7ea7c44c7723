//! Torques in another order than the joints.

use nalgebra::DMatrix;

use super::assignment::assign;
use super::hypothesis::{Explained, Fault, Trial, PER_CHOICE};
use super::target::Target;
use super::terms::OWN;

impl Trial<'_> {
    /// Torques in another order: the assignment under which each fits its joint best.
    pub(super) fn permuted(&self) -> Option<Explained> {
        /// Error of a model relative to its torque that does not speak against an order.
        const ERROR: f64 = 0.05;
        /// A joint keeps its own torque where another fits no better than by so much (nats).
        const STAY: f64 = 3.0;
        let evidence = self.evidence;
        let nv = evidence.nv;
        let own = evidence.inertial..evidence.inertial + OWN.len();
        let weight = evidence.effective / evidence.rows;
        let mut cost = DMatrix::zeros(nv, nv);
        for k in 0..nv {
            let sums = &evidence.sums[k];
            let model = evidence.parts.model();
            let floor = (ERROR * ERROR * sums.parts[(model, model)] / evidence.rows).sqrt();
            for other in 0..nv {
                let torque = evidence.parts.torque(other);
                let floor = floor.hypot(evidence.floor[other]);
                let mut matrix = sums.unknowns.view((own.start, own.start), (own.len(), own.len())) * weight
                    / (floor * floor);
                for (term, sd) in self.prior.own[k].iter().enumerate() {
                    matrix[(term, term)] += 1.0 / (sd * sd);
                }
                let right = (sums.cross.view((own.start, torque), (own.len(), 1))
                    - sums.cross.view((own.start, model), (own.len(), 1)))
                    * weight
                    / (floor * floor);
                let square = sums.parts[(torque, torque)] - 2.0 * sums.parts[(torque, model)]
                    + sums.parts[(model, model)];
                let explained =
                    nalgebra::Cholesky::new(matrix).map_or(0.0, |factor| factor.solve(&right).dot(&right));
                let misfit = (weight * square / (floor * floor) - explained).max(0.0) / evidence.effective;
                cost[(k, other)] = 0.5 * evidence.effective * (misfit + 1.0).ln()
                    + evidence.effective * floor.ln()
                    - if k == other { STAY } else { 0.0 };
            }
        }
        let order = assign(&cost);
        let moved = order.iter().enumerate().filter(|(k, column)| k != *column).count();
        let choices: f64 = (0..moved).map(|k| ((nv - k) as f64).ln()).sum();
        let target = Target::reordered(evidence.parts, &order);
        (moved > 0)
            .then(|| self.explained(Fault::Permuted(order), target, self.prior, PER_CHOICE * choices))?
    }
}
