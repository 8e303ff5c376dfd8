//! Workers of a command: the threads of this process, with the feature `mpi` the ranks of a cluster, and [programs](program)
//! that the user names.
//!
//! [`Workers`] is the [`Executor`] of the command. It takes results in the order of their indices, so they do not depend on who did
//! the work, and can keep them in a [`checkpoint`], from which an interrupted run resumes.

pub mod checkpoint;
mod distribute;
#[cfg(not(feature = "mpi"))]
mod no_ranks;
pub mod program;
#[cfg(feature = "mpi")]
mod ranks;
pub mod task;

use std::env;
use std::ffi::OsString;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::available_parallelism;

use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::{Batch, Executor};
use rayon::prelude::*;
use serde_bytes::ByteBuf;

use checkpoint::{Checkpoint, CreateFile};
use distribute::hand_out;
#[cfg(not(feature = "mpi"))]
use no_ranks as ranks;
use ranks::Ranks;
use task::Task;

/// Pieces per worker that are begun before the first of them is taken, so that one slow piece leaves nobody idle.
const AHEAD: usize = 4;
/// Prefixes of the variables by which a process knows that it is a rank.
const RANK_VARIABLES: [&str; 3] = ["OMPI_", "PMIX_", "PMI_"];

/// Threads, ranks and a checkpoint. The default has threads only.
#[derive(Default)]
pub struct Workers {
    ranks: Option<Ranks>,
    checkpoint: Mutex<Option<Checkpoint>>,
    /// Number of batches started, by which ranks and the checkpoint know them.
    parts: AtomicU32,
    /// Whether only the first rank has work left.
    is_released: AtomicBool,
}

impl Workers {
    /// Joins the ranks with which `mpirun` started this process, if it did.
    ///
    /// # Errors
    /// When MPI cannot be started.
    pub fn join() -> Result<Self> {
        Ok(Workers { ranks: Ranks::join()?, ..Workers::default() })
    }

    /// Returns the number of threads for each of several ranks: those on one machine share its processors.
    pub fn threads(&self) -> Option<usize> {
        let processors = available_parallelism().map_or(1, usize::from);
        let ranks = self.ranks.as_ref().map(Ranks::on_this_machine)?;
        Some((processors / ranks).max(1))
    }

    /// Leaves the work to the first rank alone.
    pub fn leave_ranks(&mut self) {
        self.ranks = None;
    }

    /// CreateFiles a task, resuming from its checkpoint if there is one; returns the number of results in it. `warn` receives a
    /// line when the end of the checkpoint is lost.
    ///
    /// # Errors
    /// When other ranks or the checkpoint have another task, or the checkpoint cannot be read or written.
    pub fn begin(
        &mut self,
        task: Task,
        checkpoint: Option<(&Path, CreateFile)>,
        warn: impl FnMut(String),
    ) -> Result<usize> {
        if let Some(ranks) = &self.ranks {
            ranks.agree(&task)?;
        }
        let checkpoint = checkpoint.filter(|_| self.is_first());
        let checkpoint = checkpoint.map(|(path, begin)| Checkpoint::open(path, &task, begin, warn)).transpose()?;
        let count = checkpoint.as_ref().map_or(0, Checkpoint::count);
        *self.checkpoint() = checkpoint;
        Ok(count)
    }

    /// Ends the task and removes its checkpoint; calls `complain` if it failed, and returns whether it succeeded.
    pub fn end(self, done: Result<()>, complain: impl FnOnce(&Error)) -> bool {
        let checkpoint = self.checkpoint().take();
        let done = done.and_then(|()| checkpoint.map_or(Ok(()), Checkpoint::remove));
        match (done, self.ranks) {
            (Ok(()), _) => true,
            (Err(_), Some(_)) if self.is_released.into_inner() => true,
            (Err(error), Some(ranks)) => ranks.fail(|| complain(&error)),
            (Err(error), None) => {
                complain(&error);
                false
            }
        }
    }

