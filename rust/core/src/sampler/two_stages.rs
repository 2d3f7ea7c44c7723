//! Contacts with friction: first of the greatest forces, then of those that explain the torques best.

use super::friction::NormalForces;
use super::hypothesis::{Contact, Hypothesis};
use super::path::{logs, ContactPath};
use super::sums::Sums;
use crate::posterior::tempering::{Logs, Proposal, Wanted};

/// What is known of contacts with friction of the greatest forces: as they counted before the newest measurement came, and now.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rough<const N: usize> {
    pub logs: Logs,
    sums: [Sums<N>; 2],
}

impl<const N: usize> ContactPath<'_, N> {
    /// Contacts with friction of the greatest forces; none where they are surely not wanted.
    pub fn rough(&self, contacts: [Contact; N], wanted: Option<Wanted>) -> Option<Rough<N>> {
        let takes = |sums: &[Sums<N>; 2]| wanted.is_none_or(|wanted| wanted.takes(self.most(sums)));
        let (_, sums) = self.add_up(contacts, &[NormalForces::greatest(&self.prior); 2], takes)?;
        let [before, now] = [&sums[0], &sums[1]].map(|sums| self.prior.integrate(sums).log);
        Some(Rough { logs: logs(before, now), sums })
    }

    /// A hypothesis of contacts with friction of the forces that explain the torques best; none where it is surely not wanted.
    ///
    /// The forces beside friction of the greatest ones are good enough for the size of friction; with this they are found once more.
    /// The torques are then weighed with just these forces: to fit others would reward contacts whose friction is too small for them.
    pub fn refine(
        &self,
        contacts: [Contact; N],
        rough: &Rough<N>,
        wanted: Option<Wanted>,
    ) -> Option<Hypothesis<N>> {
        let forces = [&rough.sums[0], &rough.sums[1]].map(|sums| NormalForces::best(&self.prior, sums));
        let (_, sums) = self.add_up(contacts, &forces, |_| true)?;
        let forces = [&sums[0], &sums[1]].map(|sums| NormalForces::best(&self.prior, sums));
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
    pub fn in_two_stages(
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
