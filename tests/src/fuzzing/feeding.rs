//! Feeding a target: the inputs that are kept for it, and others made of them, each by its number.

use std::fs;
use std::ops::Range;
use std::time::{Duration, Instant};

use mindgap_host_sim::chance::generator;

use super::mutation::mutated;
use super::{Target, corpus};

/// A target with what is fed to it.
pub struct Feeding {
    target: &'static Target,
    kept: Vec<Vec<u8>>,
    /// How long the slowest input took, and its number.
    pub slowest: (Duration, u64),
}

/// Says which input it was when feeding it panics.
struct Told(&'static str, u64);

impl Feeding {
    /// Feeds a target with the inputs that are kept for it.
    ///
    /// # Panics
    /// When there are none, or one is not taken as it should be.
    pub fn of(target: &'static Target) -> Self {
        let listing = fs::read_dir(corpus(target)).unwrap_or_else(|e| panic!("corpus of {}: {e}", target.name));
        let mut paths: Vec<_> = listing.map(|entry| entry.expect("an entry").path()).collect();
        paths.sort();
        let kept: Vec<Vec<u8>> = paths.iter().map(|path| fs::read(path).expect("an input")).collect();
        assert!(!kept.is_empty(), "{} has a corpus", target.name);
        kept.iter().for_each(|input| (target.feed)(input));
        Feeding { target, kept, slowest: (Duration::ZERO, 0) }
    }

    /// Feeds it with the inputs of these numbers, made of those that are kept.
    ///
    /// # Panics
    /// When one is not taken as it should be.
    pub fn feed(&mut self, numbers: Range<u64>) {
        for number in numbers {
            let input = mutated(&self.kept, &mut generator(number, &[]));
            let told = Told(self.target.name, number);
            let took = self.took(&input);
            // On a busy machine a quick input may be slow once.
            let took = if took > self.slowest.0 { took.min(self.took(&input)) } else { took };
            self.slowest = self.slowest.max((took, number));
            std::mem::forget(told);
        }
    }

    fn took(&self, input: &[u8]) -> Duration {
        let begun = Instant::now();
        (self.target.feed)(input);
        begun.elapsed()
    }
}

impl Drop for Told {
    fn drop(&mut self) {
        eprintln!("it was input {} of {}", self.1, self.0);
    }
}

/// The most memory that this process has had, kB, where the system says so.
pub fn most_memory_kb() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.trim().strip_suffix(" kB")?.parse().ok()
}
