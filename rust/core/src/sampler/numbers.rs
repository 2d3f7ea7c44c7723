//! How many contacts there are: hypotheses of one, of two and so on, side by side.

use std::sync::atomic::Ordering;

use nalgebra::Vector3;

use super::measurements::Measurement;
use super::population::{Population, Scene};
use crate::math::chi_square::upper_limit;
use crate::math::random::Stream;
use crate::particle::MOST_CONTACTS;
use crate::posterior::parallel::Course;
use crate::posterior::tempering::Tempering;

/// Share of hypotheses that stay effective from step to step.
const EFFECTIVE: f64 = 0.5;
/// Moves of a particle of one contact, and of several, each time particles are drawn anew, where there are few poses, at most; and how
/// often that is done at least.
const MOST_MOVES: [usize; 2] = [3, 6];
const LEAST_STEPS: usize = 4;
/// Hypotheses of several contacts that leave over so many times the variance of noise, at 99 %, have missed where these are: they are
/// spread anew with all poses. That is done at so many poses for the first time, and again when there are half as many more; with so
/// many moves of a particle at most.
const MISSED: f64 = 2.0;
const FIRST_SEARCH: usize = 4;
const SEARCH_MOVES: usize = 100;
/// How probable one more contact is beforehand, as a share. A contact that is there soon shows by hundreds of nats; what friction and
/// curvature do beside the model can feign some.
const ONE_MORE: f64 = 1e-6;
/// A number of contacts that is less probable is followed no longer.
const DROPPED: f64 = 1e-12;
/// Poses that tell an obstacle that stays from what is none, and rule out a number of contacts.
pub(super) const LEAST_POSES: usize = 4;

/// Hypotheses of each number of contacts, and how probable each number is.
#[derive(Debug)]
pub(super) struct Numbers {
    /// Of one contact, two and so on, and which of these are followed.
    populations: Vec<Box<dyn Population>>,
    followed: Vec<bool>,
    /// How many poses there were when each was last spread.
    searched: Vec<usize>,
    /// Of each, and the most probable.
    probabilities: Vec<f64>,
    likely: usize,
}

impl Numbers {
    /// Of one contact, two and so on.
    pub fn new(populations: Vec<Box<dyn Population>>) -> Self {
        let most = populations.len();
        Numbers {
            populations,
            followed: vec![true; most],
            searched: vec![0; most],
            probabilities: vec![0.0; most],
            likely: 0,
        }
    }

    /// Whether there may be more contacts than one.
    pub fn several(&self) -> bool {
        self.populations.len() > 1
    }

    /// All zero without a contact.
    pub fn probabilities(&self) -> &[f64] {
        &self.probabilities
    }

    /// Of the most probable number.
    pub fn greatest(&self) -> f64 {
        self.probabilities[self.likely]
    }

    /// The most probable number of contacts.
    pub fn likely(&self) -> &dyn Population {
        self.populations[self.likely].as_ref()
    }

    /// There is no contact; the number that was most probable stays that of the particles.
    pub fn clear(&mut self) {
        self.probabilities.fill(0.0);
    }

    /// There never was a contact.
    pub fn reset(&mut self) {
        self.clear();
        self.likely = 0;
    }

    /// Contacts begin beside those that were at these points before, or in their place.
    pub fn begin(&mut self, before: &[Vector3<f64>]) {
        self.populations.iter_mut().for_each(|population| population.begin(before));
    }

    /// What the best hypothesis of any number leaves over.
    pub fn least_misfit(&self) -> f64 {
        let followed = self.populations.iter().zip(&self.followed).filter(|(_, followed)| **followed);
        followed.map(|(population, _)| population.misfit()).fold(f64::INFINITY, f64::min)
    }

