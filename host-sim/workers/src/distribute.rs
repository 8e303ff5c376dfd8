//! Distributes the items of one part of a run and takes their results in order.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::Duration;

use rayon::Scope;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{AHEAD, RUN};
use mindgap_foundations::error::{Error, Result};

/// How long a rank first waits for threads or other ranks before it polls again.
const FIRST_WAIT: Duration = Duration::from_micros(100);
/// Longest wait between polls, when nothing has come for a while.
const LONGEST_WAIT: Duration = Duration::from_millis(1);
/// The first rank.
const HERE: usize = 0;

/// A message of a worker to the first rank.
#[cfg_attr(not(feature = "mpi"), expect(dead_code))]
pub enum Message<T> {
    /// A thread of a rank is free.
    Free(usize),
    /// A rank has finished an item.
    Done(usize, usize, Result<T>),
}

/// What a thread sends when an item is done: its index and its result, or the panic that ended it.
pub type Sent<T> = (usize, thread::Result<Result<T>>);

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

/// On the first rank, hands out items, with inputs from `give`, to threads and ranks and passes their results to `take` in
/// order; on other ranks, works on the items handed to them.
pub fn hand_out<P, T>(
    count: usize,
    ahead: usize,
    give: &impl Fn(usize) -> P,
    work: &(impl Fn(usize, P) -> Result<T> + Sync),
    mut take: impl FnMut(usize, T) -> Result<()>,
) -> Result<()>
where
    P: Serialize + DeserializeOwned + Send,
    T: Serialize + DeserializeOwned + Send,
{
    let part = RUN.with_borrow_mut(|run| {
        run.parts += 1;
        run.parts
    });
    let threads = rayon::current_num_threads();
    let is_over = &AtomicBool::new(false);
    rayon::in_place_scope(|scope| {
        let _over = Over(is_over);
        let (sender, results) = mpsc::channel();
        let start = |index: usize, item: P| {
            let sender = sender.clone();
            scope.spawn(move |_: &Scope| {
                if !is_over.load(Ordering::Relaxed) {
                    // The receiver is gone if something else failed.
                    let _ = sender.send((index, catch_unwind(AssertUnwindSafe(|| work(index, item)))));
                }
            });
        };
        let outcome = RUN.with_borrow(|run| {
            let ranks = run.ranks.as_ref().filter(|ranks| !ranks.is_first())?;
            Some(ranks.help(part, threads, start, &results))
        });
        if let Some(outcome) = outcome {
            return outcome;
        }
        // The threads of one process share a queue, which must never run dry. With ranks, one item per thread keeps
        // items from waiting for a busy rank at the end.
        let local = if has_ranks() { threads } else { AHEAD * threads };
        let mut free = vec![HERE; local];
        let workers = threads * RUN.with_borrow(|run| run.ranks.as_ref().map_or(1, |ranks| ranks.count()));
        let mut helpers = Helpers::default();
        let (mut started, mut waiting) = (0, BTreeMap::new());
        let mut item = |next: usize| loop {
            let end = count.min(next + ahead);
            while started < end {
                if is_saved(part, started) {
                    started += 1;
                    continue;
                }
                let Some(rank) = free.pop() else { break };
                if rank == HERE {
                    start(started, give(started));
                    started += 1;
                    continue;
                }
                // While many are left, one message carries several: half of an even share, so that all ranks
                // finish together.
                let batch = ((end - started) / (2 * workers)).max(1);
                let indices: Vec<usize> = (started..end).filter(|index| !is_saved(part, *index)).take(batch).collect();
                started = indices.last().map_or(end, |last| last + 1);
                helpers.hand(rank, indices.into_iter().map(|index| (index, give(index))).collect())?;
            }
            if let Some(item) = load(part, next)?.or_else(|| waiting.remove(&next)) {
                return Ok(item);
            }
            match listen(part, &results)? {
                Message::Free(rank) => free.push(rank),
                Message::Done(rank, index, item) => {
                    let item = item?;
                    save(part, index, &item)?;
                    waiting.insert(index, item);
                    if rank == HERE || helpers.has_free_thread(rank) {
                        free.push(rank);
                    }
                }
            }
        };
        let taken = (0..count).try_for_each(|next| take(next, item(next)?));
        taken.and_then(|()| RUN.with_borrow(|run| run.ranks.as_ref().map_or(Ok(()), |ranks| ranks.finish_part())))
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
    fn hand<P: Serialize>(&mut self, rank: usize, items: Vec<(usize, P)>) -> Result<()> {
        *self.busy.entry(rank).or_default() += 1;
        *self.started.entry(rank).or_default() += items.len();
        RUN.with_borrow(|run| run.ranks.as_ref().map_or(Ok(()), |ranks| ranks.hand(rank, &items)))
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
pub fn unwound<T>((index, item): Sent<T>) -> (usize, Result<T>) {
    (index, item.unwrap_or_else(|panic| resume_unwind(panic)))
}

fn has_ranks() -> bool {
    RUN.with_borrow(|run| run.ranks.is_some())
}

/// Waits for the next message of a local thread or another rank.
fn listen<T: DeserializeOwned>(part: u32, results: &Receiver<Sent<T>>) -> Result<Message<T>> {
    let local_message = |finished: Sent<T>| {
        let (index, item) = unwound(finished);
        Message::Done(HERE, index, item)
    };
    RUN.with_borrow(|run| {
        let Some(ranks) = &run.ranks else {
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
    })
}

/// Returns whether the checkpoint has an item.
fn is_saved(part: u32, index: usize) -> bool {
    RUN.with_borrow(|run| run.checkpoint.as_ref().is_some_and(|checkpoint| checkpoint.contains((part, index as u32))))
}

fn load<T: DeserializeOwned>(part: u32, index: usize) -> Result<Option<T>> {
    RUN.with_borrow_mut(|run| match &mut run.checkpoint {
        Some(checkpoint) => checkpoint.load((part, index as u32)),
        None => Ok(None),
    })
}

fn save(part: u32, index: usize, item: &impl Serialize) -> Result<()> {
    RUN.with_borrow_mut(|run| match &mut run.checkpoint {
        Some(checkpoint) => checkpoint.save((part, index as u32), item),
        None => Ok(()),
    })
}
