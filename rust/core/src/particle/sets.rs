//! One set of particles for each contact: a set is added while the torques ask for it, and dropped when it explains nothing
//! (algorithm C1; Manuelli and Tedrake 2016).

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;

use super::adaptation::news;
use super::cloud::Cloud;
use super::estimate::Event;
use super::known::Known;
use super::options::{FilterOptions, MOST_CONTACTS};
use super::state::FilterState;
use crate::error::Result;
use crate::robot::Robot;

/// A set is added so many new poses after the last one, where all together do not explain the torques.
const SETTLED: f64 = 2.0;
/// A set is dropped when the others explain the torques without it, and the best of its particles makes these no more than so many times
/// as likely, for so many new poses: twice the logarithm of a likelihood ratio of a million.
const LEAST_EXPLAINED: f64 = 27.6;
const IDLE: f64 = 3.0;
/// A contact that was sure is held to be where it is for so many new poses, whatever is not explained: another contact is likelier.
const LOYAL: f64 = 8.0;
/// Seeds of sets are apart by this.
const SEED: u64 = 0x9e37_79b9_7f4a_7c15;

/// Particles of one contact.
#[derive(Debug, Clone)]
struct Set {
    /// Of the sets of a filter, from zero.
    number: usize,
    state: FilterState,
    /// New poses for which it has explained nothing, and since it was sure.
    idle: f64,
    since_sure: f64,
}

impl Set {
    /// At the start.
    fn reset(&mut self) {
        self.state.reset();
        self.forget();
    }

    /// Forgets what it has explained, and whether it was sure.
    fn forget(&mut self) {
        (self.idle, self.since_sure) = (0.0, f64::INFINITY);
    }

    fn is_sure(&self) -> bool {
        let estimate = &self.state.found.estimate;
        estimate.contact.is_some() && !estimate.ambiguous
    }
}

/// Particles of all contacts, those of the first contact first.
#[derive(Debug, Clone)]
pub(super) struct Sets {
    sets: Vec<Set>,
    /// How many contacts there are; one also where there is none.
    count: usize,
    /// New poses since that changed.
    settled: f64,
    /// Since the start or the last reset.
    updates: u64,
    stop: Arc<AtomicBool>,
}

impl Sets {
    pub fn new(robot: &Arc<Robot>, options: &FilterOptions) -> Result<Self> {
        options.check(robot)?;
        Cloud::check_memory(options.particles * options.max_contacts)?;
        let stop = Arc::new(AtomicBool::new(false));
        let set = |k: usize| {
            let seed = options.seed.wrapping_add((k as u64).wrapping_mul(SEED));
            let mut state = FilterState::new(robot.clone(), FilterOptions { seed, ..options.clone() })?;
            state.stop = stop.clone();
            Ok(Set { number: k, state, idle: 0.0, since_sure: f64::INFINITY })
        };
        let sets = (0..options.max_contacts).map(set).collect::<Result<_>>()?;
        Ok(Sets { sets, count: 1, settled: 0.0, updates: 0, stop })
    }

    /// A set for each contact; one where there is none.
    pub fn of_contacts(&self) -> impl ExactSizeIterator<Item = &FilterState> {
        self.sets[..self.count].iter().map(|set| &set.state)
    }

    /// That of the first contact.
    pub fn first(&self) -> &FilterState {
        &self.sets[0].state
    }

    pub fn stop(&self) -> &Arc<AtomicBool> {
        &self.stop
    }

    pub fn reset(&mut self) {
        self.sets.sort_unstable_by_key(|set| set.number);
        self.forget();
        self.sets[0].reset();
        self.updates = 0;
    }

    /// There is no contact. A set that is not in use is reset when it is added.
    fn forget(&mut self) {
        (self.count, self.settled) = (1, 0.0);
        self.sets[0].forget();
    }

    /// Takes in a measurement.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) names the argument; nothing is changed.
    pub fn read(&mut self, q: &[f64], tau_ext: &[f64]) -> Result<()> {
        // The first one finds what is wrong with the arguments.
        self.sets.iter_mut().try_for_each(|set| set.state.read(q, tau_ext))
    }

