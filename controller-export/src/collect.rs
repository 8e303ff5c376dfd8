//! NXC programs that collect data, to train a simulator or to diagnose a gap.
//!
//! They drive random commands, each held for a few steps (paper, section VI), or a script, and log the ultrasonic sensor's
//! readings, the wheel rotations and the battery voltage on the brick.
//!
//! Every start of the program adds a run: `run-000.csv` and so on. Random runs differ in their commands. When driving at
//! random, the robot turns away from near objects and reverses only over ground that it has just crossed. A script is driven
//! regardless of obstacles. Both stop when the sensor is dead or somebody presses the orange button, but the robot still
//! needs supervision. The camera's poses are added on the host.

use mindgap_core::controller::FULL_SPEED;

use crate::budget::{Budget, Cost};
use crate::error::ExportError;
use crate::names::{BrickName, RunLogs};
use crate::nxc::source::{Constants, ENDING, LOG, MOTORS, Parts, SONAR, STALL, TIME, ports_and_stops};
use crate::nxc::{log_constants, safety_cost};
use crate::onboard::Safety;
use crate::wiring::Wiring;

const DRIVE: &str = include_str!("collect/drive.nxc");
const SCRIPT: &str = include_str!("collect/script.nxc");
const MAIN: &str = include_str!("collect/main.nxc");

/// Measured cost of the random program, as compiled by nbc.
const COST: Cost = Cost { program_bytes: 8_200, memory_bytes: 6_100, step_instructions: 1_250 };
/// Measured cost of the scripted program, without its script.
const SCRIPT_COST: Cost = Cost { program_bytes: 6_100, memory_bytes: 5_900, step_instructions: 900 };
/// Additional bytes per step of a script, in flash and in memory.
const SCRIPT_STEP_BYTES: u32 = 4;
/// Largest number of steps of a script for which there is memory.
const MAX_SCRIPT_STEPS: usize = 1_000;
/// Number of consecutive steps without an echo after which the robot looks for one.
pub(crate) const MAX_UNSEEN_STEPS: u16 = 2;
/// Additional free distance ahead required after a turn.
pub(crate) const PAST_CORNER_CM: u16 = 20;
/// Power in the last step of a turn away from an object.
pub(crate) const PAST_CORNER_POWER: u16 = 15;
/// Number of seeds. It leaves room for a thousand runs within the generator's 31 bits.
const SEEDS: u32 = 1_000_000_000;

/// The options of a program that collects data.
///
/// ```
/// use mindgap_controller_export::collect::{self, CollectOptions, Commands};
/// use mindgap_controller_export::names::BrickName;
/// use mindgap_controller_export::onboard::Safety;
/// use mindgap_controller_export::wiring::Wiring;
///
/// let options = CollectOptions {
///     program: BrickName::program("collect")?,
///     wiring: Wiring::default(),
///     safety: Safety::default(),
///     step_ms: 400,
///     commands: Commands::Random { steps: 150, near_cm: 40, seed: 1 },
/// };
/// let source = collect::program(&options)?;
/// assert!(source.contains("#define NEAR_CM              40"));
/// # Ok::<(), mindgap_controller_export::ExportError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CollectOptions {
    /// Name of the compiled program on the brick.
    pub program: BrickName,
    /// Ports of the motors and the sensor.
    pub wiring: Wiring,
    /// Additional reasons to stop.
    pub safety: Safety,
    /// Time between two rows of the log, in ms. It has to equal the step time of the controllers.
    pub step_ms: u16,
    /// Source of the commands.
    pub commands: Commands,
}

/// The source of the commands.
///
/// ```
/// use mindgap_controller_export::collect::Commands;
///
/// // One step ahead, one step turning on the spot.
/// let script = Commands::Script(vec![[50, 50], [40, -40]]);
/// assert_ne!(script, Commands::Random { steps: 2, near_cm: 40, seed: 1 });
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Commands {
    /// Random commands.
    Random {
        /// Number of steps per run.
        steps: u16,
        /// Distance below which the robot turns away, 1..=254 cm.
        near_cm: u8,
        /// Seed of the commands.
        seed: u32,
    },
    /// A script: left and right power, one pair per step.
    Script(Vec<[i8; 2]>),
}