    /// Takes the newest measurement in, `anew` without those before, with so many moves of a particle at most; each has so many
    /// torques. Returns effective samples and log-evidence of the most probable number.
    pub fn update(
        &mut self,
        scene: Scene<'_>,
        anew: bool,
        most_moves: usize,
        torques: usize,
        random: Stream,
        course: Course<'_>,
    ) -> (f64, f64) {
        if anew {
            self.followed.fill(true);
            self.searched.fill(0);
        }
        // A place among many is harder to come by than one.
        let [alone, beside_others] =
            [(most_moves, MOST_MOVES[0]), (2 * most_moves, MOST_MOVES[1])].map(|(most_moves, at_once)| {
                Tempering {
                    effective_share: EFFECTIVE,
                    moves: (most_moves / LEAST_STEPS).clamp(1, at_once),
                    most_moves,
                }
            });
        let thorough = Tempering { moves: MOST_MOVES[1], most_moves: SEARCH_MOVES, ..beside_others };
        let without = |before: f64| -> f64 {
            let of = |measurement: &Measurement| {
                0.5 * (measurement.now - before * measurement.before) * measurement.target.squared
            };
            scene.measurements.scattered().map(of).sum()
        };
        let poses = scene.measurements.len();
        let mut weighed = [(0.0, 0.0); MOST_CONTACTS];
        let Self { populations, followed, searched, .. } = self;
        for (k, population) in populations.iter_mut().enumerate().filter(|(k, _)| followed[*k]) {
            let tempering = if k > 0 { beside_others } else { alone };
            let known = population.log_evidence();
            let mut travelled = population.update(scene, anew, tempering, random.fork(k as u64), course);
            let mut log_evidence = known + travelled.log_evidence + without(1.0);
            // A single contact was looked for on the whole surface.
            let due = k > 0 && poses >= FIRST_SEARCH && 2 * poses >= 3 * searched[k];
            let stopped = || course.stop.load(Ordering::Relaxed);
            if due && !stopped() && population.misfit() > MISSED * upper_limit(poses * torques) {
                let random = random.fork((MOST_CONTACTS + k) as u64);
                travelled = population.update(scene, true, thorough, random, course);
                log_evidence = travelled.log_evidence + without(0.0);
                // What was broken off is due again.
                searched[k] = if stopped() { 0 } else { poses };
            }
            weighed[k] = (travelled.effective, log_evidence - known);
            population.add_log_evidence(weighed[k].1);
        }
        self.choose(poses);
        weighed[self.likely]
    }

    /// How probable each number of contacts is.
    fn choose(&mut self, poses: usize) {
        let Self { populations, followed, probabilities, .. } = self;
        let mut logs = [f64::NEG_INFINITY; MOST_CONTACTS];
        let mut fewer: Option<(f64, f64)> = None;
        for (k, population) in populations.iter().enumerate().filter(|(k, _)| followed[*k]) {
            let greatest = population.greatest_log();
            // One more contact cannot be more probable than its best hypothesis is likelier than the best without it. Particles that
            // were led astray take the evidence of few contacts to be less than it is.
            let most = fewer.map_or(f64::INFINITY, |(log, without)| log + greatest - without);
            let log = population.log_evidence().min(most);
            fewer = Some((log, greatest));
            logs[k] = log + k as f64 * ONE_MORE.ln();
        }
        let greatest = logs.into_iter().fold(f64::NEG_INFINITY, f64::max);
        for (number, log) in probabilities.iter_mut().zip(logs) {
            *number = if greatest > f64::NEG_INFINITY { (log - greatest).exp() } else { 1.0 };
        }
        let sum: f64 = probabilities.iter().sum();
        probabilities.iter_mut().for_each(|number| *number /= sum);
        if poses >= LEAST_POSES {
            followed.iter_mut().zip(&*probabilities).for_each(|(held, number)| *held &= *number >= DROPPED);
        }
        // The least number of those that are as probable.
        self.likely = (0..probabilities.len())
            .rev()
            .max_by(|a, b| probabilities[*a].total_cmp(&probabilities[*b]))
            .unwrap_or(0);
    }
}
