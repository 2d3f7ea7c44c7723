//! Torques without gravity's, and gravity in another direction.

use nalgebra::Vector3;

use super::fit::fit;
use super::hypothesis::{Explained, Fault, Trial, PER_NUMBER};
use super::target::Target;

impl Trial<'_> {
    /// Gravity absent from the torques, or in another direction than in the model.
    pub(super) fn gravity(&self) -> Vec<Explained> {
        /// Of the earth (m/s^2), for models that have none.
        const EARTH: f64 = 9.81;
        /// At rest, gravity upside down and the opposite sign look alike, and the sign is the likelier mistake (nats).
        const AT_REST: f64 = 15.0;
        let evidence = self.evidence;
        let cost = 2.0 * PER_NUMBER + if evidence.moving { 0.0 } else { AT_REST };
        let known = self.robot.gravity;
        let plain = Target::plain(evidence.parts);
        let mut found = vec![];
        if known.norm() > 1.0 {
            let none = plain.clone().with_gravity_change(evidence.parts, &[-known.x, -known.y, -known.z]);
            found.extend(self.explained(Fault::GravityFree, none, self.prior, 0.0));
        }
        let size = if known.norm() > 1.0 { known.norm() } else { EARTH };
        let free = self.prior.clone().any_gravity();
        let Some(mut loose) = fit(evidence, &plain, &free) else { return found };
        // The direction alone is free; along it the rest is found anew.
        let at = evidence.unknowns() - 3;
        for _ in 0..4 {
            let wanted = Vector3::from_fn(|k, _| known[k] + loose.x[at + k]);
            if wanted.norm() < 0.2 * size {
                return found;
            }
            let turned = wanted * (size / wanted.norm());
            let change = [turned.x - known.x, turned.y - known.y, turned.z - known.z];
            let target = plain.clone().with_gravity_change(evidence.parts, &change);
            let fault = Fault::Gravity([turned.x, turned.y, turned.z]);
            let Some(explained) = self.explained(fault, target.clone(), self.prior, cost) else {
                break;
            };
            // A small turn from here.
            let mut near = self.prior.clone();
            near.gravity = Some(0.3 * size);
            found.push(explained);
            let Some(next) = fit(evidence, &target, &near) else { break };
            loose = next;
            change.iter().enumerate().for_each(|(k, change)| loose.x[at + k] += change);
        }
        found
    }
}
