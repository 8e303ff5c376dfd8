//! How busy the hand-out keeps a cluster, for docs/reference/measurements.md: simulates RANKS ranks that work on PIECES
//! pieces of work. Their times are drawn from measured ones, in seconds, one per line on standard input:
//! `cargo run --release -p mindgap-tests --example handing-out -- RANKS PIECES < SECONDS`.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::io;
use std::process::ExitCode;
use std::time::Duration;

use mindgap_foundations::random::{Generator, generator};
use rand::seq::IndexedRandom;

const SEED: u64 = 1;
/// Time from the end of an item until rank 0 sees the message, and from sending the next item until the other rank sees it:
/// the longest polling interval plus the network.
const ON_THE_WAY: Duration = Duration::from_micros(500);
/// Time in which rank 0 reads a message, stores its item and sends the next one.
const SERVED_IN: Duration = Duration::from_micros(100);

fn main() -> ExitCode {
    let numbers: Option<Vec<usize>> = std::env::args().skip(1).map(|argument| argument.parse().ok()).collect();
    let seconds = |line: io::Result<String>| Duration::try_from_secs_f64(line.ok()?.trim().parse().ok()?).ok();
    let times: Option<Vec<Duration>> = io::stdin().lines().map(seconds).collect();
    let (Some([ranks, pieces]), Some(times)) = (numbers.as_deref(), &times) else {
        eprintln!("needs the numbers of ranks and pieces, and seconds on standard input, one a line");
        return ExitCode::FAILURE;
    };
    let (took, worked) = handed_out(times, *ranks, *pieces, &mut generator(SEED, &[]));
    let busy = 100.0 * worked.as_secs_f64() / (took.as_secs_f64() * *ranks as f64);
    println!("{pieces} pieces on {ranks} ranks: {:.0} s, ranks {busy:.1} % busy", took.as_secs_f64());
    ExitCode::SUCCESS
}

/// Returns the time until all items are finished, and the sum of their durations.
fn handed_out(times: &[Duration], ranks: usize, pieces: usize, rng: &mut Generator) -> (Duration, Duration) {
    // Time at which the next message of each rank reaches rank 0.
    let mut asking: BinaryHeap<Reverse<Duration>> = (0..ranks).map(|_| Reverse(ON_THE_WAY)).collect();
    let (mut now, mut worked) = (Duration::ZERO, Duration::ZERO);
    for _ in 0..pieces {
        let Reverse(asked) = asking.pop().unwrap_or_default();
        now = now.max(asked) + SERVED_IN;
        let time = times.choose(rng).copied().unwrap_or_default();
        worked += time;
        asking.push(Reverse(now + ON_THE_WAY + time + ON_THE_WAY));
    }
    let last = asking.into_iter().map(|Reverse(last)| last).max().unwrap_or_default();
    (now.max(last) + SERVED_IN, worked)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_pieces_take_their_turns() {
        let second = Duration::from_secs(1);
        let (took, worked) = handed_out(&[second], 4, 8, &mut generator(1, &[]));
        assert_eq!(worked, 8 * second);
        assert!(took > 2 * second && took < 2 * second + Duration::from_millis(5), "{took:?}");
        let (took, _) = handed_out(&[second], 4, 9, &mut generator(1, &[]));
        assert!(took > 3 * second, "{took:?}");
    }
}
