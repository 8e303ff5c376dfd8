//! A controller as an .rxe program, without a compiler: one clump of bytecode for standard firmware 1.28 and later.
//!
//! `rxe/layout.rs` lays out the dataspace and `rxe/assembler.rs` encodes instructions. `rxe/clock.rs`, `rxe/sonar.rs`,
//! `rxe/motors.rs` and `rxe/endings.rs` generate the parts of a program, and this module generates the controller's loop.
//!
//! The program behaves like the [NXC program](crate::nxc) without log and display, in less than half the size.

mod assembler;
mod clock;
mod endings;
mod layout;
mod motors;
mod sonar;

use mindgap_core::controller::{Controller, TUPLES, When};

use assembler::Assembler;
use clock::Clock;
use endings::Endings;
use motors::{Motors, Stall};
use sonar::Sonar;

use crate::budget::{Budget, Cost};
use crate::bytecode::{Comparison, Type};
use crate::error::ExportError;
use crate::onboard::{self, Ending, Safety};
use crate::wiring::Wiring;

/// Measured cost of the program, which is the same for every controller, and of the additional reasons to stop.
const COST: Cost = Cost { program_bytes: 1_750, memory_bytes: 690, step_instructions: 150 };
const WITH_NEAR: Cost = Cost { program_bytes: 70, memory_bytes: 50, step_instructions: 1 };
const WITH_STALL: Cost = Cost { program_bytes: 250, memory_bytes: 75, step_instructions: 18 };

/// Returns the controller as the bytes of an .rxe file.
///
/// # Errors
/// Returns an [`ExportError`] when the brick cannot run the program.
///
/// ```
/// use mindgap_controller_export::onboard::Safety;
/// use mindgap_controller_export::rxe;
/// use mindgap_controller_export::wiring::Wiring;
/// use mindgap_core::controller::{Controller, Tuple, When};
///
/// let ahead = Tuple { left: 55, right: 48, when: When::Smaller, threshold_cm: 42 };
/// let controller = Controller { step_ms: 400, max_steps: 150, tuples: [ahead; 6] };
/// let file = rxe::program(&controller, &Wiring::default(), Safety::default())?;
/// assert!(file.starts_with(b"MindstormsNXT") && file.len() <= 1_750);
/// # Ok::<(), mindgap_controller_export::ExportError>(())
/// ```
pub fn program(controller: &Controller, wiring: &Wiring, safety: Safety) -> Result<Vec<u8>, ExportError> {
    controller.check()?;
    wiring.check()?;
    budget(controller, safety).check()?;
    let mut asm = Assembler::default();
    // Large values come first, which minimises padding.
    let next_ms = asm.number(Type::U32, 0);
    let step_ms = asm.number(Type::U16, controller.step_ms.into());
    let max_steps = asm.number(Type::U16, controller.max_steps.into());
    let steps = asm.number(Type::U16, 0);
    let tuple = asm.number(Type::U8, 0);
    let tuples = asm.number(Type::U8, TUPLES as i32);
    let one = asm.number(Type::U8, 1);
    let failed_steps = asm.number(Type::U8, 0);
    let max_failed_steps = asm.number(Type::U8, onboard::FAILED_STEPS_TO_STOP.into());
    let no_echo = asm.number(Type::U8, onboard::NO_ECHO_CM.into());
    let threshold_cm = asm.number(Type::U8, 0);
    let when_larger = asm.number(Type::U8, 0);
    let ends = asm.number(Type::U8, 0);
    let near = safety.stop_cm.map(|stop_cm| asm.number(Type::U8, stop_cm.into()));
    let motors = Motors::declare(&mut asm, controller, wiring);
    let thresholds_cm = asm.array(Type::U8, controller.tuples.iter().map(|tuple| tuple.threshold_cm.into()));
    let larger_flags = asm.array(Type::U8, controller.tuples.iter().map(|t| i32::from(t.when == When::Larger)));
    let stall = safety.stall.then(|| Stall::declare(&mut asm, controller.step_ms));
    let clock = Clock::declare(&mut asm);
    let sonar = Sonar::declare(&mut asm, wiring, one);
    let endings = Endings::declare(&mut asm, &endings(safety));
    let [failed, decide, larger, next_tuple, check, halt, announce] = std::array::from_fn(|_| asm.label());
    let stopped = endings.label(Ending::Stopped);

    clock.await_release(&mut asm);
    sonar.find(&mut asm, &clock, endings.label(Ending::NoSonar), stopped);
    asm.tick(next_ms);

    let set_motors = asm.here();
    motors.set(&mut asm, tuple);

    let step = asm.here();
    asm.add(next_ms, next_ms, step_ms);
    clock.wait_until(&mut asm, next_ms, stopped);
    sonar.ask(&mut asm, &clock, failed, stopped);
    asm.set(failed_steps, 0);
    asm.jump(decide);
    asm.bind(failed);
    asm.mov(sonar.reading_cm, no_echo);
    asm.add(failed_steps, failed_steps, one);

    asm.bind(decide);
    asm.add(steps, steps, one);
    if let Some(stall) = &stall {
        stall.count(&mut asm, &motors, tuple, one);
    }
    asm.set(ends, 0);
    asm.branch_if(sonar.reading_cm, Comparison::Equal, no_echo, check);
    asm.index(threshold_cm, thresholds_cm, tuple);
    asm.index(when_larger, larger_flags, tuple);
    asm.branch_if_zero(when_larger, Comparison::NotEqual, larger);
    asm.branch_if(sonar.reading_cm, Comparison::Less, threshold_cm, next_tuple);
    asm.jump(check);
    asm.bind(larger);
    asm.branch_if(sonar.reading_cm, Comparison::LessOrEqual, threshold_cm, check);
    asm.bind(next_tuple);
    asm.set(ends, 1);
    asm.add(tuple, tuple, one);
    asm.branch_if(tuple, Comparison::Equal, tuples, endings.label(Ending::Finished));

    asm.bind(check);
    if let Some(stop_cm) = near {
        asm.branch_if(sonar.reading_cm, Comparison::Less, stop_cm, endings.label(Ending::Near));
    }
    if let Some(stall) = &stall {
        stall.check(&mut asm, endings.label(Ending::Stalled));
    }
    asm.branch_if(failed_steps, Comparison::Equal, max_failed_steps, endings.label(Ending::SonarDead));
    asm.branch_if(steps, Comparison::Equal, max_steps, endings.label(Ending::TimedOut));
    asm.branch_if_zero(ends, Comparison::NotEqual, set_motors);
    asm.jump(step);

    endings.prepare(&mut asm, halt, announce);
    asm.bind(halt);
    motors.stop(&mut asm);
    asm.bind(announce);
    endings.announce(&mut asm);
    Ok(asm.into_file())
}

/// Returns the resources of the program.
pub fn budget(controller: &Controller, safety: Safety) -> Budget {
    let parts = [(safety.stop_cm.is_some(), WITH_NEAR), (safety.stall, WITH_STALL)];
    let cost = parts.iter().filter(|(wanted, _)| *wanted).fold(COST, |sum, (_, cost)| sum.plus(*cost));
    Budget::new(cost, controller.step_ms, None)
}

/// Returns the endings of a program with these additional reasons to stop.
fn endings(safety: Safety) -> Vec<Ending> {
    let always = [Ending::Finished, Ending::TimedOut, Ending::SonarDead, Ending::NoSonar, Ending::Stopped];
    let near = safety.stop_cm.map(|_| Ending::Near);
    let stalled = safety.stall.then_some(Ending::Stalled);
    always.into_iter().chain(near).chain(stalled).collect()
}
