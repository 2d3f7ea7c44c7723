//! A step on several threads.

use super::columns::Slice;
#[cfg(feature = "parallel")]
use crate::error::Error;
use crate::error::Result;

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
    join(|| for_each(left, start, threads, work), || for_each(right, start + middle, threads, work));
}

#[cfg(feature = "parallel")]
fn join(left: impl FnOnce() + Send, right: impl FnOnce() + Send) {
    rayon::join(left, right);
}

#[cfg(not(feature = "parallel"))]
fn join(left: impl FnOnce(), right: impl FnOnce()) {
    left();
    right();
}

/// The threads of a filter; none where it has one, or without the feature `parallel`: the answers are the same.
#[derive(Debug)]
pub(super) struct Pool {
    #[cfg(feature = "parallel")]
    pool: Option<rayon::ThreadPool>,
}

#[cfg(feature = "parallel")]
impl Pool {
    pub fn new(threads: usize) -> Result<Self> {
        let start = || {
            rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .thread_name(|index| format!("contactsense-{index}"))
                .build()
                .map_err(|error| Error::input("threads", format!("{threads} cannot be started ({error})")))
        };
        Ok(Pool { pool: (threads > 1).then(start).transpose()? })
    }

    /// Does the work on one of the threads, so that it may share parts of it with the others. Now and then rayon takes
    /// memory for its queue.
    pub fn install(&self, work: impl FnOnce() + Send) {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}

#[cfg(not(feature = "parallel"))]
impl Pool {
    pub fn new(_threads: usize) -> Result<Self> {
        Ok(Pool {})
    }

    pub fn install(&self, work: impl FnOnce()) {
        work();
    }
}