    /// Updates particles and estimates by the measurement that was read.
    pub fn step(&mut self) {
        let news = self.news();
        if self.count > 1 {
            self.sets[..self.count].iter_mut().for_each(|set| set.state.follow_known());
        }
        for k in 0..self.count {
            self.step_of(k, news);
        }
        if self.first().found.estimate.contact.is_none() {
            self.forget();
        } else if self.sets.len() > 1 && !self.stop.load(Ordering::Relaxed) {
            self.change_number(news);
        }
        self.updates += 1;
        self.tell();
    }

    /// Which share of the measurement that was read is new. A contact that is looked for anew forgets how the robot came to its pose, so
    /// this is asked before any of them takes a step.
    fn news(&self) -> f64 {
        news(if self.updates == 0 { 0.0 } else { self.first().instant.displacement() })
    }

    /// Contact k looks at what it has read beside what is known of the others; says whether there are any.
    fn look_beside(&mut self, k: usize) -> bool {
        let mut others = [Known::NOWHERE; MOST_CONTACTS];
        let mut count = 0;
        for (_, state) in self.of_contacts().enumerate().filter(|(j, _)| *j != k) {
            if let Some(known) = state.known {
                others[count] = known;
                count += 1;
            }
        }
        self.sets[k].state.look_beside(&others[..count]);
        count > 0
    }

    /// Contact k takes in what it has read, of which this share is new.
    fn step_of(&mut self, k: usize, news: f64) {
        let (several, many) = (self.look_beside(k), self.sets.len() > 1);
        let set = &mut self.sets[k];
        set.state.stays = many && set.since_sure < LOYAL;
        set.state.step();
        set.since_sure = if set.is_sure() { 0.0 } else { set.since_sure + news };
        if several && set.state.found.event == Event::Changed {
            // What the others were confirmed by was wrong.
            self.doubt();
        }
    }

    fn doubt(&mut self) {
        self.sets[..self.count].iter_mut().for_each(|set| set.state.doubt());
    }

    /// Drops a contact that explains nothing, or adds one where all together do not explain the torques.
    fn change_number(&mut self, news: f64) {
        self.settled += news;
        let explained = self.of_contacts().any(|state| state.found.explained);
        for set in &mut self.sets[..self.count] {
            set.idle = if set.state.is_idle(LEAST_EXPLAINED) { set.idle + news } else { 0.0 };
        }
        let explains = |k: usize| self.sets[k].state.explains;
        let idle = (0..self.count).filter(|&k| self.sets[k].idle >= IDLE);
        let least = idle.min_by(|&a, &b| explains(a).total_cmp(&explains(b)));
        if let (true, Some(k)) = (self.count > 1, least) {
            self.sets[k..self.count].rotate_left(1);
            self.count -= 1;
            self.changed();
        } else if self.count < self.sets.len() && !explained && self.settled >= SETTLED {
            self.add(news);
            self.changed();
        }
    }

    fn add(&mut self, news: f64) {
        let k = self.count;
        self.count += 1;
        self.sets[k].reset();
        self.step_of(k, news);
        for j in 0..k {
            // What was sure stays so. Otherwise it was found as if the new one were not there.
            if !self.sets[j].state.stays {
                self.look_beside(j);
                self.sets[j].state.look_again();
            }
        }
    }

    /// The number of contacts has changed.
    fn changed(&mut self) {
        self.settled = 0.0;
        self.sets[..self.count].iter_mut().for_each(|set| set.idle = 0.0);
        self.doubt();
        self.sets[0].state.found.event = Event::Changed;
    }

    /// Says of the others beside the first one.
    fn tell(&mut self) {
        let Some((first, others)) = self.sets[..self.count].split_first_mut() else { return };
        let found = &mut first.state.found;
        found.updates = self.updates;
        for (to, other) in found.others.iter_mut().zip(others) {
            to.copy(&other.state.found.estimate);
            found.explained &= other.state.found.explained;
        }
    }
}