/// Returns the program as NXC source.
///
/// # Errors
/// Returns an [`ExportError`] when the brick cannot run or store the program.
pub fn program(options: &CollectOptions) -> Result<String, ExportError> {
    let CollectOptions { program, wiring, safety, step_ms, commands } = options;
    check(commands)?;
    wiring.check()?;
    let budget = budget(options);
    budget.check()?;
    let (stem, steps) = (program.stem(), steps(commands));
    let purpose = match commands {
        Commands::Random { near_cm, .. } => format!(
            "// Random commands for the LEGO NXT with standard firmware, to train a simulator. The robot turns away from anything\n\
             // that its sensor sees nearer than {near_cm} cm; it sees nothing to its sides or behind it."
        ),
        Commands::Script(_) => "// A script of commands for the LEGO NXT with standard firmware, to distinguish the causes of a gap. The robot does\n\
             // not look where it drives: keep the way free and stay near it."
            .to_owned(),
    };
    let head = format!(
        "{purpose}\n\
         // Compile and load it with\n\
         //   nbc -v=128 -O={program} {stem}.nxc\n\
         //   nbc -S=usb -b -d {program}\n\
         //\n\
         // Every start of the program adds a run of {steps} steps of {step_ms} ms, run-000.csv and so on.\n{}",
        ports_and_stops(wiring, *safety)
    );
    let parts = Parts { log: true, display: false, safety: *safety };
    let constants = Constants::shared(wiring, parts, *step_ms).with("STEP_MS", step_ms, "").with("STEPS", steps, "");
    let constants = log_constants(constants, &RunLogs::for_collection(), budget.log_bytes);
    let (constants, drive) = match commands {
        Commands::Random { near_cm, seed, .. } => {
            let constants = constants
                .with("NEAR_CM", near_cm, "a smaller reading makes it turn away")
                .with("MAX_UNSEEN_STEPS", MAX_UNSEEN_STEPS, "in a row, then it turns to find an echo")
                .with("PAST_CORNER_CM", PAST_CORNER_CM, "additional free distance after a turn")
                .with("PAST_CORNER_POWER", PAST_CORNER_POWER, "in the last step of a turn")
                .with("SEED", seed % SEEDS + 1, "of the random commands");
            (constants, DRIVE.to_owned())
        }
        Commands::Script(powers) => (constants, tables(powers) + SCRIPT),
    };
    let stall = if safety.stall { STALL } else { "" };
    let parts = [&head, &constants.into_text(), TIME, SONAR, MOTORS, stall, LOG, ENDING, &drive, &parts.select(MAIN)];
    Ok(parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n"))
}

/// Returns the resources of the compiled program and of the log of one run.
pub fn budget(options: &CollectOptions) -> Budget {
    let cost = match &options.commands {
        Commands::Random { .. } => COST,
        Commands::Script(powers) => {
            let tables_bytes = powers.len() as u32 * SCRIPT_STEP_BYTES;
            SCRIPT_COST.plus(Cost { program_bytes: tables_bytes, memory_bytes: tables_bytes, step_instructions: 0 })
        }
    };
    Budget::new(cost.plus(safety_cost(options.safety)), options.step_ms, Some(steps(&options.commands)))
}

/// Returns an error for commands without a step, with too many of them, or with an impossible distance.
pub(crate) fn check(commands: &Commands) -> Result<(), ExportError> {
    let out_of_range = |name, value, range| Err(ExportError::OutOfRange { name, value, range });
    match commands {
        Commands::Random { steps: 0, .. } => out_of_range("steps", 0, "1..65535"),
        Commands::Random { near_cm: near_cm @ (0 | 255), .. } => out_of_range("near_cm", u32::from(*near_cm), "1..254"),
        Commands::Script(powers) if powers.is_empty() || powers.len() > MAX_SCRIPT_STEPS => {
            out_of_range("steps", powers.len() as u32, "1..1000")
        }
        _ => Ok(()),
    }
}

/// Returns the number of steps per run, saturated for a script that is too long.
fn steps(commands: &Commands) -> u16 {
    match commands {
        Commands::Random { steps, .. } => *steps,
        Commands::Script(powers) => u16::try_from(powers.len()).unwrap_or(u16::MAX),
    }
}

fn tables(powers: &[[i8; 2]]) -> String {
    let table = |name: &str, side: usize| {
        let cells: Vec<String> =
            powers.iter().map(|pair| pair[side].clamp(-FULL_SPEED, FULL_SPEED).to_string()).collect();
        let lines: Vec<String> = cells.chunks(16).map(|line| line.join(", ")).collect();
        format!("int {name}[] = {{\n  {}\n}};\n", lines.join(",\n  "))
    };
    ["// The script, one command per step.\n".to_owned(), table("script_left", 0), table("script_right", 1)].concat()
}
