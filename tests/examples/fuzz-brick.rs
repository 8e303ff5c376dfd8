//! Feeds the NXT emulator with damaged programs: those of `tests/conformance` and exported controllers, with bytes changed,
//! removed and copied. Nothing may panic, hang or use unbounded memory.
//!
//! `cargo run --release -p mindgap-tests --example fuzz-brick -- [MILLIONS] [SEED]` runs until the given number of millions of
//! instructions have been executed.

use std::time::Instant;

use mindgap_controller_export::brick::{self, Press, Program, RunConfig, ScriptedWorld, Sonar, Termination};
use mindgap_controller_export::onboard::Safety;
use mindgap_controller_export::rxe;
use mindgap_controller_export::wiring::Wiring;
use mindgap_foundations::random::{Generator, generator};
use mindgap_tests::command::workspace;
use mindgap_tests::controllers::at_its_limits;
use mindgap_tests::nbc::compile;
use rand::RngExt;

/// Duration of a run on the brick's clock.
const RUN_MS: u32 = 2_000;

fn main() {
    let mut numbers = std::env::args().skip(1).map(|word| word.parse::<u64>().expect("a number"));
    let total = numbers.next().unwrap_or(100) * 1_000_000;
    let seed = numbers.next().unwrap_or(1);
    let seeds = seeds();
    let (mut programs, mut loaded, mut instructions) = (0u64, 0u64, 0u64);
    let (mut failed, mut slowest_ms) = (0u64, 0);
    while instructions < total {
        let mut rng = generator(seed, &[programs]);
        let mut file = seeds[rng.random_range(0..seeds.len())].clone();
        mutate(&mut file, &mut rng);
        programs += 1;
        let Ok(program) = Program::load(&file) else { continue };
        loaded += 1;
        let mut world = ScriptedWorld {
            presses: vec![Press::orange(rng.random_range(0..RUN_MS), RUN_MS)],
            ..ScriptedWorld::sonar([Sonar::Echo(rng.random()), Sonar::Silent, Sonar::Hangs, Sonar::Echo(9)])
        };
        let start = Instant::now();
        let config = RunConfig { run_ms: RUN_MS, limit_events: 1_000, ..RunConfig::default() };
        let report = brick::run(&program, &mut world, &config);
        slowest_ms = slowest_ms.max(start.elapsed().as_millis());
        instructions += report.instructions;
        failed += u64::from(matches!(report.end, Termination::Failed(_)));
    }
    println!(
        "{programs} programs, {loaded} of them loaded, {instructions} instructions, {failed} ended by the firmware, the \
         slowest took {slowest_ms} ms for {RUN_MS} ms on the brick"
    );
}

/// Returns the programs to be damaged.
fn seeds() -> Vec<Vec<u8>> {
    let folder = std::fs::read_dir(workspace().join("tests/conformance")).expect("the folder");
    let mut sources: Vec<_> = folder.map(|entry| entry.expect("a file").path()).collect();
    sources.retain(|path| path.extension().is_some_and(|ending| ending == "nxc"));
    sources.sort();
    let compiled = sources.iter().map(|path| compile(&std::fs::read_to_string(path).expect("a program")));
    let careful = Safety { stop_cm: Some(15), stall: true };
    let written = [Safety::default(), careful]
        .map(|safety| rxe::program(&at_its_limits(), &Wiring::default(), safety).expect("a valid controller"));
    compiled.chain(written).collect()
}

fn mutate(file: &mut Vec<u8>, rng: &mut Generator) {
    for _ in 0..rng.random_range(1..12) {
        let at = rng.random_range(0..file.len());
        match rng.random_range(0..10) {
            0 => file[at] = file[at].wrapping_add(1),
            1 => file[at] ^= 1 << rng.random_range(0..8),
            2 => file[at] = 0xFF,
            3 if at + 2 < file.len() => {
                let word = [0u16, 1, 0x7FFF, 0x8000, 0xFFFE, 0xFFFF][rng.random_range(0..6)];
                file[at..at + 2].copy_from_slice(&word.to_le_bytes());
            }
            4 if at + 2 < file.len() => {
                let from = rng.random_range(0..file.len() - 1);
                file.copy_within(from..from + 2, at);
            }
            5 if file.len() > 60 => {
                file.remove(at);
            }
            _ => file[at] = rng.random(),
        }
    }
}
