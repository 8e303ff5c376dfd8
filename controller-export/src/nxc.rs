//! Readable NXC source for the LEGO NXT's standard firmware (`nbc -v=128`).
//!
//! The parts that never change stand as NXC in the folder beside this file. Only whole numbers, no shifts and no product
//! wider than 32 bits: what the compiler makes of those depends on the firmware.

use mindgap_core::controller::{Controller, FULL_SPEED, TUPLES, Tuple, When};

use crate::error::ExportError;
use crate::names::BrickName;
use crate::onboard;
use crate::origin::Origin;
use crate::wiring::Wiring;

const SONAR: &str = include_str!("nxc/sonar.nxc");
const MOTORS: &str = include_str!("nxc/motors.nxc");
const LOG: &str = include_str!("nxc/log.nxc");
const DISPLAY: &str = include_str!("nxc/display.nxc");
/// Lines that only a log or only the display needs start with `@log ` or `@display `.
const RUN: &str = include_str!("nxc/run.nxc");

/// The longest row that the log can hold, line end included: a time of ten digits, two commands, a reading, two wheel
/// rotations of seven, and millivolts.
const LOG_ROW_BYTES: u32 = 10 + 4 + 4 + 3 + 7 + 7 + 5 + 6 + 2;
const LOG_HEADER_BYTES: u32 = 80;
/// The row of the start; each step adds one.
const LOG_EXTRA_ROWS: u32 = 1;

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
    onboard::check(controller)?;
    options.wiring.check()?;
    let parts = [
        Some(head(controller, origin, &options.program)),
        Some(constants(controller, options)?),
        Some(tables(controller)),
        Some(SONAR.to_owned()),
        Some(MOTORS.to_owned()),
        options.log.is_some().then(|| LOG.to_owned()),
        options.display.then(|| DISPLAY.to_owned()),
        Some(run(options)),
    ];
    Ok(parts.into_iter().flatten().collect::<Vec<_>>().join("\n"))
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

fn constants(controller: &Controller, options: &NxcOptions) -> Result<String, ExportError> {
    let Wiring { left, right, sonar } = options.wiring;
    let mut rows = vec![
        ("LEFT", format!("OUT_{left}"), ""),
        ("RIGHT", format!("OUT_{right}"), ""),
        ("SONAR", format!("IN_{sonar}"), ""),
        ("TUPLES", TUPLES.to_string(), ""),
        ("STEP_MS", controller.step_ms.to_string(), ""),
        ("MAX_STEPS", controller.max_steps.to_string(), ""),
        ("NO_ECHO", onboard::NO_ECHO_CM.to_string(), "the sensor's own code"),
        ("SONAR_FAILED", "-1".to_owned(), ""),
        ("SONAR_WARM_UP_MS", onboard::SONAR_WARM_UP_MS.to_string(), ""),
        ("SONAR_TIMEOUT_MS", onboard::SONAR_TIMEOUT_MS.to_string(), ""),
        ("FAILED_STEPS_TO_STOP", onboard::FAILED_STEPS_TO_STOP.to_string(), "in a row"),
        ("BRAKE_MS", onboard::BRAKE_MS.to_string(), "before the program's end lets go of the motors"),
    ];
    if let Some(log) = &options.log {
        rows.push(("LOG_NAME", format!("\"{log}\""), ""));
        rows.push(("LOG_BYTES", log_bytes(controller.max_steps)?.to_string(), "for the longest run"));
    }
    let mut text = String::new();
    for (name, value, comment) in rows {
        let line = format!("#define {name:<20} {value}");
        text += &if comment.is_empty() { line + "\n" } else { format!("{line:<34} // {comment}\n") };
    }
    Ok(text)
}

fn log_bytes(max_steps: u16) -> Result<u32, ExportError> {
    let bytes = LOG_HEADER_BYTES + (u32::from(max_steps) + LOG_EXTRA_ROWS) * LOG_ROW_BYTES;
    if bytes > onboard::FREE_FLASH_BYTES {
        let rows = (onboard::FREE_FLASH_BYTES - LOG_HEADER_BYTES) / LOG_ROW_BYTES;
        return Err(ExportError::LogTooLarge { bytes, max_steps: (rows - LOG_EXTRA_ROWS) as u16 });
    }
    Ok(bytes)
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
