//! How large friction can be at each pose: in proportion to normal forces that all measurements tell together.
//!
//! One measurement alone hardly tells the forces of several contacts that turn the same joints, and friction misleads it: sized by
//! such forces, friction is too small where it matters, and one more contact takes its place.

use nalgebra::Vector2;

use super::hypothesis::{Contact, ContactModel, Hypothesis};
use super::measurements::Measurement;
use super::path::{logs, ContactPath};
use super::sums::Sums;
use crate::posterior::tempering::{Logs, Proposal, Wanted};
use crate::torque::AllDirections;

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

/// What is known of contacts with friction of the greatest forces: as they counted before the newest measurement came, and now.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rough<const N: usize> {
    pub logs: Logs,
    sums: [Sums<N>; 2],
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

    /// Whether friction is in proportion to forces that all measurements tell.
    pub(super) fn sized_by_forces(&self, contacts: &[Contact; N]) -> bool {
        let friction = self.force_model.deviation_of_sliding(1.0).is_some();
        friction && contacts[0].claim.model == ContactModel::Obstacle
    }

    /// As large as can be, whatever was measured.
    pub(super) fn greatest_forces(&self) -> NormalForces<N> {
        let greatest = self.prior.force[1];
        NormalForces { numbers: [Vector2::new(greatest, 0.0); N], greatest }
    }

    fn best_forces(&self, sums: &Sums<N>) -> NormalForces<N> {
        NormalForces { numbers: self.prior.best(sums), greatest: self.prior.force[1] }
    }

    /// Contacts with friction of the greatest forces; none where they are surely not wanted.
    pub(super) fn rough(&self, contacts: [Contact; N], wanted: Option<Wanted>) -> Option<Rough<N>> {
        let takes = |sums: &[Sums<N>; 2]| wanted.is_none_or(|wanted| wanted.takes(self.most(sums)));
        let (_, sums) = self.add_up(contacts, &[self.greatest_forces(); 2], takes)?;
        let [before, now] = [&sums[0], &sums[1]].map(|sums| self.prior.integrate(sums).log);
        Some(Rough { logs: logs(before, now), sums })
    }

    /// A hypothesis of contacts with friction of the forces that explain the torques best; none where it is surely not wanted.
    ///
    /// The forces beside friction of the greatest ones are good enough for the size of friction; with this they are found once more.
    /// The torques are then weighed with just these forces: to fit others would reward contacts whose friction is too small for them.
    pub(super) fn refine(
        &self,
        contacts: [Contact; N],
        rough: &Rough<N>,
        wanted: Option<Wanted>,
    ) -> Option<Hypothesis<N>> {
        let forces = [&rough.sums[0], &rough.sums[1]].map(|sums| self.best_forces(sums));
        let (_, sums) = self.add_up(contacts, &forces, |_| true)?;
        let forces = [&sums[0], &sums[1]].map(|sums| self.best_forces(sums));
        let rows = self.rows();
        let most = |sums: &[Sums<N>; 2]| {
            let [start, end] = [0, 1].map(|k| self.prior.most_at(&sums[k], &forces[k].numbers, rows[k]));
            Logs { start, added: end - start }
        };
        let takes = |sums: &[Sums<N>; 2]| wanted.is_none_or(|wanted| wanted.takes(most(sums)));
        let (contacts, [before, now]) = self.add_up(contacts, &forces, takes)?;
        let marginal = self.prior.integrate_at(&now, forces[1].numbers);
        let logs = logs(self.prior.integrate_at(&before, forces[0].numbers).log, marginal.log);
        Some(Hypothesis { contacts, now, logs, rough: Some(rough.logs), marginal })
    }

    /// Proposes contacts that pass a first decision by what is roughly known of them, which costs a third of the work and mostly
    /// ends it; the second one is by how much more is known (delayed acceptance; Christen and Fox 2005).
    pub(super) fn in_two_stages(
        &self,
        own: &Logs,
        contacts: [Contact; N],
        wanted: Wanted,
        log_back: f64,
        draw: f64,
    ) -> Option<Proposal<Hypothesis<N>>> {
        let own = own.at(wanted.share);
        let first = Wanted { least: own + draw.ln() - log_back, ..wanted };
        let rough = self.rough(contacts, Some(first)).filter(|rough| first.takes(rough.logs))?;
        let taken_back = own - rough.logs.at(wanted.share);
        // What was decided is decided: its share of the ratio is taken back.
        let second = Wanted { least: wanted.least + log_back - taken_back, ..wanted };
        Some(Proposal { sample: self.refine(contacts, &rough, Some(second))?, log_back: taken_back })
    }
}
