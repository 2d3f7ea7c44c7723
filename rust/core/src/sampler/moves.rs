//! Moves of hypotheses: the model that the kernel is given.

use nalgebra::Vector3;

use super::hypothesis::{Claim, Hypothesis};
use super::path::ContactPath;
use crate::math::random::Stream;
use crate::particle::tangent;
use crate::posterior::tempering::{Logs, Path, Proposal, Wanted};

/// Share of moves by a difference of two other hypotheses on the link, which has the scale and the direction of what is not known yet
/// (differential evolution; ter Braak 2006); and of those the share that take the whole of it, the others take a part.
const LIKE_OTHERS: f64 = 0.7;
const WHOLE_DIFFERENCES: f64 = 0.2;
/// So many others are looked at for two on the link.
const PAIR_DRAWS: u64 = 16;
/// Standard deviation of other moves along the surface: its logarithm is uniform between those of these (m).
const STEPS: [f64; 2] = [2e-4, 5e-2];
/// Of a move of the logarithm of the radius.
const RADIUS_STEP: f64 = 0.6;
/// Shares of those along the surface alone and of the radius alone, added up; the rest are both.
const ALONE: [f64; 2] = [0.4, 0.6];
/// Share of moves that take another model.
const MODEL_MOVES: f64 = 0.2;
/// Share of moves to a link beside.
const BESIDE: f64 = 0.1;
/// Share of moves that place a contact anywhere, of two contacts or more: which links are touched is not known from one of them.
const ANYWHERE: f64 = 0.3;

/// The number of a move's forked stream that decides the first of two stages.
const DECISION: u64 = 1 << 20;
impl<const N: usize> Path for ContactPath<'_, N> {
    type Sample = Hypothesis<N>;

    fn logs(&self, sample: &Hypothesis<N>) -> Logs {
        sample.logs
    }

    fn propose(
        &self,
        sample: &Hypothesis<N>,
        others: &[Hypothesis<N>],
        wanted: Wanted,
        random: &Stream,
        first: u64,
    ) -> Option<Proposal<Hypothesis<N>>> {
        let draw = |k: u64| random.uniform(first + k);
        let mut claims = sample.contacts.map(|contact| contact.claim);
        let contact = (draw(30) * N as f64) as usize;
        let claim = claims[contact];
        let anywhere = if N > 1 { ANYWHERE } else { 0.0 };
        let log_back;
        (claims[contact], log_back) = match draw(31) {
            x if x < anywhere => self.elsewhere(sample, contact, wanted.share, random.fork(first))?,
            x if x < anywhere + BESIDE => self.neighbours.claim_beside(
                claim,
                self.robot,
                &self.measurements.first,
                random.fork(first),
            )?,
            _ => (self.near(claim, others, random, first)?, 0.0),
        };
        let wanted = wanted.with_back(log_back);
        let contacts = claims.map(|claim| self.contact(claim));
        match &sample.rough {
            Some(rough) if self.sized_by_forces(&contacts) => {
                self.in_two_stages(rough, contacts, wanted, log_back, random.fork(first).uniform(DECISION))
            }
            _ => Some(Proposal { sample: self.make(claims, Some(wanted))?, log_back }),
        }
    }
}

impl<const N: usize> ContactPath<'_, N> {
    /// Another claim near one, as likely to be proposed from there as the other way round.
    fn near(&self, mut claim: Claim, others: &[Hypothesis<N>], random: &Stream, first: u64) -> Option<Claim> {
        let draw = |k: u64| random.uniform(first + k);
        if self.models.len() > 1 && draw(0) < MODEL_MOVES {
            claim.model = self.models[(draw(1) * self.models.len() as f64) as usize];
        }
        let (aside, of_radius) = if draw(2) < LIKE_OTHERS {
            let (one, other) = pair(others, claim.link, |k| draw(8 + k))?;
            let share = if draw(3) < WHOLE_DIFFERENCES { 1.0 } else { draw(4) };
            ((one.place.point - other.place.point) * share, (one.log_radius - other.log_radius) * share)
        } else {
            let scale = STEPS[0] * (STEPS[1] / STEPS[0]).powf(draw(3));
            let [along, beside] = random.normals(first + 4);
            let aside = tangent(&claim.place.normal, along * scale, beside * scale);
            let of_radius = RADIUS_STEP * random.normals(first + 6)[0];
            match draw(8) {
                x if x < ALONE[0] => (aside, 0.0),
                x if x < ALONE[1] => (Vector3::zeros(), of_radius),
                _ => (aside, of_radius),
            }
        };
        claim.log_radius += of_radius;
        let [least, greatest] = self.log_radius;
        if !(least..=greatest).contains(&claim.log_radius) {
            return None;
        }
        if aside != Vector3::zeros() {
            let surface = self.surface(claim.link)?;
            let near = surface.closest_point_near(&(claim.place.point + aside), claim.place.triangle);
            if surface.hides(&near.point, near.triangle) {
                return None;
            }
            claim.place = near.into();
        }
        Some(claim)
    }
}

/// Two contacts of others on a link, by chance.
fn pair<const N: usize>(
    others: &[Hypothesis<N>],
    link: u32,
    draw: impl Fn(u64) -> f64,
) -> Option<(&Claim, &Claim)> {
    let mut found = (0..PAIR_DRAWS)
        .map(|k| (draw(k) * (others.len() * N) as f64) as usize)
        .map(|k| &others[k / N].contacts[k % N].claim)
        .filter(|claim| claim.link == link);
    Some((found.next()?, found.next()?))
}
