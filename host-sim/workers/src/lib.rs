//! Runs independent work items by index on threads and, with the feature `mpi`, on the ranks of a cluster. Results are taken in
//! index order, so that they do not depend on who computed them, and saved in a [`checkpoint`], from which an interrupted run
//! resumes.
//!
//! A command calls [`begin`] and [`end`]; without them work runs on threads only, without a checkpoint.

pub mod checkpoint;
mod distribute;
#[cfg(not(feature = "mpi"))]
mod no_ranks;
#[cfg(feature = "mpi")]
mod ranks;
pub mod task;

use std::cell::RefCell;
use std::env;
use std::ffi::OsString;
use std::path::Path;
use std::process::Command;
use std::thread::available_parallelism;

use rayon::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;

use checkpoint::{Checkpoint, CreateFile};
use distribute::hand_out;
use mindgap_foundations::error::{Error, Result};
#[cfg(not(feature = "mpi"))]
use no_ranks as ranks;
use ranks::Ranks;
use task::Task;

/// Items per thread that may be started ahead of the next one to be taken, so that no thread waits for a slow item.
const AHEAD: usize = 4;
/// Prefixes of the environment variables by which a process recognises that it is a rank.
const RANK_VARIABLES: [&str; 3] = ["OMPI_", "PMIX_", "PMI_"];

/// State of the current run. Only the main thread has one.
#[derive(Default)]
struct Run {
    ranks: Option<Ranks>,
    checkpoint: Option<Checkpoint>,
    /// Number of parts started; each distribution of work is one.
    parts: u32,
    /// Whether only the first rank has work left.
    is_released: bool,
}

thread_local! {
    static RUN: RefCell<Run> = RefCell::default();
}

/// Joins the other ranks if this process was started by `mpirun`.
///
/// # Errors
/// When MPI cannot be initialised.
pub fn join() -> Result<()> {
    let ranks = Ranks::join()?;
    RUN.with_borrow_mut(|run| run.ranks = ranks);
    Ok(())
}

/// Prevents a child process from joining the MPI job.
pub fn remove_rank_variables(program: &mut Command) {
    let is_rank_variable =
        |name: &OsString| RANK_VARIABLES.iter().any(|prefix| name.to_string_lossy().starts_with(prefix));
    for name in env::vars_os().map(|(name, _)| name).filter(is_rank_variable) {
        program.env_remove(name);
    }
}

/// Returns whether this process writes and prints: the first rank, or the only process.
pub fn is_first() -> bool {
    RUN.with_borrow(|run| run.ranks.as_ref().is_none_or(Ranks::is_first))
}

/// Returns the number of threads per rank, since the ranks on one machine share its processors; `None` without ranks.
pub fn threads() -> Option<usize> {
    let processors = available_parallelism().map_or(1, usize::from);
    let ranks = RUN.with_borrow(|run| run.ranks.as_ref().map(Ranks::on_this_machine))?;
    Some((processors / ranks).max(1))
}

/// Leaves the MPI job: the first rank works alone from here on.
pub fn leave_ranks() {
    RUN.with_borrow_mut(|run| run.ranks = None);
}

/// Begins a task, resuming from its checkpoint if there is one; returns the number of items in the checkpoint. `warn` receives
/// a message if some of them are lost.
///
/// # Errors
/// When other ranks or the checkpoint have another task, or the checkpoint cannot be read or written.
pub fn begin(task: Task, checkpoint: Option<(&Path, CreateFile)>, warn: impl FnMut(String)) -> Result<usize> {
    RUN.with_borrow_mut(|run| {
        if let Some(ranks) = &run.ranks {
            ranks.agree(&task)?;
        }
        if let Some((path, begin)) = checkpoint.filter(|_| run.ranks.as_ref().is_none_or(Ranks::is_first)) {
            run.checkpoint = Some(Checkpoint::open(path, &task, begin, warn)?);
        }
        Ok(run.checkpoint.as_ref().map_or(0, Checkpoint::count))
    })
}

/// Ends the task begun by [`begin`] and returns whether it succeeded: then its checkpoint is removed, otherwise `complain`
/// receives the error.
pub fn end(done: Result<()>, complain: impl FnOnce(&Error)) -> bool {
    let Run { ranks, checkpoint, is_released, .. } = RUN.take();
    let done = done.and_then(|()| checkpoint.map_or(Ok(()), Checkpoint::remove));
    match (done, ranks) {
        (Ok(()), _) => true,
        (Err(_), Some(_)) if is_released => true,
        (Err(error), Some(ranks)) => ranks.fail(|| complain(&error)),
        (Err(error), None) => {
            complain(&error);
            false
        }
    }
}

/// Computes all items and returns their results in index order, on every rank.
///
/// # Errors
/// The first error of an item; the remaining items are then skipped.
pub fn map<T: Serialize + DeserializeOwned + Send>(
    count: usize,
    work: impl Fn(usize) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    map_watched(count, work, |_, _| {})
}

