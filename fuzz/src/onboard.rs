//! Code that runs on a robot: programs for a brick, and the core's controllers.

use std::array;

use mindgap_controller_export::brick::{self, Program, RunConfig, ScriptedWorld, Sonar};
use mindgap_core::controller::{Controller, FULL_SPEED, Machine, Status, TUPLES, Tuple, When};

use crate::Target;

pub const TARGETS: &[Target] =
    &[Target { name: "executable", feed: executable }, Target { name: "machine", feed: machine }];

/// Loads a program for a brick and runs it.
fn executable(bytes: &[u8]) {
    let Ok(program) = Program::load(bytes) else { return };
    let mut world = ScriptedWorld::sonar([Sonar::Echo(40), Sonar::Silent, Sonar::Hangs, Sonar::Echo(9)]);
    brick::run(&program, &mut world, &RunConfig { run_ms: 500, limit_events: 1_000, ..RunConfig::default() });
}

/// Runs any controller, valid or not, on any readings: it advances one tuple at a time, within its steps and the motors'
/// range.
fn machine(bytes: &[u8]) {
    const HEAD: usize = 2 + 5 * TUPLES;
    let Some((head, readings)) = bytes.split_first_chunk::<HEAD>() else { return };
    let tuple = |index: usize| {
        let [left, right, when, low, high] = array::from_fn(|i| head[2 + 5 * index + i]);
        Tuple {
            left: left.cast_signed(),
            right: right.cast_signed(),
            when: if when.is_multiple_of(2) { When::Larger } else { When::Smaller },
            threshold_cm: i16::from_le_bytes([low, high]),
        }
    };
    let max_steps = u16::from_le_bytes([head[0], head[1]]);
    let controller = Controller { step_ms: 400, max_steps, tuples: array::from_fn(tuple) };
    let _ = controller.check();
    let mut machine = Machine::start(&controller);
    for reading in readings.as_chunks::<4>().0 {
        let (tuple_before, steps_before) = (machine.tuple(), machine.steps());
        let value = f32::from_le_bytes(*reading);
        let status = match reading[0] % 4 {
            0 => machine.step::<f32>(None),
            1 => {
                machine.hold(u16::from(reading[1]));
                machine.status()
            }
            _ => machine.step(Some(value)),
        };
        let motors = machine.motors();
        assert!(machine.tuple() - tuple_before <= 1 && machine.tuple() <= TUPLES && machine.steps() >= steps_before);
        assert!(machine.steps() <= max_steps.max(1), "{} of {max_steps} steps", machine.steps());
        assert!([motors.left, motors.right].iter().all(|speed| speed.unsigned_abs() <= FULL_SPEED.unsigned_abs()));
        assert!(status == Status::Running || [motors.left, motors.right] == [0, 0]);
    }
}
