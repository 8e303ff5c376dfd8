//! Every target of fuzzing takes the inputs that are kept for it, and others made of them.

use mindgap_tests::fuzzing::feeding::{Feeding, most_memory_kb};
use mindgap_tests::fuzzing::{MOST_KB, Target, targets};
use rayon::prelude::*;

/// Inputs for each target that are made of those that are kept.
const MADE: u64 = 1_000;

#[test]
fn nothing_that_is_read_panics() {
    let targets: Vec<&Target> = targets().collect();
    targets.par_iter().for_each(|target| Feeding::of(target).feed(0..MADE));
    if let Some(most_kb) = most_memory_kb() {
        assert!(most_kb < MOST_KB, "{most_kb} kB");
    }
}
