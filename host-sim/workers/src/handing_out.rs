//! Handing out the pieces of one part of a run, and taking what comes of them in order.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::Duration;

use rayon::Scope;
use serde_bytes::ByteBuf;

use super::ranks::Ranks;
use super::{AHEAD, Workers};
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Batch;

/// How long a rank waits, for its own threads or for others, before it listens again: at first,
const GLANCE: Duration = Duration::from_micros(100);
/// and at most, when nothing has come for a while.
const LONGEST_WAIT: Duration = Duration::from_millis(1);
/// The first rank.
const HERE: usize = 0;

/// A message of a worker.
#[cfg_attr(not(feature = "mpi"), expect(dead_code))]
pub enum Heard {
    /// A thread of a rank is free.
    Free(usize),
    /// A rank has executed a piece: its rank, the index and the result.
    Done(usize, usize, Result<ByteBuf>),
}

/// The index and the result of a piece, as a thread sends it.
pub type Sent = (usize, thread::Result<Result<ByteBuf>>);

/// How long to wait for what is not there: longer each time, since looking takes time of processors that others need.
pub struct Waiting(Duration);

/// What other ranks have to do.
#[derive(Default)]
struct Helpers {
    /// Threads of each that are at work,
    busy: BTreeMap<usize, usize>,
    /// and its pieces that are not done.
    begun: BTreeMap<usize, usize>,
}

/// Hands out the pieces of a batch to threads and ranks, and their results to `batch.take` in order. Ranks other than the first
/// execute what is handed to them.
pub fn hand_out(workers: &Workers, batch: Batch<'_>) -> Result<()> {
    let Batch { count, is_bounded, input, work, take, .. } = batch;
    let part = workers.batches.fetch_add(1, Ordering::Relaxed) + 1;
    let threads = rayon::current_num_threads();
    let all = threads * workers.ranks.as_ref().map_or(1, Ranks::count);
    let ahead = if is_bounded { AHEAD * all } else { count };
    let is_over = &AtomicBool::new(false);
    rayon::in_place_scope(|scope| {
        let _over = Over(is_over);
        let (sender, results) = mpsc::channel();
        let start = |index: usize, piece: ByteBuf| {
            let sender = sender.clone();
            scope.spawn(move |_: &Scope| {
                if !is_over.load(Ordering::Relaxed) {
                    let done = catch_unwind(AssertUnwindSafe(|| work(index, &piece).map(ByteBuf::from)));
                    // Nobody listens any more when something else failed.
                    let _ = sender.send((index, done));
                }
            });
        };
        if let Some(ranks) = workers.ranks.as_ref().filter(|ranks| !ranks.is_first()) {
            return ranks.help(part, threads, start, &results);
        }
        // Threads of one process share one queue, which must never run dry; with ranks, no piece waits for a busy one.
        let own = if workers.ranks.is_some() { threads } else { AHEAD * threads };
        let mut free = vec![HERE; own];
        let mut helpers = Helpers::default();
        let (mut begun, mut waiting) = (0, BTreeMap::new());
        let mut result = |next: usize| loop {
            let end = count.min(next + ahead);
            while begun < end {
                if is_known(workers, part, begun) {
                    begun += 1;
                    continue;
                }
                let Some(rank) = free.pop() else { break };
                if rank == HERE {
                    start(begun, ByteBuf::from(input(begun)?));
                    begun += 1;
                    continue;
                }
                // While there are many, several go with one message: half of an even share, so that all end together.
                let some = ((end - begun) / (2 * all)).max(1);
                let indices: Vec<usize> =
                    (begun..end).filter(|index| !is_known(workers, part, *index)).take(some).collect();
                begun = indices.last().map_or(end, |last| last + 1);
                let pieces = indices.into_iter().map(|index| Ok((index, ByteBuf::from(input(index)?))));
                helpers.hand(workers, rank, pieces.collect::<Result<_>>()?)?;
            }
            if let Some(result) = recall(workers, part, next)?.or_else(|| waiting.remove(&next)) {
                return Ok::<ByteBuf, Error>(result);
            }
            match listen(workers, part, &results)? {
                Heard::Free(rank) => free.push(rank),
                Heard::Done(rank, index, result) => {
                    let result = result?;
                    keep(workers, part, index, &result)?;
                    waiting.insert(index, result);
                    if rank == HERE || helpers.has_free_thread(rank) {
                        free.push(rank);
                    }
                }
            }
        };
        let all = (0..count).try_for_each(|next| take(next, result(next)?.into_vec()));
        all.and_then(|()| workers.ranks.as_ref().map_or(Ok(()), Ranks::over))
    })
}

/// Keeps pieces from being begun once it is dropped, even where something panicked.
struct Over<'a>(&'a AtomicBool);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Waiting {
    /// Something came.
    pub fn begin() -> Self {
        Waiting(GLANCE)
    }

    /// How long to wait now.
    pub fn next(&mut self) -> Duration {
        let now = self.0;
        self.0 = LONGEST_WAIT.min(2 * now);
        now
    }
}

impl Helpers {
    /// Hands pieces to one thread of a rank.
    fn hand(&mut self, workers: &Workers, rank: usize, pieces: Vec<(usize, ByteBuf)>) -> Result<()> {
        *self.busy.entry(rank).or_default() += 1;
        *self.begun.entry(rank).or_default() += pieces.len();
        workers.ranks.as_ref().map_or(Ok(()), |ranks| ranks.hand(rank, &pieces))
    }

    /// Whether a rank that has done a piece has a thread without one.
    fn has_free_thread(&mut self, rank: usize) -> bool {
        let (busy, begun) = (self.busy.entry(rank).or_default(), self.begun.entry(rank).or_default());
        *begun -= 1;
        let is_free = *begun < *busy;
        *busy -= usize::from(is_free);
        is_free
    }
}

/// The result of a piece that a thread has executed; a panic goes on here.
pub fn unwound((index, result): Sent) -> (usize, Result<ByteBuf>) {
    (index, result.unwrap_or_else(|panic| resume_unwind(panic)))
}

/// Waits for the next message of a worker, here or on another rank.
fn listen(workers: &Workers, part: u32, results: &Receiver<Sent>) -> Result<Heard> {
    let here = |sent: Sent| {
        let (index, result) = unwound(sent);
        Heard::Done(HERE, index, result)
    };
    let Some(ranks) = &workers.ranks else {
        return results.recv().map(here).map_err(|e| Error::new(format!("a piece of work is lost: {e}")));
    };
    let mut waiting = Waiting::begin();
    loop {
        if let Some(heard) = ranks.heard(part)? {
            return Ok(heard);
        }
        if let Ok(sent) = results.recv_timeout(waiting.next()) {
            return Ok(here(sent));
        }
    }
}

/// Whether an interrupted run has left the result of a piece.
fn is_known(workers: &Workers, part: u32, index: usize) -> bool {
    workers.checkpoint().as_ref().is_some_and(|checkpoint| checkpoint.holds((part, index as u32)))
}

fn recall(workers: &Workers, part: u32, index: usize) -> Result<Option<ByteBuf>> {
    workers.checkpoint().as_mut().map_or(Ok(None), |checkpoint| checkpoint.recall((part, index as u32)))
}

fn keep(workers: &Workers, part: u32, index: usize, result: &ByteBuf) -> Result<()> {
    workers.checkpoint().as_mut().map_or(Ok(()), |checkpoint| checkpoint.keep((part, index as u32), result))
}
