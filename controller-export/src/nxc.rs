//! Readable NXC source for the LEGO NXT's standard firmware (`nbc -v=128`).
//!
//! The fixed parts are NXC files in `src/nxc`. They use only integers, no shifts and no products wider than 32 bits, which
//! the compiler translates differently for each firmware. No local variable is initialised in its declaration: there nbc
//! 1.2.1 mistakes a signed result for an unsigned one, or the reverse, if the preceding function ended with the other kind.

pub(crate) mod source;

use mindgap_core::controller::{Controller, FULL_SPEED, TUPLES, Tuple, When};

use crate::budget::{Budget, Cost};
use crate::error::ExportError;
use crate::names::{BrickName, RunLogs};
use crate::onboard::Safety;
use crate::origin::Origin;
use crate::wiring::Wiring;

use source::{Constants, DISPLAY, ENDING, LOG, MOTORS, Parts, SONAR, STALL, TIME, ports_and_stops};

/// The main loop.
const RUN: &str = include_str!("nxc/run.nxc");

/// Measured cost of the program as compiled by nbc, and of its optional parts.
const PLAIN: Cost = Cost { program_bytes: 4_400, memory_bytes: 2_600, step_instructions: 430 };
const WITH_LOG: Cost = Cost { program_bytes: 2_400, memory_bytes: 2_900, step_instructions: 330 };
const WITH_DISPLAY: Cost = Cost { program_bytes: 600, memory_bytes: 650, step_instructions: 210 };
const WITH_NEAR: Cost = Cost { program_bytes: 200, memory_bytes: 60, step_instructions: 10 };
const WITH_STALL: Cost = Cost { program_bytes: 650, memory_bytes: 100, step_instructions: 80 };

/// The options of an NXC program.
///
/// ```
/// use mindgap_controller_export::names::BrickName;
/// use mindgap_controller_export::nxc::{self, NxcOptions};
/// use mindgap_controller_export::Origin;
/// use mindgap_core::controller::{Controller, Tuple, When};
///
/// let ahead = Tuple { left: 55, right: 48, when: When::Smaller, threshold_cm: 42 };
/// let controller = Controller { step_ms: 400, max_steps: 150, tuples: [ahead; 6] };
/// let options = NxcOptions { display: true, ..NxcOptions::new(BrickName::program("avoid")?) };
/// let source = nxc::program(&controller, &Origin::default(), &options)?;
/// assert!(source.contains("task main()"));
/// # Ok::<(), mindgap_controller_export::ExportError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NxcOptions {
    /// Name of the compiled program on the brick.
    pub program: BrickName,
    /// Ports of the motors and the sensor.
    pub wiring: Wiring,
    /// Additional reasons to stop.
    pub safety: Safety,
    /// Files on the brick to which every step is logged, a new one at each start.
    pub log: Option<RunLogs>,
    /// Whether the brick's display shows tuple, reading and outcome.
    pub display: bool,
}

impl NxcOptions {
    /// Returns the options of a plain program with this name.
    pub fn new(program: BrickName) -> Self {
        NxcOptions { program, wiring: Wiring::default(), safety: Safety::default(), log: None, display: false }
    }

    fn parts(&self) -> Parts {
        Parts { log: self.log.is_some(), display: self.display, safety: self.safety }
    }
}

/// Returns the controller as NXC source, with its origin and the call of the compiler in the first lines.
///
/// # Errors
/// Returns an [`ExportError`] when the brick cannot run or store the program.
pub fn program(controller: &Controller, origin: &Origin, options: &NxcOptions) -> Result<String, ExportError> {
    controller.check()?;
    options.wiring.check()?;
    budget(controller, options).check()?;
    let parts = [
        Some(head(controller, origin, options)),
        Some(constants(controller, options)),
        Some(table(controller)),
        Some(TIME.to_owned()),
        Some(SONAR.to_owned()),
        Some(MOTORS.to_owned()),
        options.safety.stall.then(|| STALL.to_owned()),
        options.log.is_some().then(|| LOG.to_owned()),
        options.display.then(|| DISPLAY.to_owned()),
        Some(ENDING.to_owned()),
        Some(options.parts().select(RUN)),
    ];
    Ok(parts.into_iter().flatten().collect::<Vec<_>>().join("\n"))
}

