//! From what the measurements before the newest one say to what they say with it: the model that the kernel is given.

use nalgebra::Vector3;

use super::friction::NormalForces;
use super::hypothesis::{Claim, Contact, ContactModel, Hypothesis, Touch};
use super::measurements::{Measurement, Measurements};
use super::neighbours::Neighbours;
use super::sums::{Prior, Sums};
use crate::math::random::Stream;
use crate::particle::tangent;
use crate::posterior::tempering::{Logs, Path, Proposal, Wanted};
use crate::robot::Robot;
use crate::surface::{Surface, SurfacePoint};
use crate::torque::ForceModel;

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

/// The number of a move's forked stream that decides the first of two stages.
const DECISION: u64 = 1 << 20;
/// Share of moves to a link beside.
const BESIDE: f64 = 0.1;
/// Share of moves that place a contact anywhere, of two contacts or more: which links are touched is not known from one of them.
const ANYWHERE: f64 = 0.3;

/// The model of so many contacts.
pub(super) struct ContactPath<'a, const N: usize> {
    pub robot: &'a Robot,
    pub measurements: &'a Measurements,
    pub models: &'a [ContactModel],
    /// Places of the surface, by area.
    pub places: &'a [(u32, SurfacePoint)],
    pub neighbours: &'a Neighbours,
    pub prior: Prior,
    pub force_model: ForceModel,
    pub log_radius: [f64; 2],
    /// Whether the way begins without any measurement.
    pub nothing_before: bool,
}

impl<const N: usize> ContactPath<'_, N> {
    pub(super) fn surface(&self, link: u32) -> Option<&Surface> {
        self.robot.links()[link as usize].surface.as_deref()
    }

    /// A contact by a model at one of the places, with a radius at a share of its range.
    pub fn claim(&self, model: ContactModel, place: usize, of_radius: f64) -> Claim {
        let (link, place) = self.places[place.min(self.places.len() - 1)];
        let [least, greatest] = self.log_radius;
        Claim { model, link, place, log_radius: least + (greatest - least) * of_radius }
    }

    /// Where the claimed contact was first.
    pub(super) fn contact(&self, claim: Claim) -> Contact {
        let place = &claim.place;
        let away = match claim.model {
            ContactModel::Obstacle => place.normal * claim.log_radius.exp(),
            ContactModel::Person | ContactModel::Both => Vector3::zeros(),
        };
        let anchor = self.measurements.first[claim.link as usize].transform_point(&(place.point + away));
        Contact { claim, anchor, touch: Touch::of(&claim) }
    }

    /// A hypothesis of all measurements; none where it is surely not wanted.
    pub fn make(&self, claims: [Claim; N], wanted: Option<Wanted>) -> Option<Hypothesis<N>> {
        let contacts = claims.map(|claim| self.contact(claim));
        if self.sized_by_forces(&contacts) {
            return self.refine(contacts, &self.rough(contacts, None)?, wanted);
        }
        let takes = |sums: &[Sums<N>; 2]| wanted.is_none_or(|wanted| wanted.takes(self.most(sums)));
        let (contacts, [before, now]) = self.add_up(contacts, &[self.greatest_forces(); 2], takes)?;
        let marginal = self.prior.integrate(&now);
        let logs = logs(self.prior.integrate(&before).log, marginal.log);
        Some(Hypothesis { contacts, now, logs, rough: None, marginal })
    }

    /// The contacts at the newest pose, and the sums of all measurements as they counted before that came and as they count now, with
    /// friction as large as normal forces then and now allow; none where what was added up first shows that it is not taken.
    pub fn add_up(
        &self,
        mut contacts: [Contact; N],
        forces: &[NormalForces<N>; 2],
        takes: impl Fn(&[Sums<N>; 2]) -> bool,
    ) -> Option<([Contact; N], [Sums<N>; 2])> {
        let mut both = [Sums::NONE; 2];
        let mut newest = contacts.map(|contact| contact.touch);
        for (number, measurement) in self.measurements.scattered().enumerate() {
            let (touches, felt) = self.touch(&contacts, measurement);
            put(&mut contacts, touches);
            for ((sums, share), forces) in both.iter_mut().zip(self.counts(measurement)).zip(forces) {
                if share > 0.0 {
                    sums.add(share, &self.sums(&felt, measurement, forces));
                }
            }
            if number == 0 {
                newest = touches;
            }
            // Not each time: to look costs a part of what it saves.
            if (number + 1).is_power_of_two() && !takes(&both) {
                return None;
            }
        }
        put(&mut contacts, newest);
        Some((contacts, both))
    }

    /// How much a measurement counted before the newest one came, and counts now.
    pub fn counts(&self, measurement: &Measurement) -> [f64; 2] {
        [if self.nothing_before { 0.0 } else { measurement.before }, measurement.now]
    }

    /// Torques that tell of the noise, before the newest measurement came and now.
    pub fn rows(&self) -> [f64; 2] {
        let [before, now] = self.measurements.rows;
        [if self.nothing_before { 0.0 } else { before }, now]
    }

    /// What the densities can be at most, whatever other measurements say.
    pub fn most(&self, [before, now]: &[Sums<N>; 2]) -> Logs {
        let [rows_before, rows_now] = self.rows();
        let (start, end) = (self.prior.most(before, rows_before), self.prior.most(now, rows_now));
        Logs { start, added: end - start }
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
        let forces = self.greatest_forces();
        if let Some(dropped) = self.measurements.dropped() {
            let first =
                hypothesis.contacts.map(|contact| Contact { touch: Touch::of(&contact.claim), ..contact });
            let (_, felt) = self.touch(&first, dropped);
            hypothesis.now.add(-dropped.before, &self.sums(&felt, dropped, &forces));
        }
        let newest = self.measurements.newest();
        let (touches, felt) = self.touch(&hypothesis.contacts, newest);
        put(&mut hypothesis.contacts, touches);
        hypothesis.now.scale(self.measurements.kept);
        hypothesis.now.add(1.0, &self.sums(&felt, newest, &forces));
    }

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
            x if x < anywhere + BESIDE => self.beside(claim, random.fork(first))?,
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

/// Densities at the start and at the end of the way.
pub(super) fn logs(start: f64, end: f64) -> Logs {
    // From a density of zero no way leads back.
    Logs { start, added: if start == f64::NEG_INFINITY { 0.0 } else { end - start } }
}

/// Has contacts touch elsewhere.
fn put<const N: usize>(contacts: &mut [Contact; N], touches: [Touch; N]) {
    contacts.iter_mut().zip(touches).for_each(|(contact, touch)| contact.touch = touch);
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
