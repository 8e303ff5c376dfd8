//! Every target accepts the inputs of its corpus, and others derived from them.

use std::collections::BTreeSet;
use std::fs;

use mindgap_fuzz::{Target, targets};
use mindgap_tests::command::workspace;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use proptest::test_runner::{RngSeed, TestRunner};

/// Number of inputs per target that are derived from its corpus.
const DERIVED: u32 = 1_000;
/// Bytes that are special to readers.
const PIECES: [&str; 10] = ["\n", ",", "[", "\"", "=", "-", "1e308", "nan", "[[x]]\n", "18446744073709551616"];

#[test]
fn every_target_has_a_corpus() {
    let folders = fs::read_dir(workspace().join("fuzz/corpus")).expect("the corpora");
    let folders = folders.map(|entry| entry.expect("a folder").file_name().into_string().expect("a name in UTF-8"));
    let names = targets().map(|target| target.name.to_owned());
    assert_eq!(folders.collect::<BTreeSet<_>>(), names.collect(), "left: corpora, right: targets");
}

#[test]
fn no_target_panics() {
    for target in targets() {
        let kept = corpus(target);
        assert!(!kept.is_empty(), "{}", target.name);
        kept.iter().for_each(|input| (target.feed)(input));
        let config = ProptestConfig {
            cases: DERIVED,
            rng_seed: RngSeed::Fixed(1),
            failure_persistence: None,
            ..ProptestConfig::default()
        };
        let outcome = TestRunner::new(config).run(&derived_from(kept), |input| {
            (target.feed)(&input);
            Ok(())
        });
        outcome.unwrap_or_else(|e| panic!("{}: {e}", target.name));
    }
}

fn corpus(target: &Target) -> Vec<Vec<u8>> {
    let listing = fs::read_dir(workspace().join("fuzz/corpus").join(target.name)).expect("a corpus");
    let mut paths: Vec<_> = listing.map(|entry| entry.expect("an input").path()).collect();
    paths.sort();
    paths.iter().map(|path| fs::read(path).expect("an input")).collect()
}

/// Derives inputs in which some bytes are replaced by random ones, by a special piece, or by a part of another input.
fn derived_from(kept: Vec<Vec<u8>>) -> impl Strategy<Value = Vec<u8>> {
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
