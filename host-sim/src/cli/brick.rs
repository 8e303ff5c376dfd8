//! `mindgap brick`

use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

use clap::Args;
use mindgap_controller_export::brick::{
    self, Drive, Event, EventKind, Fault, Program, Report, RunConfig, ScriptedWorld, Termination,
};
use mindgap_controller_export::wiring::SensorPort;
use serde_json::{Value, json};

use super::{Run, kinds};
use crate::error::{Error, Result};
use crate::files::places::Places;
use crate::logs::readings;

const MOTORS: [char; 3] = ['A', 'B', 'C'];

/// Run a compiled program without a brick, and tell what it does: motors, tones, text and files.
#[derive(Args)]
pub struct Brick {
    /// The program, an .rxe file for standard firmware.
    program: PathBuf,
    /// What the ultrasonic sensor answers, request by request: a list such as 120,80,none,silent,hangs, or a CSV file
    /// with a column echo_cm. After the last one it is silent.
    #[arg(long, value_name = "LIST|FILE")]
    readings: String,
    /// Port of the ultrasonic sensor.
    #[arg(long, default_value = "4")]
    sonar: SensorPort,
    /// Battery voltage.
    #[arg(long, default_value_t = 7800)]
    battery_mv: u16,
    /// When the dark button is pressed, which ends any program.
    #[arg(long, value_name = "MS")]
    exit_ms: Option<u32>,
    /// Time on the brick's clock after which the run is given up.
    #[arg(long, default_value_t = 120_000, value_parser = clap::value_parser!(u32).range(1..=600_000))]
    limit_ms: u32,
    /// Write the same facts here.
    #[arg(long)]
    json: Option<PathBuf>,
}

impl Run for Brick {
    fn places(&self) -> Places {
        // Readings may be a list.
        let readings = PathBuf::from(&self.readings);
        Places::default().reading([&self.program, &readings]).writing(&self.json, kinds::REPORT)
    }

    fn run(&self) -> Result<String> {
        let file =
            fs::read(&self.program).map_err(|e| Error::in_file(&self.program, format!("cannot be read: {e}")))?;
        let program = Program::load(&file)
            .map_err(|e| Error::in_file(&self.program, format!("is no program that a brick runs: {e}")))?;
        let mut world = ScriptedWorld {
            sonar_port: self.sonar as usize,
            battery_mv: self.battery_mv,
            exit_pressed_ms: self.exit_ms,
            ..ScriptedWorld::sonar(readings::read(&self.readings)?)
        };
        let report = brick::run(&program, &mut world, &RunConfig { run_ms: self.limit_ms, ..RunConfig::default() });
        let used = world.asked.min(world.sonar.len());
        let text = format!("{}{used} of {} readings were asked for\n", told(&report), world.sonar.len());
        super::reported(self.json.as_deref(), &facts(&report), text)
    }
}

fn told(report: &Report) -> String {
    let mut text = String::new();
    for Event { t_ms, kind } in &report.events {
        let _ = match kind {
            EventKind::Motor { port, drive } => {
                writeln!(text, "{t_ms:>7} ms  motor {}  {}", MOTORS[*port], drive_word(*drive))
            }
            EventKind::Tone { hz, ms } => writeln!(text, "{t_ms:>7} ms  tone     {hz} Hz for {ms} ms"),
            EventKind::Sound(name) => writeln!(text, "{t_ms:>7} ms  sound    {name:?}"),
            EventKind::Text { x, y, text: drawn } => writeln!(text, "{t_ms:>7} ms  text     {drawn:?} at {x}, {y}"),
        };
    }
    for (name, content) in &report.files {
        let _ = writeln!(text, "file {name}, {} bytes", content.len());
        for line in String::from_utf8_lossy(content).lines() {
            let _ = writeln!(text, "  {}", line.escape_debug());
        }
    }
    let motors = MOTORS.iter().zip(report.motors).map(|(name, drive)| format!("{name} {}", drive_word(drive)));
    let Report { ended_ms, instructions, pool_bytes, .. } = report;
    let _ = writeln!(
        text,
        "{} after {ended_ms} ms; motors: {}",
        end_words(report.end),
        motors.collect::<Vec<_>>().join(", ")
    );
    let _ = writeln!(text, "{instructions} instructions, {pool_bytes} bytes of memory");
    text
}

fn facts(report: &Report) -> Value {
    let event = |Event { t_ms, kind }: &Event| match kind {
        EventKind::Motor { port, drive: Drive::Power(power) } => {
            json!({"t_ms": t_ms, "motor": MOTORS[*port], "power": power})
        }
        EventKind::Motor { port, drive } => json!({"t_ms": t_ms, "motor": MOTORS[*port], "drive": drive_word(*drive)}),
        EventKind::Tone { hz, ms } => json!({"t_ms": t_ms, "tone_hz": hz, "tone_ms": ms}),
        EventKind::Sound(name) => json!({"t_ms": t_ms, "sound": name}),
        EventKind::Text { x, y, text } => json!({"t_ms": t_ms, "text": text, "x": x, "y": y}),
    };
    let files: serde_json::Map<_, _> = report
        .files
        .iter()
        .map(|(name, content)| (name.clone(), Value::from(String::from_utf8_lossy(content).into_owned())))
        .collect();
    json!({
        "schema": 1,
        "end": end_words(report.end),
        "ended_ms": report.ended_ms,
        "instructions": report.instructions,
        "pool_bytes": report.pool_bytes,
        "motors": report.motors.map(drive_word),
        "events": report.events.iter().map(event).collect::<Vec<_>>(),
        "files": files,
    })
}

fn drive_word(drive: Drive) -> String {
    match drive {
        Drive::Power(power) => power.to_string(),
        Drive::Brake => "brake".into(),
        Drive::Coast => "coast".into(),
    }
}

fn end_words(end: Termination) -> &'static str {
    match end {
        Termination::Finished => "finished",
        Termination::Aborted => "aborted by the dark button",
        Termination::OutOfTime => "still running, given up",
        Termination::Failed(Fault::Instruction) => "failed: an instruction that there is not",
        Termination::Failed(Fault::Argument) => "failed: a wrong operand or index",
        Termination::Failed(Fault::Pointer) => "failed: data outside the dataspace",
        Termination::Failed(Fault::Memory) => "failed: no memory left",
    }
}
