//! Independent pieces of work, handed out by index to whoever is free: threads, and with the feature `mpi` the ranks of a
//! cluster. What comes of them is taken in the order of their indices, so that it is the same whoever did the work, and
//! kept in a [`checkpoint`], from which a run goes on that was broken off.
//!
//! [`begin`] and [`end`] stand around a command; without them there are threads alone, and no checkpoint.

pub mod checkpoint;
mod handing_out;
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

use checkpoint::{Begin, Checkpoint};
use handing_out::hand_out;
use mindgap_foundations::error::{Error, Result};
#[cfg(not(feature = "mpi"))]
use no_ranks as ranks;
use ranks::Ranks;
use task::Task;

/// So many pieces a thread are begun before the first of them is taken: whoever waits for a slow one has other work.
const AHEAD: usize = 4;
/// How the variables begin by which a process knows that it is a rank.
const RANK_VARIABLES: [&str; 3] = ["OMPI_", "PMIX_", "PMI_"];

/// What stands around the work of a thread: of the main one alone, if at all.
#[derive(Default)]
struct Run {
    ranks: Option<Ranks>,
    checkpoint: Option<Checkpoint>,
    /// Parts that have begun: each hand-out is one.
    parts: u32,
    /// Whether all that is left to do is the first rank's.
    is_released: bool,
}

thread_local! {
    static RUN: RefCell<Run> = RefCell::default();
}

/// Joins the ranks with which this process was started, if it was by `mpirun`.
///
/// # Errors
/// When MPI cannot be begun.
pub fn join() -> Result<()> {
    let ranks = Ranks::join()?;
    RUN.with_borrow_mut(|run| run.ranks = ranks);
    Ok(())
}

/// Keeps another program that is called from taking itself for one of the ranks.
pub fn keep_out(program: &mut Command) {
    let of_ranks = |name: &OsString| RANK_VARIABLES.iter().any(|prefix| name.to_string_lossy().starts_with(prefix));
    for name in env::vars_os().map(|(name, _)| name).filter(of_ranks) {
        program.env_remove(name);
    }
}

/// Whether this is the process that writes, prints and asks: the first rank, or the only one.
pub fn is_first() -> bool {
    RUN.with_borrow(|run| run.ranks.as_ref().is_none_or(Ranks::is_first))
}

/// Threads for each of several ranks: those on one machine share its processors.
pub fn threads() -> Option<usize> {
    let processors = available_parallelism().map_or(1, usize::from);
    let ranks = RUN.with_borrow(|run| run.ranks.as_ref().map(Ranks::on_this_machine))?;
    Some((processors / ranks).max(1))
}

/// Leaves the work to the first rank alone.
pub fn go_alone() {
    RUN.with_borrow_mut(|run| run.ranks = None);
}

/// Begins a task whose work is handed out, from where the checkpoint stands if there is one; returns the number of pieces
/// of work in it. `warn` is told when some of them are lost.
///
/// # Errors
/// When other ranks have another task, or the checkpoint has, or it cannot be read or written.
pub fn begin(task: Task, checkpoint: Option<(&Path, Begin)>, warn: impl FnMut(String)) -> Result<usize> {
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

/// Ends what was begun, and `complain`s where it failed; returns whether it was done. Its checkpoint is then removed.
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

/// What comes of pieces of work, by index, on every rank.
///
/// # Errors
/// What a piece returns; the others are then left.
pub fn map<T: Serialize + DeserializeOwned + Send>(
    count: usize,
    work: impl Fn(usize) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    map_told(count, work, |_, _| {})
}

/// The same; the first rank is `told` of each with its index when all before it are done, too.
///
/// # Errors
/// As [`map`].
pub fn map_told<T: Serialize + DeserializeOwned + Send>(
    count: usize,
    work: impl Fn(usize) -> Result<T> + Sync,
    told: impl FnMut(usize, &T),
) -> Result<Vec<T>> {
    let pieces = map_all(count, |_| (), |index, ()| work(index), told)?;
    once(|| Ok(pieces))
}

/// What comes of pieces that only the first rank knows, and which it `gives` with their indices; only there is it known.
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

/// Does pieces of work and gives each with its index to `take`, the first one first. Only so many are there at once as
/// there are workers, times a few. `take` hands out nothing itself. This is the end for ranks other than the first:
/// nothing is taken on them.
///
/// # Errors
/// What a piece or `take` returns; the other pieces are then left.
pub fn in_order<T: Serialize + DeserializeOwned + Send>(
    count: usize,
    work: impl Fn(usize) -> Result<T> + Sync,
    take: impl FnMut(usize, T) -> Result<()>,
) -> Result<()> {
    let ranks = RUN.with_borrow(|run| run.ranks.as_ref().map_or(1, Ranks::count));
    distribute(count, AHEAD * ranks * rayon::current_num_threads(), |_| (), |index, ()| work(index), take)?;
    if is_first() {
        return Ok(());
    }
    RUN.with_borrow_mut(|run| run.is_released = true);
    Err(Error::new("the rest is the first rank's"))
}

/// What the first rank does alone and all need to know.
///
/// # Errors
/// What the work returns.
pub fn once<T: Serialize + DeserializeOwned>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    let value = if is_first() { Some(work()?) } else { None };
    RUN.with_borrow(|run| match (&run.ranks, value) {
        (None, Some(value)) => Ok(value),
        (Some(ranks), value) => ranks.everywhere(value),
        (None, None) => Err(Error::new("there is no first rank")),
    })
}