    /// The checkpoint; a thread that panicked while it held it has not left it half-changed.
    fn checkpoint(&self) -> MutexGuard<'_, Option<Checkpoint>> {
        self.checkpoint.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Executor for Workers {
    fn execute(&self, batch: Batch<'_>) -> Result<()> {
        let is_last = batch.is_last;
        if is_nested() {
            return in_pool(batch);
        }
        hand_out(self, batch)?;
        if !is_last || self.is_first() {
            return Ok(());
        }
        self.is_released.store(true, Ordering::Relaxed);
        Err(Error::new("the rest is for the first rank"))
    }

    fn once(&self, work: &mut dyn FnMut() -> Result<Vec<u8>>) -> Result<Vec<u8>> {
        match self.ranks.as_ref().filter(|_| !is_nested()) {
            None => work(),
            Some(ranks) => {
                let value = if ranks.is_first() { Some(ByteBuf::from(work()?)) } else { None };
                ranks.broadcast(value).map(ByteBuf::into_vec)
            }
        }
    }

    fn is_first(&self) -> bool {
        is_nested() || self.ranks.as_ref().is_none_or(Ranks::is_first)
    }
}

/// Keeps another program that is called from taking itself for one of the ranks.
pub fn remove_rank_variables(program: &mut Command) {
    let of_ranks = |name: &OsString| RANK_VARIABLES.iter().any(|prefix| name.to_string_lossy().starts_with(prefix));
    for name in env::vars_os().map(|(name, _)| name).filter(of_ranks) {
        program.env_remove(name);
    }
}

/// Whether this thread executes a piece of a batch. It must not wait for others, nor speak for its rank.
fn is_nested() -> bool {
    rayon::current_thread_index().is_some()
}

/// Executes a batch within a piece of another one.
fn in_pool(batch: Batch<'_>) -> Result<()> {
    let at_once = if batch.is_bounded { AHEAD * rayon::current_num_threads() } else { batch.count.max(1) };
    for first in (0..batch.count).step_by(at_once) {
        let piece = |index: usize| (batch.work)(index, &(batch.input)(index)?);
        let indices = first..batch.count.min(first + at_once);
        let results = indices.into_par_iter().map(piece).collect::<Result<Vec<Vec<u8>>>>()?;
        (first..).zip(results).try_for_each(|(index, result)| (batch.take)(index, result))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::thread;
    use std::time::Duration;

    use mindgap_foundations::executor::{in_order, map, map_watched};

    use super::*;

    #[test]
    fn results_come_in_order_whichever_finishes_first() {
        let slow_first = |index: usize| {
            thread::sleep(Duration::from_millis((50 - index as u64) / 10));
            Ok(index * index)
        };
        assert_eq!(map(&Workers::default(), 50, slow_first).unwrap(), (0..50).map(|i| i * i).collect::<Vec<usize>>());
        assert_eq!(map(&Workers::default(), 0, slow_first).unwrap(), Vec::<usize>::new());
    }

    #[test]
    fn items_may_distribute_work_themselves() {
        let sums = map(&Workers::default(), 40, |outer| {
            Ok(map(&Workers::default(), 40, |inner| Ok(outer * inner))?.iter().sum::<usize>())
        })
        .unwrap();
        assert_eq!(sums, (0..40).map(|outer| outer * 780).collect::<Vec<usize>>());
    }

    #[test]
    fn number_of_items_in_progress_is_bounded() {
        let begun = AtomicUsize::new(0);
        let work = |index: usize| {
            begun.fetch_add(1, Ordering::SeqCst);
            Ok(index)
        };
        let most = AHEAD * rayon::current_num_threads();
        in_order(&Workers::default(), 10_000, work, |index, _| {
            assert!(begun.load(Ordering::SeqCst) <= index + most);
            Ok(())
        })
        .unwrap();
    }

    #[test]
    fn failure_skips_the_remaining_items() {
        let begun = AtomicUsize::new(0);
        let work = |index: usize| {
            begun.fetch_add(1, Ordering::SeqCst);
            if index == 3 { Err(Error::new("the third")) } else { Ok(index) }
        };
        assert_eq!(map(&Workers::default(), 100_000, work).unwrap_err().to_string(), "the third");
        assert!(begun.load(Ordering::SeqCst) < 1000);
        let refused = in_order(&Workers::default(), 100_000, Ok::<usize, Error>, |_, _| Err(Error::new("full")));
        assert_eq!(refused.unwrap_err().to_string(), "full");
    }

    /// As when Ctrl-C is pressed.
    #[test]
    fn panic_of_the_watcher_skips_items_not_yet_started() {
        let begun = AtomicUsize::new(0);
        let work = |index: usize| {
            begun.fetch_add(1, Ordering::SeqCst);
            thread::sleep(Duration::from_millis(20));
            Ok(index)
        };
        let panics = || map_watched(&Workers::default(), 100, work, |_, _| panic!("enough"));
        assert!(catch_unwind(AssertUnwindSafe(panics)).is_err());
        let begun = begun.load(Ordering::SeqCst);
        assert!(begun <= 3 * rayon::current_num_threads(), "{begun}");
    }

    #[test]
    #[should_panic(expected = "a mistake")]
    fn panic_in_an_item_propagates() {
        let _ = map(&Workers::default(), 10, |index| if index == 5 { panic!("a mistake") } else { Ok(index) });
    }
}
