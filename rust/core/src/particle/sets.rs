//! One set of particles for each contact: a set is added while the torques ask for it, and dropped when it explains nothing
//! (algorithm C1; Manuelli and Tedrake 2016).

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;

use super::beside::{Known, MOST_CONTACTS};
use super::estimate::{Event, FilterEstimate};
use super::options::FilterOptions;
use super::state::FilterState;
use crate::error::Result;
use crate::robot::Robot;

/// A set is added so many updates after the last one, where all together do not explain the torques.
const SETTLED: usize = 2;
/// A set is dropped when the others explain the torques without it, and the best of its particles makes these no more than so many times
/// as likely, for so many updates: twice the logarithm of a likelihood ratio of a million.
const LEAST_EXPLAINED: f64 = 27.6;
const IDLE: usize = 3;
/// Seeds of sets are apart by this.
const SEED: u64 = 0x9e37_79b9_7f4a_7c15;

/// Particles of all contacts, those of the first contact first.
#[derive(Debug, Clone)]
pub(super) struct Sets {
    sets: Vec<FilterState>,
    /// How many contacts there are; one also where there is none.
    count: usize,
    /// Updates for which each has explained nothing, and since the number of sets changed.
    idle: [usize; MOST_CONTACTS],
    settled: usize,
    /// Whether a contact was sure since the number changed.
    sure: bool,
    /// Since the start or the last reset.
    updates: u64,
    stop: Arc<AtomicBool>,
}

impl Sets {
    pub fn new(robot: &Arc<Robot>, options: &FilterOptions) -> Result<Self> {
        options.check(robot)?;
        let set = |k: usize| {
            let seed = options.seed.wrapping_add((k as u64).wrapping_mul(SEED));
            FilterState::new(robot.clone(), FilterOptions { seed, ..options.clone() })
        };
        let mut sets = (0..options.max_contacts).map(set).collect::<Result<Vec<_>>>()?;
        let stop = Arc::new(AtomicBool::new(false));
        sets.iter_mut().for_each(|set| set.stop = stop.clone());
        Ok(Sets { sets, count: 1, idle: [0; MOST_CONTACTS], settled: 0, sure: false, updates: 0, stop })
    }

    /// A set for each contact; one where there is none.
    pub fn of_contacts(&self) -> &[FilterState] {
        &self.sets[..self.count]
    }

    pub fn found(&self) -> &FilterEstimate {
        &self.sets[0].found
    }

    pub fn stop(&self) -> &Arc<AtomicBool> {
        &self.stop
    }

    pub fn reset(&mut self) {
        // A set that is not in use is reset when it is added.
        self.sets[..self.count].iter_mut().for_each(FilterState::reset);
        self.forget();
        self.updates = 0;
    }

    fn forget(&mut self) {
        (self.count, self.settled, self.sure) = (1, 0, false);
        self.idle.fill(0);
    }

    /// Takes in a measurement.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) names the argument; nothing is changed.
    pub fn read(&mut self, q: &[f64], tau_ext: &[f64]) -> Result<()> {
        // The first one finds what is wrong with the arguments.
        self.sets.iter_mut().try_for_each(|set| set.read(q, tau_ext))
    }

    /// Updates particles and estimates by the measurement that was read.
    pub fn step(&mut self) {
        if self.count > 1 {
            self.sets[..self.count].iter_mut().for_each(FilterState::follow_known);
        }
        for k in 0..self.count {
            self.step_of(k);
        }
        if self.found().estimate.contact.is_none() {
            self.forget();
        } else if self.sets.len() > 1 && !self.stop.load(Ordering::Relaxed) {
            self.change_number();
        }
        self.updates += 1;
        self.tell();
    }

    /// Contact k looks at what it has read beside what is known of the others; says whether there are any.
    fn look_beside(&mut self, k: usize) -> bool {
        let mut others = [Known::NOWHERE; MOST_CONTACTS];
        let all = self.of_contacts().iter().enumerate().filter(|(j, _)| *j != k);
        let count = others
            .iter_mut()
            .zip(all.filter_map(|(_, set)| set.known))
            .map(|(to, other)| *to = other)
            .count();
        self.sets[k].look_beside(&others[..count]);
        count > 0
    }

    /// Contact k takes in what it has read.
    fn step_of(&mut self, k: usize) {
        let several = self.look_beside(k);
        // Another contact is likelier than that one that was sure is elsewhere.
        self.sets[k].stays = self.sure && self.count < self.sets.len();
        self.sets[k].step();
        if several && self.sets[k].found.event == Event::Changed {
            // What the others were confirmed by was wrong.
            self.sets[..self.count].iter_mut().for_each(FilterState::doubt);
        }
    }

    /// Drops a contact that explains nothing, or adds one where all together do not explain the torques.
    fn change_number(&mut self) {
        self.settled += 1;
        let explained = self.of_contacts().iter().any(|set| set.found.explained);
        self.sure |= self.of_contacts().iter().any(|set| !set.found.estimate.ambiguous);
        for k in 0..self.count {
            let idle = self.sets[k].explains < LEAST_EXPLAINED && self.sets[k].is_spare();
            self.idle[k] = if idle { self.idle[k] + 1 } else { 0 };
        }
        let idle = (0..self.count).filter(|&k| self.idle[k] >= IDLE);
        let least = idle.min_by(|&a, &b| self.sets[a].explains.total_cmp(&self.sets[b].explains));
        if let (true, Some(k)) = (self.count > 1, least) {
            self.drop(k);
        } else if self.count < self.sets.len() && !explained && self.settled >= SETTLED {
            self.add();
        }
    }

    fn drop(&mut self, k: usize) {
        self.sets[k..self.count].rotate_left(1);
        self.idle[k..self.count].rotate_left(1);
        self.count -= 1;
        self.changed();
    }

    fn add(&mut self) {
        let k = self.count;
        self.count += 1;
        self.sets[k].reset();
        self.step_of(k);
        // What was sure stays so. Otherwise the others were found as if the new one were not there.
        let again = if self.sure { 0..0 } else { 0..k };
        for j in again {
            self.look_beside(j);
            self.sets[j].look_again();
        }
        self.changed();
    }

    fn changed(&mut self) {
        (self.settled, self.sure) = (0, false);
        self.idle.fill(0);
        self.sets[..self.count].iter_mut().for_each(FilterState::doubt);
        self.sets[0].found.event = Event::Changed;
    }

    /// Says of the others beside the first one.
    fn tell(&mut self) {
        let Some((first, others)) = self.sets[..self.count].split_first_mut() else { return };
        first.found.updates = self.updates;
        for (to, set) in first.found.others.iter_mut().zip(others) {
            to.copy(&set.found.estimate);
            first.found.explained &= set.found.explained;
        }
    }
}
