//! How large friction can be at each pose: in proportion to normal forces that all measurements tell together.
//!
//! One measurement alone hardly tells the forces of several contacts that turn the same joints, and friction misleads it: sized by
//! such forces, friction is too small where it matters, and one more contact takes its place.

use nalgebra::Vector2;

use super::hypothesis::Contact;
use super::measurements::Measurement;
use super::path::ContactPath;
use super::sums::Sums;
use crate::torque::{AllDirections, ForceModel};

/// Normal forces of the contacts with obstacles at any pose.
#[derive(Debug, Clone, Copy)]
pub(super) struct NormalForces<const N: usize> {
    /// At the first touch (N), and the stiffness (N/m), of each.
    numbers: [Vector2<f64>; N],
    /// At most (N).
    greatest: f64,
}

impl<const N: usize> NormalForces<N> {
    /// Where the contacts are so much `deeper` than at the first touch (m).
    fn at(&self, deeper: &[f64; N]) -> [f64; N] {
        std::array::from_fn(|i| {
            let [force, stiffness] = self.numbers[i].into();
            (force + stiffness * deeper[i]).clamp(0.0, self.greatest)
        })
    }
}

/// What one measurement says of the contacts.
#[derive(Debug, Clone, Copy)]
pub(super) enum Felt<const N: usize> {
    /// Whatever the forces are elsewhere.
    Known(Sums<N>),
    /// Of forces in all directions, of contacts that are so much deeper than at the first touch (m).
    WithFriction(AllDirections<N>, [f64; N]),
}

impl<const N: usize> ContactPath<'_, N> {
    /// What a measurement says where friction is as large as `forces` allow.
    pub(super) fn sums(
        &self,
        felt: &Felt<N>,
        measurement: &Measurement,
        forces: &NormalForces<N>,
    ) -> Sums<N> {
        let mut sums = match felt {
            Felt::Known(sums) => *sums,
            Felt::WithFriction(all, deeper) => {
                let deviation = forces.at(deeper).map(|force| self.force_model.deviation_of_sliding(force));
                Sums::along(&all.without_friction(deviation), deeper)
            }
        };
        sums.rows = measurement.rows;
        sums
    }

    /// Whether what a measurement says depends on the others.
    pub(super) fn sized_by_all(&self, contacts: &[Contact; N]) -> bool {
        self.force_model != ForceModel::Normal && contacts[0].claim.model.stays()
    }

    /// The normal forces that explain best what was measured before the newest measurement came, and what is measured now, beside
    /// friction of the greatest forces: it can hide no force that is there.
    pub(super) fn normal_forces(&self, contacts: &[Contact; N]) -> [NormalForces<N>; 2] {
        let greatest = self.prior.force[1];
        let any = NormalForces { numbers: [Vector2::new(greatest, 0.0); N], greatest };
        if !self.sized_by_all(contacts) {
            return [any; 2];
        }
        let mut contacts = *contacts;
        let (mut before, mut now) = (Sums::NONE, Sums::NONE);
        for measurement in self.measurements.scattered() {
            let (touches, felt) = self.touch(&contacts, measurement);
            contacts.iter_mut().zip(touches).for_each(|(contact, touch)| contact.touch = touch);
            let sums = self.sums(&felt, measurement, &any);
            before.add(measurement.before, &sums);
            now.add(measurement.now, &sums);
        }
        [before, now].map(|sums| NormalForces { numbers: self.prior.best(&sums), greatest })
    }
}
