//! Readable NXC source for the LEGO NXT's standard firmware (`nbc -v=128`).
//!
//! The parts that never change stand as NXC in the folder beside this file. Only whole numbers, no shifts and no product
//! wider than 32 bits: what the compiler makes of those depends on the firmware. And no local variable gets its first value
//! where it is declared: there nbc 1.2.1 takes a signed result for an unsigned one, or the reverse, when the function
//! before ended with the other kind.

pub(crate) mod source;

use mindgap_core::controller::{Controller, FULL_SPEED, TUPLES, Tuple, When};

use crate::budget::{Budget, Cost};
use crate::error::ExportError;
use crate::names::BrickName;
use crate::origin::Origin;
use crate::wiring::Wiring;

use source::{Constants, DISPLAY, LOG, MOTORS, SONAR, TIME};

/// Lines that only a log or only the display needs start with `@log ` or `@display `.
const RUN: &str = include_str!("nxc/run.nxc");

/// What nbc makes of the program, and of what can be added to it.
const PLAIN: Cost = Cost { program_bytes: 2_700, memory_bytes: 1_900, step_instructions: 430 };
const WITH_LOG: Cost = Cost { program_bytes: 2_000, memory_bytes: 2_600, step_instructions: 330 };
const WITH_DISPLAY: Cost = Cost { program_bytes: 1_000, memory_bytes: 1_000, step_instructions: 210 };

/// What an NXC program does beside running the controller.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NxcOptions {
    /// The compiled program's name on the brick.
    pub program: BrickName,
    /// What is plugged in where.
    pub wiring: Wiring,
    /// Where to log every step on the brick; a file of that name is replaced.
    pub log: Option<BrickName>,
    /// Whether to show tuple, reading and outcome on the brick's display.
    pub display: bool,
}

/// The controller as an NXC program, origin and compiler call in its first lines.
///
/// # Errors
/// What the brick cannot run or store: see [`ExportError`].
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

/// What the program takes of the brick once it is compiled.
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
