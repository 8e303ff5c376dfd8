//! Distributes the items of one part of a run and takes their results in order.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::Duration;

use rayon::Scope;
use serde_bytes::ByteBuf;

use super::{AHEAD, Workers};
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Batch;

/// How long a rank first waits for threads or other ranks before it polls again.
const FIRST_WAIT: Duration = Duration::from_micros(100);
/// Longest wait between polls, when nothing has come for a while.
const LONGEST_WAIT: Duration = Duration::from_millis(1);
/// The first rank.
const HERE: usize = 0;

/// A message of a worker to the first rank.
#[cfg_attr(not(feature = "mpi"), expect(dead_code))]
pub enum Message {
    /// A thread of a rank is free.
    Free(usize),
    /// A rank has finished an item.
    Done(usize, usize, Result<ByteBuf>),
}

/// What a thread sends when an item is done: its index and its result, or the panic that ended it.
pub type Sent = (usize, thread::Result<Result<ByteBuf>>);

/// Increasing waits between polls, since polling takes processor time that workers need.
pub struct Backoff(Duration);

/// The work of other ranks.
#[derive(Default)]
struct Helpers {
    /// Number of busy threads by rank.
    busy: BTreeMap<usize, usize>,
    /// Number of items in progress by rank.
    started: BTreeMap<usize, usize>,
}

/// On the first rank, hands out the items of a batch to threads and ranks and passes their results to `batch.take` in order; on
/// other ranks, works on the items handed to them.
pub fn hand_out(workers: &Workers, batch: Batch<'_>) -> Result<()> {
    let Batch { count, is_bounded, input, work, take, .. } = batch;
    let part = workers.parts.fetch_add(1, Ordering::Relaxed) + 1;
    let threads = rayon::current_num_threads();
    let all_threads = threads * workers.ranks.as_ref().map_or(1, |ranks| ranks.count());
    let ahead = if is_bounded { AHEAD * all_threads } else { count };
    let is_over = &AtomicBool::new(false);
    rayon::in_place_scope(|scope| {
        let _over = Over(is_over);
        let (sender, results) = mpsc::channel();
        let start = |index: usize, item: ByteBuf| {
            let sender = sender.clone();
            scope.spawn(move |_: &Scope| {
                if !is_over.load(Ordering::Relaxed) {
                    let result = catch_unwind(AssertUnwindSafe(|| work(index, &item).map(ByteBuf::from)));
                    // The receiver is gone if something else failed.
                    let _ = sender.send((index, result));
                }
            });
        };
        if let Some(ranks) = workers.ranks.as_ref().filter(|ranks| !ranks.is_first()) {
            return ranks.help(part, threads, start, &results);
        }
        // The threads of one process share a queue, which must never run dry. With ranks, one item per thread keeps
        // items from waiting for a busy rank at the end.
        let local = if workers.ranks.is_some() { threads } else { AHEAD * threads };
        let mut free = vec![HERE; local];
        let mut helpers = Helpers::default();
        let (mut started, mut waiting) = (0, BTreeMap::new());
        let mut result = |next: usize| loop {
            let end = count.min(next + ahead);
            while started < end {
                if is_saved(workers, part, started) {
                    started += 1;
                    continue;
                }
                let Some(rank) = free.pop() else { break };
                if rank == HERE {
                    start(started, ByteBuf::from(input(started)?));
                    started += 1;
                    continue;
                }
                // While many are left, one message carries several: half of an even share, so that all ranks
                // finish together.
                let share = ((end - started) / (2 * all_threads)).max(1);
                let is_open = |index: &usize| !is_saved(workers, part, *index);
                let indices: Vec<usize> = (started..end).filter(is_open).take(share).collect();
                started = indices.last().map_or(end, |last| last + 1);
                let items = indices.into_iter().map(|index| Ok((index, ByteBuf::from(input(index)?))));
                helpers.hand(workers, rank, items.collect::<Result<_>>()?)?;
            }
            if let Some(result) = load(workers, part, next)?.or_else(|| waiting.remove(&next)) {
                return Ok::<ByteBuf, Error>(result);
            }
            match listen(workers, part, &results)? {
                Message::Free(rank) => free.push(rank),
                Message::Done(rank, index, result) => {
                    let result = result?;
                    save(workers, part, index, &result)?;
                    waiting.insert(index, result);
                    if rank == HERE || helpers.has_free_thread(rank) {
                        free.push(rank);
                    }
                }
            }
        };
        let taken = (0..count).try_for_each(|next| take(next, result(next)?.into_vec()));
        taken.and_then(|()| workers.ranks.as_ref().map_or(Ok(()), |ranks| ranks.finish_part()))
    })
}

/// Prevents further items from starting once it is dropped, even after a panic.
struct Over<'a>(&'a AtomicBool);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Backoff {
    /// Starts over after a message.
    pub fn new() -> Self {
        Backoff(FIRST_WAIT)
    }

    /// Returns how long to wait now.
    pub fn next(&mut self) -> Duration {
        let now = self.0;
        self.0 = LONGEST_WAIT.min(2 * now);
        now
    }
}

impl Helpers {
    /// Hands items to one thread of a rank.
    fn hand(&mut self, workers: &Workers, rank: usize, items: Vec<(usize, ByteBuf)>) -> Result<()> {
        *self.busy.entry(rank).or_default() += 1;
        *self.started.entry(rank).or_default() += items.len();
        workers.ranks.as_ref().map_or(Ok(()), |ranks| ranks.hand(rank, &items))
    }

    /// Counts a finished item and returns whether its rank has an idle thread.
    fn has_free_thread(&mut self, rank: usize) -> bool {
        let (busy, started) = (self.busy.entry(rank).or_default(), self.started.entry(rank).or_default());
        *started -= 1;
        let is_free = *started < *busy;
        *busy -= usize::from(is_free);
        is_free
    }
}

/// Returns a finished item, or resumes the panic that ended it.
pub fn unwound((index, result): Sent) -> (usize, Result<ByteBuf>) {
    (index, result.unwrap_or_else(|panic| resume_unwind(panic)))
}

/// Waits for the next message of a local thread or another rank.
fn listen(workers: &Workers, part: u32, results: &Receiver<Sent>) -> Result<Message> {
    let local_message = |finished: Sent| {
        let (index, result) = unwound(finished);
        Message::Done(HERE, index, result)
    };
    let Some(ranks) = &workers.ranks else {
        return results.recv().map(local_message).map_err(|e| Error::new(format!("a work item was lost: {e}")));
    };
    let mut backoff = Backoff::new();
    loop {
        if let Some(message) = ranks.poll(part)? {
            return Ok(message);
        }
        if let Ok(finished) = results.recv_timeout(backoff.next()) {
            return Ok(local_message(finished));
        }
    }
}

/// Returns whether the checkpoint has an item.
fn is_saved(workers: &Workers, part: u32, index: usize) -> bool {
    workers.checkpoint().as_ref().is_some_and(|checkpoint| checkpoint.contains((part, index as u32)))
}

fn load(workers: &Workers, part: u32, index: usize) -> Result<Option<ByteBuf>> {
    workers.checkpoint().as_mut().map_or(Ok(None), |checkpoint| checkpoint.load((part, index as u32)))
}

fn save(workers: &Workers, part: u32, index: usize, result: &ByteBuf) -> Result<()> {
    workers.checkpoint().as_mut().map_or(Ok(()), |checkpoint| checkpoint.save((part, index as u32), result))
}