fn map_all<P: Serialize + DeserializeOwned + Send, T: Serialize + DeserializeOwned + Send>(
    count: usize,
    give: impl Fn(usize) -> P + Sync,
    work: impl Fn(usize, P) -> Result<T> + Sync,
    mut told: impl FnMut(usize, &T),
) -> Result<Vec<T>> {
    let mut done = Vec::with_capacity(count);
    distribute(count, count, give, work, |index, piece| {
        told(index, &piece);
        done.push(piece);
        Ok(())
    })?;
    Ok(done)
}

/// Does pieces of work and takes them in order, at most `ahead` of them on their way.
fn distribute<P: Serialize + DeserializeOwned + Send, T: Serialize + DeserializeOwned + Send>(
    count: usize,
    ahead: usize,
    give: impl Fn(usize) -> P + Sync,
    work: impl Fn(usize, P) -> Result<T> + Sync,
    mut take: impl FnMut(usize, T) -> Result<()>,
) -> Result<()> {
    if rayon::current_thread_index().is_none() {
        return hand_out(count, ahead, &give, &work, take);
    }
    // It is called within a piece of other work, and a thread that does pieces must not wait for others to.
    for first in (0..count).step_by(ahead) {
        let piece = |index: usize| work(index, give(index));
        let pieces = (first..count.min(first + ahead)).into_par_iter().map(piece).collect::<Result<Vec<T>>>()?;
        (first..).zip(pieces).try_for_each(|(index, piece)| take(index, piece))?;
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
    fn pieces_come_in_order_whichever_is_done_first() {
        let slow_first = |index: usize| {
            thread::sleep(Duration::from_millis((50 - index as u64) / 10));
            Ok(index * index)
        };
        assert_eq!(map(50, slow_first).unwrap(), (0..50).map(|i| i * i).collect::<Vec<usize>>());
        assert_eq!(map(0, slow_first).unwrap(), Vec::<usize>::new());
    }

    #[test]
    fn a_piece_may_hand_out_work_of_its_own() {
        let sums = map(40, |outer| Ok(map(40, |inner| Ok(outer * inner))?.iter().sum::<usize>())).unwrap();
        assert_eq!(sums, (0..40).map(|outer| outer * 780).collect::<Vec<usize>>());
    }

    #[test]
    fn no_more_is_begun_than_can_be_taken_soon() {
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
    fn a_failure_leaves_the_rest() {
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

    /// As when Ctrl-C ends it.
    #[test]
    fn a_panic_of_whoever_is_told_leaves_what_has_not_begun() {
        let begun = AtomicUsize::new(0);
        let work = |index: usize| {
            begun.fetch_add(1, Ordering::SeqCst);
            thread::sleep(Duration::from_millis(20));
            Ok(index)
        };
        let panics = || map_told(100, work, |_, _| panic!("enough"));
        assert!(catch_unwind(AssertUnwindSafe(panics)).is_err());
        let begun = begun.load(Ordering::SeqCst);
        assert!(begun <= 3 * rayon::current_num_threads(), "{begun}");
    }

    #[test]
    #[should_panic(expected = "a mistake")]
    fn a_panic_goes_through() {
        let _ = map(10, |index| if index == 5 { panic!("a mistake") } else { Ok(index) });
    }
}
