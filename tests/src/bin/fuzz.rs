//! Feeds every target with inputs that it has not had before: `fuzz SECONDS COUNTS [TARGET]`, so many seconds for each
//! target, or for one alone.
//!
//! The file of counts, `name count slowest_ms slowest_number` a line, says how many inputs each has had, and which of them
//! took longest; it is read if it is there, and written again after each target. Nothing may panic, take longer than a
//! second, or take too much memory.

use std::collections::BTreeMap;
use std::env;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use mindgap_tests::fuzzing::feeding::{Feeding, most_memory_kb};
use mindgap_tests::fuzzing::{MOST_KB, Target, targets};

/// No input may take longer.
const MOST: Duration = Duration::from_secs(1);
/// Inputs between two looks at the clock.
const ROUND: u64 = 100;

fn main() {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let (seconds, path, chosen) = match arguments.as_slice() {
        [seconds, path] => (seconds, path, None),
        [seconds, path, target] => (seconds, path, Some(target)),
        _ => panic!("fuzz SECONDS COUNTS [TARGET]"),
    };
    let enough = Duration::from_secs_f64(seconds.parse().expect("a number of seconds"));
    let path = Path::new(path);
    let mut counts = read(path);
    for target in targets().filter(|target| chosen.is_none_or(|chosen| chosen == target.name)) {
        let (count, most) = counts.entry(target.name.into()).or_default();
        let (fed, (slowest, number)) = feed(target, *count, enough);
        (*count, *most) = (*count + fed, (*most).max((slowest.as_millis(), number)));
        println!("{}: {fed} inputs, the slowest, number {number}, took {slowest:.1?}", target.name);
        assert!(slowest < MOST, "{} took {slowest:.1?} for an input", target.name);
        write(path, &counts);
    }
    let all: u64 = counts.values().map(|count| count.0).sum();
    println!("{all} inputs in all");
    if let Some(most_kb) = most_memory_kb() {
        println!("at most {most_kb} kB");
        assert!(most_kb < MOST_KB, "{most_kb} kB");
    }
}

/// How many inputs a target took, from the first of them on, and how long the slowest, with its number.
fn feed(target: &'static Target, first: u64, enough: Duration) -> (u64, (Duration, u64)) {
    let mut feeding = Feeding::of(target);
    let begun = Instant::now();
    let mut next = first;
    while begun.elapsed() < enough {
        feeding.feed(next..next + ROUND);
        next += ROUND;
    }
    (next - first, feeding.slowest)
}

/// Inputs, and the slowest of them in ms with its number, by target.
type Counts = BTreeMap<String, (u64, (u128, u64))>;

fn read(path: &Path) -> Counts {
    let text = fs::read_to_string(path).unwrap_or_default();
    let count = |line: &str| {
        let mut words = line.split(' ');
        let name = words.next()?.to_owned();
        let mut number = || words.next()?.parse::<u64>().ok();
        Some((name, (number()?, (number()?.into(), number()?))))
    };
    text.lines().map(|line| count(line).expect("a line of counts")).collect()
}

fn write(path: &Path, counts: &Counts) {
    let line =
        |(name, (count, (ms, number))): (&String, &(u64, (u128, u64)))| format!("{name} {count} {ms} {number}\n");
    let part = path.with_extension("part");
    fs::write(&part, counts.iter().map(line).collect::<String>()).expect("counts are written");
    fs::rename(part, path).expect("counts are put in place");
}
