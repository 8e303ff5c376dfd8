//! An NXC program that makes the data a simulator is learned from: random commands, each held for a few steps, with the
//! ultrasonic sensor's readings, wheel rotations and battery voltage logged on the brick (paper, section VI).
//!
//! Every start of the program adds a run, `run-000.csv` and so on, with commands of its own. The robot turns away from
//! what it sees near, backs up only over ground that it has just left, and stops when the sensor is dead or somebody
//! holds the orange button; still, somebody should stand by. The camera's poses are added on the host.

use crate::budget::{Budget, Cost};
use crate::error::ExportError;
use crate::names::BrickName;
use crate::nxc::source::{Constants, LOG, MOTORS, SONAR, TIME};
use crate::wiring::Wiring;

const DRIVE: &str = include_str!("collect/drive.nxc");
const MAIN: &str = include_str!("collect/main.nxc");

/// What nbc makes of the program.
const COST: Cost = Cost { program_bytes: 6_900, memory_bytes: 5_200, step_instructions: 1_250 };
/// Steps in a row without an echo after which the robot looks for one.
const MOST_UNSEEN_STEPS: u16 = 2;
/// How much farther the way ahead has to be free after a turn.
const PAST_CORNER_CM: u16 = 20;
/// Power of the last step of a turn away from something.
const PAST_CORNER_POWER: u16 = 15;
/// Seeds that leave room for a thousand runs within the generator's 31 bits.
const SEEDS: u32 = 1_000_000_000;

/// What a run of collecting data is like.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CollectOptions {
    /// The compiled program's name on the brick.
    pub program: BrickName,
    /// What is plugged in where.
    pub wiring: Wiring,
    /// Time between two rows of the log; it has to be the controllers' step.
    pub step_ms: u16,
    /// Steps of a run.
    pub steps: u16,
    /// Something nearer than this, 1..=254 cm, makes the robot turn away.
    pub near_cm: u8,
    /// Where the random commands start from.
    pub seed: u32,
}

/// The program as NXC.
///
/// # Errors
/// What the brick cannot run or store: see [`ExportError`].
pub fn program(options: &CollectOptions) -> Result<String, ExportError> {
    let CollectOptions { program, wiring, step_ms, steps, near_cm, seed } = options;
    let out_of_range = |name, value, range| Err(ExportError::OutOfRange { name, value, range });
    if *steps == 0 {
        return out_of_range("steps", 0, "1..65535");
    }
    if !(1..=254).contains(near_cm) {
        return out_of_range("near_cm", u32::from(*near_cm), "1..254");
    }
    wiring.check()?;
    let budget = budget(options);
    budget.check()?;
    let stem = program.stem();
    let head = format!(
        "// Random commands for the LEGO NXT with standard firmware, to learn a simulator from. Compile and load it with\n\
         //   nbc -v=128 -O={program} {stem}.nxc\n\
         //   nbc -S=usb -b -d {program}\n\
         //\n\
         // Every start of the program adds a run of {steps} steps of {step_ms} ms, run-000.csv and so on. Hold the orange button\n\
         // to end a run early.\n"
    );
    let constants = Constants::shared(wiring)
        .with("STEP_MS", step_ms, "")
        .with("STEPS", steps, "")
        .with("NEAR_CM", near_cm, "nearer things make it turn away")
        .with("MOST_UNSEEN_STEPS", MOST_UNSEEN_STEPS, "then it looks for an echo")
        .with("PAST_CORNER_CM", PAST_CORNER_CM, "more has to be free after a turn")
        .with("PAST_CORNER_POWER", PAST_CORNER_POWER, "of the turn's last step")
        .with("SEED", seed % SEEDS + 1, "of the commands")
        .with("LOG_BYTES", budget.log_bytes, "of one run");
    let parts = [&head, &constants.into_text(), TIME, SONAR, MOTORS, LOG, DRIVE, MAIN];
    Ok(parts.join("\n"))
}

/// What the program and one run's log take of the brick once it is compiled.
pub fn budget(options: &CollectOptions) -> Budget {
    Budget::new(COST, options.step_ms, Some(options.steps))
}
