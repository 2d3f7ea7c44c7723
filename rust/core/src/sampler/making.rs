//! Hypotheses of all measurements: made of their claims, or of what was known before the newest one.

use super::friction::NormalForces;
use super::hypothesis::{put, Claim, Contact, Hypothesis, Touch};
use super::path::{logs, ContactPath};
use super::sums::Sums;
use crate::posterior::tempering::Wanted;

impl<const N: usize> ContactPath<'_, N> {
    /// A hypothesis of all measurements; none where it is surely not wanted.
    pub fn make(&self, claims: [Claim; N], wanted: Option<Wanted>) -> Option<Hypothesis<N>> {
        let contacts = claims.map(|claim| self.contact(claim));
        if self.sized_by_forces(&contacts) {
            return self.refine(contacts, &self.rough(contacts, None)?, wanted);
        }
        let takes = |sums: &[Sums<N>; 2]| wanted.is_none_or(|wanted| wanted.takes(self.most(sums)));
        let (contacts, [before, now]) =
            self.add_up(contacts, &[NormalForces::greatest(&self.prior); 2], takes)?;
        let marginal = self.prior.integrate(&now);
        let logs = logs(self.prior.integrate(&before).log, marginal.log);
        Some(Hypothesis { contacts, now, logs, rough: None, marginal })
    }

    /// Takes the newest measurement into a hypothesis that knows those before it.
    pub fn follow(&self, hypothesis: &mut Hypothesis<N>) {
        let before = hypothesis.marginal.log;
        if self.sized_by_forces(&hypothesis.contacts) {
            if let Some(made) = self.make(hypothesis.contacts.map(|contact| contact.claim), None) {
                *hypothesis = made;
            }
        } else {
            self.add_newest(hypothesis);
            hypothesis.marginal = self.prior.integrate(&hypothesis.now);
        }
        hypothesis.logs = logs(before, hypothesis.marginal.log);
    }

    fn add_newest(&self, hypothesis: &mut Hypothesis<N>) {
        let forces = NormalForces::greatest(&self.prior);
        if let Some(dropped) = self.measurements.dropped() {
            let first =
                hypothesis.contacts.map(|contact| Contact { touch: Touch::of(&contact.claim), ..contact });
            let (_, felt) = self.touch(&first, dropped);
            hypothesis.now.add(-dropped.before, &felt.sums(self.force_model, &forces, dropped.rows));
        }
        let newest = self.measurements.newest();
        let (touches, felt) = self.touch(&hypothesis.contacts, newest);
        put(&mut hypothesis.contacts, touches);
        hypothesis.now.scale(self.measurements.kept);
        hypothesis.now.add(1.0, &felt.sums(self.force_model, &forces, newest.rows));
    }
}
