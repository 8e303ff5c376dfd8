//! MicroPython programs for hubs with Pybricks firmware that collect data, as [`collect`](crate::collect) does on an NXT with
//! standard firmware.
//!
//! Hubs have no files, so the program prints a log, row by row. Save the output that arrives at the computer; lines around the
//! rows do not matter. Every start drives the same commands: another run needs another seed.

use mindgap_core::controller::FULL_SPEED;

use crate::collect::{Commands, MAX_UNSEEN_STEPS, PAST_CORNER_CM, PAST_CORNER_POWER, check};
use crate::error::ExportError;
use crate::onboard::FAILED_STEPS_TO_STOP;
use crate::pybricks::{DRIVER, MAIN};

const RANDOM: &str = include_str!("pybricks_collect/random.py");
const SCRIPT: &str = include_str!("pybricks_collect/script.py");
const RUN: &str = include_str!("pybricks_collect/run.py");

/// Number of states of the program's generator.
const SEEDS: u32 = 65_536;

/// Returns the program that drives these commands, each for `step_ms`.
///
/// # Errors
/// Returns an [`ExportError`] when there is no step, too many of them, or an impossible distance.
///
/// ```
/// use mindgap_controller_export::collect::Commands;
/// use mindgap_controller_export::pybricks_collect;
///
/// let source = pybricks_collect::program(400, &Commands::Random { steps: 150, near_cm: 40, seed: 1 })?;
/// assert!(source.contains("NEAR_CM = 40\n"));
/// # Ok::<(), mindgap_controller_export::ExportError>(())
/// ```
pub fn program(step_ms: u16, commands: &Commands) -> Result<String, ExportError> {
    check(commands)?;
    let (purpose, constants, source) = match commands {
        Commands::Random { steps, near_cm, seed } => (
            format!(
                "# Random commands for a hub with Pybricks firmware, to train a simulator. The robot turns away from anything that its\n\
                 # sensor sees nearer than {near_cm} cm; it sees nothing to its sides or behind it.\n"
            ),
            format!(
                "STEPS = {steps}\n\
                 NEAR_CM = {near_cm}\n\
                 MAX_UNSEEN_STEPS = {MAX_UNSEEN_STEPS}  # in a row, then it turns to find an echo\n\
                 PAST_CORNER_CM = {PAST_CORNER_CM}  # additional free distance after a turn\n\
                 PAST_CORNER_POWER = {PAST_CORNER_POWER}  # in the last step of a turn\n\
                 SEED = {}  # of the random commands\n",
                seed % SEEDS
            ),
            RANDOM,
        ),
        Commands::Script(powers) => {
            let row = |[left, right]: &[i8; 2]| {
                let [left, right] = [left, right].map(|power| (*power).clamp(-FULL_SPEED, FULL_SPEED));
                format!("    ({left}, {right}),\n")
            };
            let rows: String = powers.iter().map(row).collect();
            (
                "# A script of commands for a hub with Pybricks firmware, to distinguish the causes of a gap. The robot does not look\n\
                 # where it drives: keep the way free and stay near it.\n"
                    .to_owned(),
                format!("# Left and right power of each step.\nSCRIPT = (\n{rows})\nSTEPS = len(SCRIPT)\n"),
                SCRIPT,
            )
        }
    };
    let head = format!(
        "{purpose}\
         # It prints a row per step. Save its output as a log; lines around the rows do not matter.\n\
         \n\
         STEP_MS = {step_ms}\n\
         FAILED_STEPS_TO_STOP = {FAILED_STEPS_TO_STOP}  # in a row\n\
         {constants}"
    );
    Ok([&head, DRIVER, source, "", RUN, "", MAIN].join("\n"))
}
