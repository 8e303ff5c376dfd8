//! Independent pieces of work, handed out by index to whoever is free. What comes of them is taken in the order of their
//! indices, so that it is the same whoever did the work.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;

use rayon::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::{Error, Result};

/// So many pieces a thread are begun before the first of them is taken: whoever waits for a slow one has other work.
const AHEAD: usize = 4;

/// What comes of pieces of work, by index.
///
/// # Errors
/// What a piece returns; the others are then left.
pub fn map<T: Serialize + DeserializeOwned + Send>(
    count: usize,
    work: impl Fn(usize) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    let mut pieces = Vec::with_capacity(count);
    in_order(count, work, |_, piece| {
        pieces.push(piece);
        Ok(())
    })?;
    Ok(pieces)
}

/// Does pieces of work and gives each with its index to `take`, the first one first. Only so many are there at once as
/// there are workers, times a few.
///
/// # Errors
/// What a piece or `take` returns; the other pieces are then left.
pub fn in_order<T: Serialize + DeserializeOwned + Send>(
    count: usize,
    work: impl Fn(usize) -> Result<T> + Sync,
    mut take: impl FnMut(usize, T) -> Result<()>,
) -> Result<()> {
    let ahead = AHEAD * rayon::current_num_threads();
    if rayon::current_thread_index().is_some() {
        // It is called within a piece of other work, and a thread that does pieces must not wait for others to.
        for first in (0..count).step_by(ahead) {
            let pieces = (first..count.min(first + ahead)).into_par_iter().map(&work).collect::<Result<Vec<T>>>()?;
            (first..).zip(pieces).try_for_each(|(index, piece)| take(index, piece))?;
        }
        return Ok(());
    }
    let (work, is_over) = (&work, &AtomicBool::new(false));
    rayon::in_place_scope(|scope| {
        let (done, results) = mpsc::channel();
        let begin = |index: usize| {
            let done = done.clone();
            scope.spawn(move |_| {
                if !is_over.load(Ordering::Relaxed) {
                    // Nobody waits any more when something else failed.
                    let _ = done.send((index, catch_unwind(AssertUnwindSafe(|| work(index)))));
                }
            });
        };
        let (mut begun, mut waiting) = (0, BTreeMap::new());
        let mut next_piece = |next: usize| loop {
            while begun < count.min(next + ahead) {
                begin(begun);
                begun += 1;
            }
            if let Some(piece) = waiting.remove(&next) {
                return piece;
            }
            let (index, piece) = results.recv().map_err(|e| Error::new(format!("a piece of work is lost: {e}")))?;
            waiting.insert(index, piece.unwrap_or_else(|panic| resume_unwind(panic)));
        };
        let all = (0..count).try_for_each(|next| take(next, next_piece(next)?));
        is_over.store(true, Ordering::Relaxed);
        all
    })
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicUsize;
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
        assert_eq!(map(0, slow_first).unwrap(), []);
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

    #[test]
    #[should_panic(expected = "a mistake")]
    fn a_panic_goes_through() {
        let _ = map(10, |index| if index == 5 { panic!("a mistake") } else { Ok(index) });
    }
}
