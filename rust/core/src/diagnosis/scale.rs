//! The torque of one joint or of all times a factor.

use nalgebra::DVector;

use super::hypothesis::{Explained, Fault, Trial};
use super::target::Target;

impl Trial<'_> {
    /// A factor of torques by turns with what else explains them.
    pub(super) fn scale(&self, joint: Option<usize>, cost: f64) -> Option<Explained> {
        const ROUNDS: usize = 3;
        /// First and last step of the search for the factor, relative.
        const SEARCH: f64 = 0.3;
        const FINEST: f64 = 0.01;
        let evidence = self.evidence;
        let joints: Vec<usize> = joint.map_or_else(|| (0..evidence.nv).collect(), |joint| vec![joint]);
        let mut factor = 0.0;
        let mut x = DVector::zeros(evidence.unknowns());
        // All joints count alike at first: the noise of a fit with the wrong factor says little.
        let mut sigma: Vec<f64> = (0..evidence.nv)
            .map(|k| evidence.square(k, evidence.parts.torque(k)).sqrt().max(evidence.floor[k]))
            .collect();
        let mut best: Option<Explained> = None;
        for _ in 0..ROUNDS {
            let (mut along, mut square) = (0.0, 0.0);
            for &k in &joints {
                let sums = &evidence.sums[k];
                let (torque, model) = (evidence.parts.torque(k), evidence.parts.model());
                let own = DVector::from_iterator(
                    sums.unknowns.nrows(),
                    (0..sums.unknowns.nrows()).map(|column| x[evidence.global(k, column)]),
                );
                let explained = &sums.unknowns * &own;
                let weight = 1.0 / (sigma[k] * sigma[k]);
                along += weight * (sums.parts[(torque, model)] + own.dot(&sums.cross.column(torque)));
                square += weight
                    * (sums.parts[(model, model)]
                        + 2.0 * own.dot(&sums.cross.column(model))
                        + own.dot(&explained));
            }
            let next = along / square.max(1e-12);
            if next.abs() < 1e-4 || !next.is_finite() {
                return best;
            }
            let settled = (next - factor).abs() < 1e-3 * next.abs();
            factor = next;
            let target = joints
                .iter()
                .fold(Target::plain(evidence.parts), |target, k| target.scaled(evidence.parts, *k, factor));
            let explained = self.explained(Fault::Scale(joint, factor), target, self.prior, cost)?;
            x = explained.fit.x.clone();
            sigma = explained.fit.sigma.iter().zip(&explained.target.factor).map(|(s, f)| s / f).collect();
            if best.as_ref().is_none_or(|best| explained.score > best.score) {
                best = Some(explained);
            }
            if settled {
                break;
            }
        }
        // Masses and factor make up for each other, so that taking turns converges slowly.
        let mut step = SEARCH;
        while step > FINEST {
            let Fault::Scale(_, middle) = best.as_ref()?.fault else { break };
            for factor in [middle * (1.0 + step), middle / (1.0 + step)] {
                let target = joints.iter().fold(Target::plain(evidence.parts), |target, k| {
                    target.scaled(evidence.parts, *k, factor)
                });
                let explained = self.explained(Fault::Scale(joint, factor), target, self.prior, cost)?;
                if best.as_ref().is_none_or(|best| explained.score > best.score) {
                    best = Some(explained);
                }
            }
            step *= 0.5;
        }
        best
    }
}
