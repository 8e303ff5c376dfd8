//! Every target of fuzzing takes the inputs that are kept for it, and others made of them.

use std::env;
use std::fs;
use std::time::Instant;

use mindgap_host_sim::chance::generator;
use mindgap_tests::fuzzing::mutation::mutated;
use mindgap_tests::fuzzing::{Target, corpus, targets};
use rayon::prelude::*;

/// Inputs a target that are made of those that are kept; the environment's `MINDGAP_INPUTS` states another number.
const MADE: u64 = 1_000;
/// None may take longer, s.
const MOST_S: f64 = 1.0;

#[test]
fn nothing_that_is_read_panics() {
    let stated = env::var("MINDGAP_INPUTS").ok();
    let made = stated.as_ref().map_or(MADE, |stated| stated.parse().expect("a whole number"));
    let targets: Vec<&Target> = targets().collect();
    targets.par_iter().for_each(|target| {
        let listing = fs::read_dir(corpus(target)).unwrap_or_else(|e| panic!("corpus of {}: {e}", target.name));
        let mut paths: Vec<_> = listing.map(|entry| entry.expect("an entry").path()).collect();
        paths.sort();
        let kept: Vec<Vec<u8>> = paths.iter().map(|path| fs::read(path).expect("an input")).collect();
        assert!(!kept.is_empty(), "{} has a corpus", target.name);
        kept.iter().for_each(|input| (target.feed)(input));
        let mut slowest_s = 0f64;
        for number in 0..made {
            let input = mutated(&kept, &mut generator(number, &[]));
            let begun = Instant::now();
            (target.feed)(&input);
            slowest_s = slowest_s.max(begun.elapsed().as_secs_f64());
        }
        println!("{}: {} and {made} inputs, the slowest took {slowest_s:.3} s", target.name, kept.len());
        // A machine that is busy with other tests may take longer over few.
        assert!(stated.is_none() || slowest_s < MOST_S, "{}", target.name);
    });
}
