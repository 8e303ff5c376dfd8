//! How much of some work is done, for whoever shows it.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Counts what is done on any thread, and tells it, with how much there is.
pub struct Counter<W> {
    done: AtomicUsize,
    of: usize,
    watch: W,
}

impl<W: Fn(usize, usize)> Counter<W> {
    /// Nothing is done yet, of so much.
    pub fn new(of: usize, watch: W) -> Self {
        Counter { done: AtomicUsize::new(0), of, watch }
    }

    /// One more is done.
    pub fn one_more(&self) {
        (self.watch)(self.done.fetch_add(1, Ordering::Relaxed) + 1, self.of);
    }
}
