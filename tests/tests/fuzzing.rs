//! Every target of fuzzing takes the inputs that are kept for it, and others made of them.

use std::env;
use std::fs;
use std::time::Instant;

use mindgap_host_sim::chance::generator;
use mindgap_tests::fuzzing::mutation::mutated;
use mindgap_tests::fuzzing::{Target, corpus, targets};
use rayon::prelude::*;

/// Inputs a target that are made of those that are kept; the environment's `MINDGAP_INPUTS` states another number, and
/// `MINDGAP_FIRST` the first of them where others were fed before.
const MADE: u64 = 1_000;
/// None may take longer, s.
const MOST_S: f64 = 1.0;
/// All of them together may not take more memory, kB.
const MOST_KB: u64 = 256_000;

#[test]
fn nothing_that_is_read_panics() {
    let stated = |name: &str| env::var(name).ok().map(|stated| stated.parse::<u64>().expect("a whole number"));
    let (first, wanted) = (stated("MINDGAP_FIRST").unwrap_or(0), stated("MINDGAP_INPUTS"));
    let made = wanted.unwrap_or(MADE);
    let targets: Vec<&Target> = targets().collect();
    targets.par_iter().for_each(|target| {
        let listing = fs::read_dir(corpus(target)).unwrap_or_else(|e| panic!("corpus of {}: {e}", target.name));
        let mut paths: Vec<_> = listing.map(|entry| entry.expect("an entry").path()).collect();
        paths.sort();
        let kept: Vec<Vec<u8>> = paths.iter().map(|path| fs::read(path).expect("an input")).collect();
        assert!(!kept.is_empty(), "{} has a corpus", target.name);
        kept.iter().for_each(|input| (target.feed)(input));
        let mut slowest_s = 0f64;
        for number in first..first + made {
            let input = mutated(&kept, &mut generator(number, &[]));
            let begun = Instant::now();
            (target.feed)(&input);
            slowest_s = slowest_s.max(begun.elapsed().as_secs_f64());
        }
        println!("{}: {} and {made} inputs, the slowest took {slowest_s:.3} s", target.name, kept.len());
        // A machine that is busy with other tests may take longer over few.
        assert!(wanted.is_none() || slowest_s < MOST_S, "{}", target.name);
    });
    if let Some(most_kb) = most_memory_kb() {
        println!("at most {most_kb} kB");
        assert!(most_kb < MOST_KB, "{most_kb} kB");
    }
}

/// The most memory that this process has had, where the system says so.
fn most_memory_kb() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.trim().strip_suffix(" kB")?.parse().ok()
}
