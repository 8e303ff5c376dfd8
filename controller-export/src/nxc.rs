//! Readable NXC source for the LEGO NXT's standard firmware (`nbc -v=128`).
//!
//! The constant parts are NXC files in the folder beside this file. They use integers only, no shifts and no product wider
//! than 32 bits, which the compiler translates differently for each firmware. No local variable is initialised in its
//! declaration: there nbc 1.2.1 mistakes a signed result for an unsigned one, or the reverse, if the preceding function
//! ended with the other kind.

pub(crate) mod source;

use mindgap_core::controller::{Controller, FULL_SPEED, TUPLES, Tuple, When};

use crate::budget::{Budget, Cost};
use crate::error::ExportError;
use crate::names::BrickName;
use crate::origin::Origin;
use crate::wiring::Wiring;

use source::{Constants, DISPLAY, LOG, MOTORS, SONAR, TIME};

/// The main loop; lines needed only for a log or only for the display start with `@log ` or `@display `.
const RUN: &str = include_str!("nxc/run.nxc");

/// Measured cost of the program as compiled by nbc, and of its optional parts.
const PLAIN: Cost = Cost { program_bytes: 2_700, memory_bytes: 1_900, step_instructions: 430 };
const WITH_LOG: Cost = Cost { program_bytes: 2_000, memory_bytes: 2_600, step_instructions: 330 };
const WITH_DISPLAY: Cost = Cost { program_bytes: 1_000, memory_bytes: 1_000, step_instructions: 210 };

/// Options of an NXC program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NxcOptions {
    /// The compiled program's name on the brick.
    pub program: BrickName,
    /// Ports of motors and sensor.
    pub wiring: Wiring,
    /// File on the brick that every step is logged to; an existing file is replaced.
    pub log: Option<BrickName>,
    /// Whether the brick's display shows tuple, reading and outcome.
    pub display: bool,
}

/// The controller as an NXC program, with its origin and the compiler call in the first lines.
///
/// # Errors
/// When the brick cannot run or store the program: see [`ExportError`].
pub fn program(controller: &Controller, origin: &Origin, options: &NxcOptions) -> Result<String, ExportError> {
    controller.check()?;
    options.wiring.check()?;
    budget(controller, options).check()?;
    let parts = [
        Some(head(controller, origin, &options.program)),
        Some(constants(controller, options)),
        Some(tables(controller)),
        Some(TIME.to_owned()),
        Some(SONAR.to_owned()),
        Some(MOTORS.to_owned()),
        options.log.is_some().then(|| LOG.to_owned()),
        options.display.then(|| DISPLAY.to_owned()),
        Some(run(options)),
    ];
    Ok(parts.into_iter().flatten().collect::<Vec<_>>().join("\n"))
}

/// Resources of the compiled program.
pub fn budget(controller: &Controller, options: &NxcOptions) -> Budget {
    let mut cost = PLAIN;
    if options.log.is_some() {
        cost = cost.plus(WITH_LOG);
    }
    if options.display {
        cost = cost.plus(WITH_DISPLAY);
    }
    Budget::new(cost, controller.step_ms, options.log.as_ref().map(|_| controller.max_steps))
}

fn head(controller: &Controller, origin: &Origin, program: &BrickName) -> String {
    let stem = program.stem();
    let mut text = format!(
        "// A six-tuple controller for the LEGO NXT with standard firmware. Compile and load it with\n\
         //   nbc -v=128 -O={program} {stem}.nxc\n\
         //   nbc -S=usb -b -d {program}\n\
         //\n\
         // Every {} ms the ultrasonic sensor is read once; a reading on the stated side of a tuple's threshold starts the\n\
         // next tuple. The robot stops after the sixth, after {} steps, or when the sensor is dead.\n",
        controller.step_ms, controller.max_steps
    );
    for line in origin.lines() {
        text += &format!("// {line}\n");
    }
    text
}

fn constants(controller: &Controller, options: &NxcOptions) -> String {
    let mut constants = Constants::shared(&options.wiring)
        .with("TUPLES", TUPLES, "")
        .with("STEP_MS", controller.step_ms, "")
        .with("MAX_STEPS", controller.max_steps, "");
    if let Some(log) = &options.log {
        constants = constants.with("LOG_NAME", format!("\"{log}\""), "").with(
            "LOG_BYTES",
            budget(controller, options).log_bytes,
            "for the longest run",
        );
    }
    constants.into_text()
}

fn tables(controller: &Controller) -> String {
    let speed = |speed: i8| speed.clamp(-FULL_SPEED, FULL_SPEED);
    [
        "// The tuples, one a column.\n".to_owned(),
        table(controller, "int left_power[]", |tuple| speed(tuple.left)),
        table(controller, "int right_power[]", |tuple| speed(tuple.right)),
        table(controller, "bool when_larger[]", |tuple| tuple.when == When::Larger),
        table(controller, "int threshold_cm[]", |tuple| tuple.threshold_cm),
    ]
    .concat()
}

fn table<C: ToString>(controller: &Controller, name: &str, cell: impl Fn(&Tuple) -> C) -> String {
    let cells: Vec<_> = controller.tuples.iter().map(|tuple| format!("{:>5}", cell(tuple).to_string())).collect();
    format!("{name:<18} = {{{}}};\n", cells.join(", "))
}

fn run(options: &NxcOptions) -> String {
    let chosen = |line: &'static str| {
        if let Some(line) = line.strip_prefix("@log ") {
            options.log.is_some().then_some(line)
        } else if let Some(line) = line.strip_prefix("@display ") {
            options.display.then_some(line)
        } else {
            Some(line)
        }
    };
    RUN.lines().filter_map(chosen).flat_map(|line| [line, "\n"]).collect()
}
