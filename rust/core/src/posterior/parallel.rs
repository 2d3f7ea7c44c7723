//! A step on several threads.

use std::sync::atomic::{AtomicBool, Ordering};

#[cfg(feature = "parallel")]
use crate::error::Error;
use crate::error::Result;

/// Fewer particles are not worth sharing.
const GRAIN: usize = 512;
/// As many take some 10 ms: after so many it is seen whether to stop.
const MOST_AT_ONCE: usize = 65_536;

/// What can be shared between threads.
pub(crate) trait Pieces: Sized + Send {
    /// How many there are.
    fn count(&self) -> usize;

    /// The first ones, and the others.
    fn split(self, middle: usize) -> (Self, Self);
}

impl<T: Send> Pieces for &mut [T] {
    fn count(&self) -> usize {
        self.len()
    }

    fn split(self, middle: usize) -> (Self, Self) {
        self.split_at_mut(middle)
    }
}

/// As many of each, the same ones together.
impl<A: Pieces, B: Pieces> Pieces for (A, B) {
    fn count(&self) -> usize {
        self.0.count()
    }

    fn split(self, middle: usize) -> (Self, Self) {
        let (first, second) = (self.0.split(middle), self.1.split(middle));
        ((first.0, second.0), (first.1, second.1))
    }
}

/// How samples are worked on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Course<'a> {
    /// One, or as many as the pool has that this is called from.
    pub threads: usize,
    /// Nothing more is done once it is set.
    pub stop: &'a AtomicBool,
}

/// Is never set.
static NEVER: AtomicBool = AtomicBool::new(false);

impl Course<'_> {
    /// One thread, which is not stopped.
    pub fn alone() -> Course<'static> {
        Course { threads: 1, stop: &NEVER }
    }

    /// The same, but not to be stopped.
    pub fn to_the_end(self) -> Course<'static> {
        Course { stop: &NEVER, ..self }
    }

    /// Calls `work` on pieces of the samples with the number of their first one.
    pub fn for_each<P: Pieces>(self, samples: P, start: usize, work: &(impl Fn(usize, P) + Sync)) {
        let count = samples.count();
        let most = if self.threads < 2 { MOST_AT_ONCE } else { GRAIN };
        if self.stop.load(Ordering::Relaxed) {
            return;
        }
        if count <= most {
            return work(start, samples);
        }
        let middle = count / 2;
        let (left, right) = samples.split(middle);
        self.both(|| self.for_each(left, start, work), || self.for_each(right, start + middle, work));
    }

    /// Does both, at once if there are several threads.
    pub fn both(self, first: impl FnOnce() + Send, second: impl FnOnce() + Send) {
        if self.threads < 2 {
            first();
            second();
        } else {
            join(first, second);
        }
    }
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
pub(crate) struct Pool {
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
            Some(pool) => pool.install(|| {
                let awake = Awake { done: &AtomicBool::new(false), starter: rayon::current_thread_index() };
                awake.keep(pool.current_num_threads() - 1, work);
            }),
            None => work(),
        }
    }
}

/// Keeps the other threads awake while there is work of which they may get parts: one that sleeps takes about as long to wake as a part
/// takes.
#[cfg(feature = "parallel")]
#[derive(Clone, Copy)]
struct Awake<'a> {
    done: &'a AtomicBool,
    starter: Option<usize>,
}

#[cfg(feature = "parallel")]
impl Awake<'_> {
    /// Does the work while so many other threads look for parts of it.
    fn keep(self, others: usize, work: impl FnOnce() + Send) {
        if others == 0 {
            // Set also where the work panics.
            let _set = Done(self.done);
            return work();
        }
        rayon::join(|| self.keep(others - 1, work), || self.look_for_parts());
    }

    fn look_for_parts(self) {
        // The thread that does the work must not wait for its end.
        while rayon::current_thread_index() != self.starter && !self.done.load(Ordering::Acquire) {
            if rayon::yield_now() != Some(rayon::Yield::Executed) {
                std::thread::yield_now();
            }
        }
    }
}

#[cfg(feature = "parallel")]
struct Done<'a>(&'a AtomicBool);

#[cfg(feature = "parallel")]
impl Drop for Done<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
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