/// Returns the resources of the compiled program.
pub fn budget(controller: &Controller, options: &NxcOptions) -> Budget {
    let parts = [(options.log.is_some(), WITH_LOG), (options.display, WITH_DISPLAY)];
    let wanted = parts.iter().filter(|(wanted, _)| *wanted);
    let cost = wanted.fold(PLAIN.plus(safety_cost(options.safety)), |sum, (_, cost)| sum.plus(*cost));
    Budget::new(cost, controller.step_ms, options.log.as_ref().map(|_| controller.max_steps))
}

/// Returns the cost of the additional reasons to stop.
pub(crate) fn safety_cost(safety: Safety) -> Cost {
    let parts = [(safety.stop_cm.is_some(), WITH_NEAR), (safety.stall, WITH_STALL)];
    parts.iter().filter(|(wanted, _)| *wanted).fold(Cost::default(), |sum, (_, cost)| sum.plus(*cost))
}

fn head(controller: &Controller, origin: &Origin, options: &NxcOptions) -> String {
    let NxcOptions { program, wiring, safety, log, .. } = options;
    let stem = program.stem();
    let mut text = format!(
        "// A six-tuple controller for the LEGO NXT with standard firmware. Compile and load it with\n\
         //   nbc -v=128 -O={program} {stem}.nxc\n\
         //   nbc -S=usb -b -d {program}\n\
         //\n\
         // Every {} ms the ultrasonic sensor is read once; a reading on the stated side of a tuple's threshold starts the\n\
         // next tuple. The robot stops after the sixth, after {} steps, or when the sensor is dead.\n{}",
        controller.step_ms,
        controller.max_steps,
        ports_and_stops(wiring, *safety)
    );
    if let Some(log) = log {
        text +=
            &format!("// Every start of the program writes a new file: {}, {} and so on.\n", log.name(0), log.name(1));
    }
    for line in origin.lines() {
        text += &format!("// {line}\n");
    }
    text
}

fn constants(controller: &Controller, options: &NxcOptions) -> String {
    let mut constants = Constants::shared(&options.wiring, options.parts(), controller.step_ms)
        .with("TUPLES", TUPLES, "")
        .with("STEP_MS", controller.step_ms, "")
        .with("MAX_STEPS", controller.max_steps, "");
    if let Some(log) = &options.log {
        constants = log_constants(constants, log, budget(controller, options).log_bytes);
    }
    constants.into_text()
}

/// Adds the constants of a log.
pub(crate) fn log_constants(constants: Constants, log: &RunLogs, log_bytes: u32) -> Constants {
    constants
        .with("LOG_STEM", format!("\"{}\"", log.stem()), "")
        .with("LOG_EXTENSION", format!("\".{}\"", log.extension()), "")
        .with("LOG_BYTES", log_bytes, "of the longest run")
}

fn table(controller: &Controller) -> String {
    let speed = |speed: i8| speed.clamp(-FULL_SPEED, FULL_SPEED);
    let row = |(number, tuple): (usize, &Tuple)| {
        let when = match tuple.when {
            When::Larger => "LARGER",
            When::Smaller => "SMALLER",
        };
        let (left, right) = (speed(tuple.left), speed(tuple.right));
        let comma = if number == TUPLES { " " } else { "," };
        format!("{left:>6}, {right:>11}, {when:>7}, {:>12}{comma}  // {number}\n", tuple.threshold_cm)
    };
    let rows: String = (1..).zip(&controller.tuples).map(row).collect();
    format!(
        "// The tuples, one per row.\n\
         #define LEFT_POWER           0\n\
         #define RIGHT_POWER          1\n\
         #define WHEN                 2\n\
         #define THRESHOLD_CM         3\n\
         #define COLUMNS              4\n\
         #define SMALLER              0\n\
         #define LARGER               1\n\
         int tuples[] = {{\n\
         //left, right power,    when, threshold_cm      tuple\n\
         {rows}}};\n"
    )
}
