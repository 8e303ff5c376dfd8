//! Handing out the pieces of one part of a run, and taking what comes of them in order.

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

/// How long a rank waits, for its own threads or for others, before it listens again: at first,
const GLANCE: Duration = Duration::from_micros(100);
/// and at most, when nothing has come for a while.
const LONGEST_WAIT: Duration = Duration::from_millis(1);
/// The first rank.
const HERE: usize = 0;

/// What is heard while work is handed out.
#[cfg_attr(not(feature = "mpi"), expect(dead_code))]
pub enum Told<T> {
    /// A thread of a rank is free.
    Free(usize),
    /// A rank has done a piece.
    Done(usize, usize, Result<T>),
}

/// What a thread sends when a piece is done.
pub type Sent<T> = (usize, thread::Result<Result<T>>);

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

/// Hands out pieces, which `give` knows on the first rank, to threads and ranks, and gives what comes of them to `take` in
/// order; on other ranks than the first does what is handed to them.
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
        let start = |index: usize, piece: P| {
            let sender = sender.clone();
            scope.spawn(move |_: &Scope| {
                if !is_over.load(Ordering::Relaxed) {
                    // Nobody listens any more when something else failed.
                    let _ = sender.send((index, catch_unwind(AssertUnwindSafe(|| work(index, piece)))));
                }
            });
        };
        let helped = RUN.with_borrow(|run| {
            let ranks = run.ranks.as_ref().filter(|ranks| !ranks.is_first())?;
            Some(ranks.help(part, threads, start, &results))
        });
        if let Some(helped) = helped {
            return helped;
        }
        // Threads of one process have one queue, which is never to run dry; at the end no piece waits for a busy rank.
        let of_here = if has_ranks() { threads } else { AHEAD * threads };
        let mut free = vec![HERE; of_here];
        let workers = threads * RUN.with_borrow(|run| run.ranks.as_ref().map_or(1, |ranks| ranks.count()));
        let mut helpers = Helpers::default();
        let (mut begun, mut waiting) = (0, BTreeMap::new());
        let mut piece = |next: usize| loop {
            let end = count.min(next + ahead);
            while begun < end {
                if is_known(part, begun) {
                    begun += 1;
                    continue;
                }
                let Some(rank) = free.pop() else { break };
                if rank == HERE {
                    start(begun, give(begun));
                    begun += 1;
                    continue;
                }
                // While there are many, several go with one message: half of an even share, so that all end together.
                let some = ((end - begun) / (2 * workers)).max(1);
                let indices: Vec<usize> = (begun..end).filter(|index| !is_known(part, *index)).take(some).collect();
                begun = indices.last().map_or(end, |last| last + 1);
                helpers.hand(rank, indices.into_iter().map(|index| (index, give(index))).collect())?;
            }
            if let Some(piece) = recall(part, next)?.or_else(|| waiting.remove(&next)) {
                return Ok(piece);
            }
            match listen(part, &results)? {
                Told::Free(rank) => free.push(rank),
                Told::Done(rank, index, piece) => {
                    let piece = piece?;
                    keep(part, index, &piece)?;
                    waiting.insert(index, piece);
                    if rank == HERE || helpers.has_free_thread(rank) {
                        free.push(rank);
                    }
                }
            }
        };
        let all = (0..count).try_for_each(|next| take(next, piece(next)?));
        all.and_then(|()| RUN.with_borrow(|run| run.ranks.as_ref().map_or(Ok(()), |ranks| ranks.over())))
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
    fn hand<P: Serialize>(&mut self, rank: usize, pieces: Vec<(usize, P)>) -> Result<()> {
        *self.busy.entry(rank).or_default() += 1;
        *self.begun.entry(rank).or_default() += pieces.len();
        RUN.with_borrow(|run| run.ranks.as_ref().map_or(Ok(()), |ranks| ranks.hand(rank, &pieces)))
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

/// A piece that a thread has done.
pub fn unwound<T>((index, piece): Sent<T>) -> (usize, Result<T>) {
    (index, piece.unwrap_or_else(|panic| resume_unwind(panic)))
}

fn has_ranks() -> bool {
    RUN.with_borrow(|run| run.ranks.is_some())
}

/// What the next worker tells, here or elsewhere.
fn listen<T: DeserializeOwned>(part: u32, results: &Receiver<Sent<T>>) -> Result<Told<T>> {
    let here = |sent: Sent<T>| {
        let (index, piece) = unwound(sent);
        Told::Done(HERE, index, piece)
    };
    RUN.with_borrow(|run| {
        let Some(ranks) = &run.ranks else {
            return results.recv().map(here).map_err(|e| Error::new(format!("a piece of work is lost: {e}")));
        };
        let mut waiting = Waiting::begin();
        loop {
            if let Some(told) = ranks.told(part)? {
                return Ok(told);
            }
            if let Ok(sent) = results.recv_timeout(waiting.next()) {
                return Ok(here(sent));
            }
        }
    })
}

/// Whether a run before has done a piece.
fn is_known(part: u32, index: usize) -> bool {
    RUN.with_borrow(|run| run.checkpoint.as_ref().is_some_and(|checkpoint| checkpoint.holds((part, index as u32))))
}

fn recall<T: DeserializeOwned>(part: u32, index: usize) -> Result<Option<T>> {
    RUN.with_borrow_mut(|run| match &mut run.checkpoint {
        Some(checkpoint) => checkpoint.recall((part, index as u32)),
        None => Ok(None),
    })
}

fn keep(part: u32, index: usize, piece: &impl Serialize) -> Result<()> {
    RUN.with_borrow_mut(|run| match &mut run.checkpoint {
        Some(checkpoint) => checkpoint.keep((part, index as u32), piece),
        None => Ok(()),
    })
}
