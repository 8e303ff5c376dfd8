//! Independent pieces of work, and what executes them: this thread, many threads, or the ranks of a cluster.
//!
//! Code that has independent work is handed an [`Executor`] and never looks for one, so results depend on neither threads nor
//! ranks: they are taken in the order of their indices. Inputs and results cross the trait as bytes, because an executor may
//! send them to another process or keep them in a checkpoint; [`map`], [`map_inputs`], [`in_order`] and [`once`] do the encoding.

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::{Error, Result};

/// Executes independent pieces of work.
pub trait Executor: Sync {
    /// Executes all pieces of a batch and hands their results over in the order of their indices.
    ///
    /// # Errors
    /// The first error of a piece or of `batch.take`; pieces that have not begun are then dropped. On a rank other than the
    /// first, the end of a batch that is the last one.
    fn execute(&self, batch: Batch<'_>) -> Result<()>;

    /// Calls `work` on the first rank only, and returns its result on every rank.
    ///
    /// # Errors
    /// The error of `work`.
    fn once(&self, work: &mut dyn FnMut() -> Result<Vec<u8>>) -> Result<Vec<u8>>;

    /// Whether this process writes, prints and asks: the first rank, or the only process.
    fn is_first(&self) -> bool;
}

/// Executes the piece with an index and an encoded input, and returns its encoded result.
pub type Work<'a> = dyn Fn(usize, &[u8]) -> Result<Vec<u8>> + Sync + 'a;

/// Independent pieces of work with indices from 0.
pub struct Batch<'a> {
    /// Number of pieces.
    pub count: usize,
    /// Whether only a few results per worker are kept at once, instead of all of them.
    pub is_bounded: bool,
    /// Whether nothing follows that other ranks need to do.
    pub is_last: bool,
    /// Returns the input of a piece; called on the first rank only.
    pub input: &'a (dyn Fn(usize) -> Result<Vec<u8>> + Sync),
    /// Executes a piece with its input, on any thread of any rank.
    pub work: &'a Work<'a>,
    /// Receives each result on the first rank.
    pub take: &'a mut dyn FnMut(usize, Vec<u8>) -> Result<()>,
}

/// Executes everything on the calling thread.
pub struct Serial;

impl Executor for Serial {
    fn execute(&self, batch: Batch<'_>) -> Result<()> {
        (0..batch.count).try_for_each(|index| {
            let result = (batch.work)(index, &(batch.input)(index)?)?;
            (batch.take)(index, result)
        })
    }

    fn once(&self, work: &mut dyn FnMut() -> Result<Vec<u8>>) -> Result<Vec<u8>> {
        work()
    }

    fn is_first(&self) -> bool {
        true
    }
}

/// Returns the results of `count` pieces in order, on every rank.
///
/// # Errors
/// The first error of a piece.
pub fn map<T: Serialize + DeserializeOwned>(
    executor: &dyn Executor,
    count: usize,
    work: impl Fn(usize) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    map_watched(executor, count, work, |_, _| {})
}

/// The same as [`map`]; `watch` receives each result with its index on the first rank, in order.
///
/// # Errors
/// The first error of a piece.
pub fn map_watched<T: Serialize + DeserializeOwned>(
    executor: &dyn Executor,
    count: usize,
    work: impl Fn(usize) -> Result<T> + Sync,
    mut watch: impl FnMut(usize, &T),
) -> Result<Vec<T>> {
    let mut results = Vec::with_capacity(count);
    executor.execute(Batch {
        count,
        is_bounded: false,
        is_last: false,
        input: &|_| Ok(Vec::new()),
        work: &|index, _| encode(&work(index)?),
        take: &mut |index, bytes| {
            let result = decode(&bytes)?;
            watch(index, &result);
            results.push(result);
            Ok(())
        },
    })?;
    once(executor, || Ok(std::mem::take(&mut results)))
}

/// Returns the results of `count` pieces whose inputs only the first rank knows. Other ranks get an empty list.
///
/// # Errors
/// The first error of a piece.
pub fn map_inputs<I: Serialize + DeserializeOwned, T: Serialize + DeserializeOwned>(
    executor: &dyn Executor,
    count: usize,
    input: impl Fn(usize) -> I + Sync,
    work: impl Fn(usize, I) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    let mut results = Vec::with_capacity(count);
    executor.execute(Batch {
        count,
        is_bounded: false,
        is_last: false,
        input: &|index| encode(&input(index)),
        work: &|index, bytes| encode(&work(index, decode(bytes)?)?),
        take: &mut |_, bytes| {
            results.push(decode(&bytes)?);
            Ok(())
        },
    })?;
    Ok(results)
}

/// Hands the result of each piece to `take`, in order, and keeps only a few of them at once. Work of ranks other than the
/// first ends here: they get an error.
///
/// # Errors
/// The first error of a piece or of `take`.
pub fn in_order<T: Serialize + DeserializeOwned>(
    executor: &dyn Executor,
    count: usize,
    work: impl Fn(usize) -> Result<T> + Sync,
    mut take: impl FnMut(usize, T) -> Result<()>,
) -> Result<()> {
    executor.execute(Batch {
        count,
        is_bounded: true,
        is_last: true,
        input: &|_| Ok(Vec::new()),
        work: &|index, _| encode(&work(index)?),
        take: &mut |index, bytes| take(index, decode(&bytes)?),
    })
}

/// Calls `work` on the first rank only, and returns its result on every rank.
///
/// # Errors
/// The error of `work`.
pub fn once<T: Serialize + DeserializeOwned>(executor: &dyn Executor, work: impl FnOnce() -> Result<T>) -> Result<T> {
    let mut work = Some(work);
    let bytes = executor.once(&mut || match work.take() {
        Some(work) => encode(&work()?),
        None => Err(Error::new("work to be done once was asked for twice")),
    })?;
    decode(&bytes)
}

fn encode(value: &impl Serialize) -> Result<Vec<u8>> {
    rmp_serde::to_vec_named(value).map_err(|e| Error::new(format!("cannot be encoded: {e}")))
}

fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T> {
    rmp_serde::from_slice(bytes).map_err(|e| Error::new(format!("cannot be decoded: {e}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_keep_every_bit() {
        let values = [0.1, -0.0, f64::MIN_POSITIVE, f64::INFINITY, 1.0 / 3.0];
        let same = map(&Serial, values.len(), |index| Ok(values[index])).unwrap();
        assert_eq!(same.map_bits(), values.to_vec().map_bits());
        let inputs = map_inputs(&Serial, values.len(), |index| values[index], |_, value: f64| Ok(value)).unwrap();
        assert_eq!(inputs.map_bits(), values.to_vec().map_bits());
    }

    #[test]
    fn the_first_error_ends_the_batch() {
        let fails = |index: usize| if index == 3 { Err(Error::new("the third")) } else { Ok(index) };
        assert_eq!(map(&Serial, 10, fails).unwrap_err().to_string(), "the third");
        let mut taken = Vec::new();
        let full = in_order(&Serial, 10, Ok, |index, value: usize| {
            taken.push(value);
            if index == 2 { Err(Error::new("full")) } else { Ok(()) }
        });
        assert_eq!((full.unwrap_err().to_string(), taken), ("full".into(), vec![0, 1, 2]));
    }

    trait Bits {
        fn map_bits(self) -> Vec<u64>;
    }

    impl Bits for Vec<f64> {
        fn map_bits(self) -> Vec<u64> {
            self.into_iter().map(f64::to_bits).collect()
        }
    }
}
