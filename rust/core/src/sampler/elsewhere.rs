//! Moves of one of several contacts to anywhere on the robot, led by the torques at one pose.
//!
//! Of some places drawn from the whole surface, one is chosen by how well it would explain the torques of a pose beside the other
//! contacts (multiple-try Metropolis with independent tries; Martino 2018): which of the links are touched is found together, and a
//! single place drawn by chance hardly ever fits.

use super::hypothesis::{Claim, Hypothesis, Touch};
use super::measurements::Measurement;
use super::path::ContactPath;
use crate::math::random::Stream;
use crate::spatial::vector::stack;
use crate::torque::SeveralPushes;

/// Places that are tried.
const TRIES: usize = 16;
/// Torques are explained well enough to lead to a place where so much of them is left over.
const TOLERANCE: f64 = 0.1;

impl<const N: usize> ContactPath<'_, N> {
    /// Another claim for a contact, and the logarithm of how many times as likely the way back is proposed.
    pub(super) fn elsewhere(
        &self,
        sample: &Hypothesis<N>,
        contact: usize,
        share: f64,
        random: Stream,
    ) -> Option<(Claim, f64)> {
        let count = self.measurements.all().count();
        let pose = (random.uniform(0) * count as f64) as usize;
        let measurement = self.measurements.all().nth(pose)?;
        let [before, now] = self.counts(measurement);
        let counts = before + share * (now - before);
        // Friction is not looked at: it may be left over.
        let friction = self.force_model.deviation_of_sliding(1.0).unwrap_or(0.0);
        let tolerance = TOLERANCE.hypot(friction);
        let scale = 1.0 + tolerance * tolerance * measurement.target.squared / measurement.rows.max(1.0);
        let touches = sample.contacts.map(|contact| self.place(&contact, measurement).0);
        let links = sample.contacts.map(|contact| contact.claim.link);
        let bare = self.forces_in::<1>(&links, measurement, &touches).bare();
        let claimed = sample.contacts[contact].claim;
        let fits = |claim: &Claim| {
            let (touch, _) = self.place(&self.contact(*claim), measurement);
            let pushes = self.with(&bare, &links, &touches, contact, (claim.link, &touch), measurement);
            let misfit = pushes.misfit(&pushes.forces(self.prior.force));
            -0.5 * counts * misfit / scale
        };
        let mut tried = [(claimed, f64::NEG_INFINITY); TRIES];
        for (number, (claim, fit)) in tried.iter_mut().enumerate() {
            let first = 1 + 3 * number as u64;
            let place = (random.uniform(first) * self.places.len() as f64) as usize;
            *claim = self.claim(claimed.model, place, random.uniform(first + 1));
            *fit = fits(claim);
        }
        let own = fits(&claimed);
        let greatest = tried.iter().map(|(_, fit)| *fit).fold(own, f64::max);
        let weight = |fit: f64| (fit - greatest).exp();
        let sum: f64 = tried.iter().map(|(_, fit)| weight(*fit)).sum();
        let mut left = random.uniform(1 + 3 * TRIES as u64) * sum;
        let chosen = tried.iter().find(|(_, fit)| {
            left -= weight(*fit);
            left <= 0.0
        });
        let (claim, fit) = chosen.copied().filter(|_| sum > 0.0)?;
        // Tried from there: the others, and the present one.
        let back = sum - weight(fit) + weight(own);
        Some((claim, own - fit + (sum / back).ln()))
    }

    /// Pushes along the normals with one of the contacts elsewhere.
    fn with(
        &self,
        pushes: &SeveralPushes<N>,
        links: &[u32; N],
        touches: &[Touch; N],
        contact: usize,
        (link, touch): (u32, &Touch),
        measurement: &Measurement,
    ) -> SeveralPushes<N> {
        let mut pushes = *pushes;
        let wrench = |touch: &Touch| stack(&-touch.normal, &-touch.point.cross(&touch.normal));
        let own = wrench(touch);
        pushes.product[contact] = own.dot(&measurement.target.on(link as usize).product);
        for other in 0..N {
            let (link_of, wrench_of) =
                if other == contact { (link, own) } else { (links[other], wrench(&touches[other])) };
            let inner = own.dot(&(measurement.gram_of(link as usize, link_of as usize) * wrench_of));
            pushes.gain[contact][other] = inner;
            pushes.gain[other][contact] = inner;
        }
        pushes
    }
}