/// As [`map`]; on the first rank, `watch` receives each result with its index, in order, as soon as it and all before it are
/// done.
///
/// # Errors
/// As [`map`].
pub fn map_watched<T: Serialize + DeserializeOwned + Send>(
    count: usize,
    work: impl Fn(usize) -> Result<T> + Sync,
    watch: impl FnMut(usize, &T),
) -> Result<Vec<T>> {
    let items = map_all(count, |_| (), |index, ()| work(index), watch)?;
    once(|| Ok(items))
}

/// Computes items whose inputs only the first rank knows and `give`s by index; only the first rank gets the results.
///
/// # Errors
/// As [`map`].
pub fn map_given<P: Serialize + DeserializeOwned + Send, T: Serialize + DeserializeOwned + Send>(
    count: usize,
    give: impl Fn(usize) -> P + Sync,
    work: impl Fn(usize, P) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    map_all(count, give, work, |_, _| {})
}

/// Computes items and passes each result with its index to `take`, in order. Only a few results per worker are in memory at
/// once. `take` must not distribute work itself. Ranks other than the first take nothing, and their run ends here.
///
/// # Errors
/// The first error of an item or of `take`; the remaining items are then skipped.
pub fn in_order<T: Serialize + DeserializeOwned + Send>(
    count: usize,
    work: impl Fn(usize) -> Result<T> + Sync,
    take: impl FnMut(usize, T) -> Result<()>,
) -> Result<()> {
    let ranks = RUN.with_borrow(|run| run.ranks.as_ref().map_or(1, Ranks::count));
    run_in_order(count, AHEAD * ranks * rayon::current_num_threads(), |_| (), |index, ()| work(index), take)?;
    if is_first() {
        return Ok(());
    }
    RUN.with_borrow_mut(|run| run.is_released = true);
    Err(Error::new("the first rank does the rest"))
}

/// Computes a value on the first rank only and returns it on all ranks.
///
/// # Errors
/// The error that `work` returns.
pub fn once<T: Serialize + DeserializeOwned>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    let value = if is_first() { Some(work()?) } else { None };
    RUN.with_borrow(|run| match (&run.ranks, value) {
        (None, Some(value)) => Ok(value),
        (Some(ranks), value) => ranks.broadcast(value),
        (None, None) => Err(Error::new("there is no first rank")),
    })
}

fn map_all<P: Serialize + DeserializeOwned + Send, T: Serialize + DeserializeOwned + Send>(
    count: usize,
    give: impl Fn(usize) -> P + Sync,
    work: impl Fn(usize, P) -> Result<T> + Sync,
    mut watch: impl FnMut(usize, &T),
) -> Result<Vec<T>> {
    let mut done = Vec::with_capacity(count);
    run_in_order(count, count, give, work, |index, item| {
        watch(index, &item);
        done.push(item);
        Ok(())
    })?;
    Ok(done)
}

/// Computes items and takes them in order, with at most `ahead` of them in progress.
fn run_in_order<P: Serialize + DeserializeOwned + Send, T: Serialize + DeserializeOwned + Send>(
    count: usize,
    ahead: usize,
    give: impl Fn(usize) -> P + Sync,
    work: impl Fn(usize, P) -> Result<T> + Sync,
    mut take: impl FnMut(usize, T) -> Result<()>,
) -> Result<()> {
    if rayon::current_thread_index().is_none() {
        return hand_out(count, ahead, &give, &work, take);
    }
    // Within an item of other work, a worker thread must not wait for other workers.
    for first in (0..count).step_by(ahead) {
        let item = |index: usize| work(index, give(index));
        let items = (first..count.min(first + ahead)).into_par_iter().map(item).collect::<Result<Vec<T>>>()?;
        (first..).zip(items).try_for_each(|(index, item)| take(index, item))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::thread;
    use std::time::Duration;

    use super::*;

    #[test]
    fn results_come_in_order_whichever_finishes_first() {
        let slow_first = |index: usize| {
            thread::sleep(Duration::from_millis((50 - index as u64) / 10));
            Ok(index * index)
        };
        assert_eq!(map(50, slow_first).unwrap(), (0..50).map(|i| i * i).collect::<Vec<usize>>());
        assert_eq!(map(0, slow_first).unwrap(), Vec::<usize>::new());
    }

    #[test]
    fn items_may_distribute_work_themselves() {
        let sums = map(40, |outer| Ok(map(40, |inner| Ok(outer * inner))?.iter().sum::<usize>())).unwrap();
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
        in_order(10_000, work, |index, _| {
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
        assert_eq!(map(100_000, work).unwrap_err().to_string(), "the third");
        assert!(begun.load(Ordering::SeqCst) < 1000);
        let refused = in_order(100_000, Ok::<usize, Error>, |_, _| Err(Error::new("full")));
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
        let panics = || map_watched(100, work, |_, _| panic!("enough"));
        assert!(catch_unwind(AssertUnwindSafe(panics)).is_err());
        let begun = begun.load(Ordering::SeqCst);
        assert!(begun <= 3 * rayon::current_num_threads(), "{begun}");
    }

    #[test]
    #[should_panic(expected = "a mistake")]
    fn panic_in_an_item_propagates() {
        let _ = map(10, |index| if index == 5 { panic!("a mistake") } else { Ok(index) });
    }
}
