//! How well the hand-out keeps a cluster busy, for docs/clusters.md: diagnoses cases of a challenge one by one on one
//! thread, and simulates what a thousand ranks make of a hundred thousand whose times are drawn from theirs:
//! `RAYON_NUM_THREADS=1 cargo run --release -p mindgap-tests --bin handing-out -- [CASES [RANKS [OF]]]`.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use mindgap_host_sim::challenge::answer::learn;
use mindgap_host_sim::challenge::cases::{self, Echoes, Outside};
use mindgap_host_sim::chance::{Generator, generator};
use mindgap_host_sim::error::Result;
use mindgap_host_sim::gap::{Method, findings};
use mindgap_host_sim::inspection::Inspection;
use mindgap_host_sim::simulator::baseline::Baseline;
use rand::seq::IndexedRandom;

const SEED: u64 = 1;
/// From when a piece is done until the first rank looks for messages, and from when it sends the next one until the rank
/// does: twice the time between two looks, and the network.
const ON_THE_WAY: Duration = Duration::from_micros(200);
/// What the first rank does about one piece: it reads the message, keeps the piece, and sends the next.
const SERVED_IN: Duration = Duration::from_micros(100);

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1).map(|argument| argument.parse().unwrap_or(1));
    let mut next = |usual: usize| arguments.next().unwrap_or(usual).max(1);
    let (cases, ranks, of) = (next(24), next(1000), next(100_000));
    match measured(cases) {
        Ok(times) => {
            told(&times, ranks, of);
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// How long each of so many cases takes, to make and to diagnose.
fn measured(count: usize) -> Result<Vec<Duration>> {
    let robots = cases::robots(SEED, Echoes::Fresh)?;
    let simulators = robots.iter().map(learn).collect::<Result<Vec<_>>>()?;
    let effects = cases::effects(count, SEED, Outside::Usual);
    let time = |number: usize| {
        let began = Instant::now();
        let case = cases::case(number, &effects[number], &robots, Echoes::Fresh, SEED)?;
        findings(Baseline::learned(&simulators[case.robot])?, &Inspection::of(case.logs), Method::default())?;
        Ok(began.elapsed())
    };
    (0..count).map(time).collect()
}

fn told(times: &[Duration], ranks: usize, of: usize) {
    let mut sorted = times.to_vec();
    sorted.sort();
    let [least, middle, most] = [0, sorted.len() / 2, sorted.len() - 1].map(|place| sorted[place].as_secs_f64());
    println!("{} cases on one thread: {least:.1} s to {most:.1} s, median {middle:.1} s", times.len());
    let rng = &mut generator(SEED, &[]);
    let (took, worked) = handed_out(times, ranks, of, rng);
    let efficiency = worked.as_secs_f64() / (took.as_secs_f64() * ranks as f64);
    println!("{of} cases on {ranks} ranks: {:.0} s, {:.1} % of it at work", took.as_secs_f64(), 100.0 * efficiency);
}

/// How long it takes until all pieces are done, and how long they take together.
fn handed_out(times: &[Duration], ranks: usize, pieces: usize, rng: &mut Generator) -> (Duration, Duration) {
    // When the next message of each rank reaches the first one.
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
