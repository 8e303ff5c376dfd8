//! Every target takes the inputs that are kept for it, and others made of them.

use std::collections::BTreeSet;
use std::fs;

use mindgap_fuzz::{Target, targets};
use mindgap_tests::command::workspace;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use proptest::test_runner::{RngSeed, TestRunner};

/// Inputs for each target that are made of those that are kept.
const MADE: u32 = 1_000;
/// What readers look at more closely than at other bytes.
const PIECES: [&str; 10] = ["\n", ",", "[", "\"", "=", "-", "1e308", "nan", "[[x]]\n", "18446744073709551616"];

#[test]
fn every_target_has_inputs_that_are_kept() {
    let folders = fs::read_dir(workspace().join("fuzz/corpus")).expect("the corpora");
    let folders = folders.map(|entry| entry.expect("a folder").file_name().into_string().expect("a name in UTF-8"));
    let names = targets().map(|target| target.name.to_owned());
    assert_eq!(folders.collect::<BTreeSet<_>>(), names.collect(), "left: corpora, right: targets");
}

#[test]
fn none_of_them_panics() {
    for target in targets() {
        let kept = corpus(target);
        assert!(!kept.is_empty(), "{}", target.name);
        kept.iter().for_each(|input| (target.feed)(input));
        let config = ProptestConfig {
            cases: MADE,
            rng_seed: RngSeed::Fixed(1),
            failure_persistence: None,
            ..ProptestConfig::default()
        };
        let taken = TestRunner::new(config).run(&made_of(kept), |input| {
            (target.feed)(&input);
            Ok(())
        });
        taken.unwrap_or_else(|e| panic!("{}: {e}", target.name));
    }
}

fn corpus(target: &Target) -> Vec<Vec<u8>> {
    let listing = fs::read_dir(workspace().join("fuzz/corpus").join(target.name)).expect("a corpus");
    let mut paths: Vec<_> = listing.map(|entry| entry.expect("an input").path()).collect();
    paths.sort();
    paths.iter().map(|path| fs::read(path).expect("an input")).collect()
}

/// Inputs with a few places in which some bytes have been replaced by others, by a piece, or by some of another input.
fn made_of(kept: Vec<Vec<u8>>) -> impl Strategy<Value = Vec<u8>> {
    let some = (select(kept.clone()), any::<Index>(), 0..64_usize).prop_map(|(other, from, count)| {
        let from = from.index(other.len() + 1);
        other.into_iter().skip(from).take(count).collect()
    });
    let put_in =
        prop_oneof![vec(any::<u8>(), 0..4), select(&PIECES[..]).prop_map(|piece| piece.as_bytes().to_vec()), some,];
    let changes = vec((any::<Index>(), 0..8_usize, put_in), 1..6);
    (select(kept), changes).prop_map(|(mut input, changes)| {
        for (at, out, put_in) in changes {
            let from = at.index(input.len() + 1);
            let to = (from + out).min(input.len());
            input.splice(from..to, put_in);
        }
        input
    })
}
