//! How fast the emulated brick is: `cargo bench -p mindgap-controller-export`.

use divan::Bencher;
use divan::counter::ItemsCount;
use mindgap_controller_export::brick::{self, Program, RunConfig, ScriptedWorld, Sonar, Termination};
use mindgap_controller_export::onboard::Safety;
use mindgap_controller_export::rxe;
use mindgap_controller_export::wiring::Wiring;
use mindgap_core::controller::{Controller, Tuple, When};

fn main() {
    divan::main();
}

/// A loop with a sum, an array access and a branch. The counter is the number of bytecode instructions.
#[divan::bench]
fn busy_loop(bencher: Bencher) {
    let program = Program::load(&loop_program()).expect("a valid program");
    let setup = RunConfig { run_ms: 1_000, instructions_per_ms: 1_000, ..RunConfig::default() };
    let instructions = brick::run(&program, &mut ScriptedWorld::default(), &setup).instructions;
    bencher.counter(ItemsCount::new(instructions)).bench(|| {
        let report = brick::run(&program, &mut ScriptedWorld::default(), &setup);
        assert_eq!((report.end, report.instructions), (Termination::OutOfTime, instructions));
    });
}

/// A full run of a controller, 150 steps of 400 ms. The counter is the number of runs.
#[divan::bench]
fn controller_run(bencher: Bencher) {
    let ahead = Tuple { left: 55, right: 48, when: When::Smaller, threshold_cm: 0 };
    let controller = Controller { step_ms: 400, max_steps: 150, tuples: [ahead; 6] };
    let file = rxe::program(&controller, &Wiring::default(), Safety::default()).expect("a valid controller");
    let program = Program::load(&file).expect("a valid program");
    bencher.counter(ItemsCount::new(1u32)).bench(|| {
        let mut world = ScriptedWorld::sonar([Sonar::Echo(100); 150]);
        let report = brick::run(&program, &mut world, &RunConfig::default());
        assert_eq!((report.end, world.requests), (Termination::Finished, 150));
    });
}

/// sum += step; value = table[at]; sum > value, for ever.
fn loop_program() -> Vec<u8> {
    let table: [[u8; 4]; 6] = [
        [6, 1, 0, 0],  // 0: sum, i32
        [6, 0, 4, 0],  // 1: step, i32
        [6, 1, 8, 0],  // 2: value, i32
        [1, 1, 12, 0], // 3: at, u8
        [7, 0, 14, 0], // 4: table, array
        [1, 0, 0, 0],  // 5: its elements, u8
    ];
    // The step and the dope vector of the array; the array; its list, in which the array comes before the table.
    let defaults: [u16; 15] = [3, 0, 1, 0x0907, 0xFFFF, 20, 10, 2, 0xFFFF, 0xFFFF, 16, 1, 2, 14, 0];
    let code: [u16; 14] = [
        0x8000, 0, 0, 1, // add sum, sum, step
        0x8015, 2, 4, 3, // index value, table, at
        0x8126, 0xFFF8, 0, 2, // brcmp >, back to the start, sum, value
        0x4025, 0xFFF4, // jmp back to the start
    ];
    let header = [6, 40, 16, 30, 6, 24, 1, 0, 20, 1, code.len() as u16];
    let mut file = b"MindstormsNXT\0\0\x06".to_vec();
    file.extend(header.iter().flat_map(|word: &u16| word.to_le_bytes()));
    file.extend(table.concat());
    file.extend(defaults.iter().flat_map(|word| word.to_le_bytes()));
    file.extend([0; 4]);
    file.extend(code.iter().flat_map(|word| word.to_le_bytes()));
    file
}
