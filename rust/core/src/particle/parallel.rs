//! A step on several threads.

use std::sync::mpsc::{sync_channel, Receiver, SyncSender};
use std::sync::Mutex;

use super::columns::Slice;
use super::swarm::Swarm;
use crate::error::{Error, Result};

/// Fewer particles are not worth sharing.
const GRAIN: usize = 512;

/// Calls `work` on pieces of the particles with the number of their first one, on the threads of the pool that this is
/// called from, or at once on all.
pub(super) fn for_each(
    particles: Slice<'_>,
    start: usize,
    threads: usize,
    work: &(impl Fn(usize, Slice<'_>) + Sync),
) {
    let count = particles.len();
    if threads < 2 || count <= GRAIN {
        return work(start, particles);
    }
    let middle = count / 2;
    let (left, right) = particles.split_at(middle);
    rayon::join(|| for_each(left, start, threads, work), || for_each(right, start + middle, threads, work));
}

/// A pool of threads of which one waits for steps to do.
///
/// Handing a step to a pool from outside allocates now and then. So one of its threads takes steps from a channel, and
/// shares them with the others from within.
#[derive(Debug)]
pub(super) struct Crew {
    to: SyncSender<Box<Swarm>>,
    // For `Sync` only: never contended.
    from: Mutex<Receiver<Box<Swarm>>>,
    /// Ends the threads when it is dropped, after `to`.
    _pool: rayon::ThreadPool,
}

impl Crew {
    pub fn new(threads: usize) -> Result<Self> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|index| format!("contactsense-{index}"))
            .build()
            .map_err(|error| Error::input("threads", format!("{threads} cannot be started ({error})")))?;
        let (to, steps) = sync_channel::<Box<Swarm>>(1);
        let (done, from) = sync_channel(1);
        pool.spawn(move || {
            while let Ok(mut swarm) = steps.recv() {
                swarm.step();
                if done.send(swarm).is_err() {
                    break;
                }
            }
        });
        Ok(Crew { to, from: Mutex::new(from), _pool: pool })
    }

    /// Does one step.
    pub fn step(&self, swarm: Box<Swarm>) -> Box<Swarm> {
        let from = self.from.lock().expect(ALIVE);
        self.to.send(swarm).expect(ALIVE);
        from.recv().expect(ALIVE)
    }
}

/// A step does not panic, so the thread that takes them lives as long as the crew.
const ALIVE: &str = "the thread of the filter is alive";
