//! How far a filter has come, and random numbers of its own for every step.

use crate::math::random::Stream;

/// Updates so far.
#[derive(Debug, Clone)]
pub(super) struct Clock {
    /// Since the start or the last reset.
    pub step: u64,
    /// Since the particles were last spread.
    pub age: u64,
    /// Age from which the particles may be weighed a second time within an update.
    pub next_reinitialisation: u64,
    random: Stream,
    /// Streams of random numbers that were used up.
    streams: u64,
}

impl Clock {
    pub fn new(seed: u64) -> Self {
        Clock { step: 0, age: 0, next_reinitialisation: 1, random: Stream::new(seed), streams: 0 }
    }

    /// At the start.
    pub fn reset(&mut self) {
        (self.step, self.streams) = (0, 0);
    }

    /// The search begins anew.
    pub fn spread(&mut self) {
        (self.age, self.next_reinitialisation) = (0, 1);
    }

    /// An update is done.
    pub fn tick(&mut self) {
        self.step += 1;
        self.age += 1;
    }

    /// Random numbers that nothing else uses.
    pub fn stream(&mut self) -> Stream {
        self.streams += 1;
        self.random.fork(self.streams)
    }
}
