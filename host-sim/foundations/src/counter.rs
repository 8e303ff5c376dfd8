//! Progress of a known number of work items.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Counts finished items on any thread and reports `(done, total)` to `watch` after each.
pub struct Counter<W> {
    done: AtomicUsize,
    total: usize,
    watch: W,
}

impl<W: Fn(usize, usize)> Counter<W> {
    /// Returns a counter of `total` items, none of them done.
    pub fn new(total: usize, watch: W) -> Self {
        Counter { done: AtomicUsize::new(0), total, watch }
    }

    /// Counts one more finished item.
    pub fn increment(&self) {
        (self.watch)(self.done.fetch_add(1, Ordering::Relaxed) + 1, self.total);
    }
}
