//! The trace of an emulated program as JSON.

use std::collections::BTreeMap;

use mindgap_controller_export::brick::{self, CodeLocation, Drive, EventKind, Report};
use schemars::JsonSchema;
use serde::Serialize;

use super::trace::{MOTORS, drive_word, end_words};
use mindgap_foundations::schema_number::SchemaNumber;

/// Results of `mindgap brick`.
#[derive(Serialize, JsonSchema)]
pub struct BrickResults {
    /// Version of the JSON.
    schema: SchemaNumber<1>,
    /// How the program ended, in words.
    end: String,
    /// Where the firmware ended the program; null if it did not.
    failed_at: Option<FailedAt>,
    /// When the program ended, ms after its start.
    ended_ms: u32,
    /// Number of instructions executed.
    instructions: u64,
    /// Size of the data pool, bytes.
    pool_bytes: usize,
    /// State of the motors A, B and C at the end: a power in percent, `brake` or `coast`.
    motors: [String; MOTORS.len()],
    /// Sensor ports, 1 to 4, that the program read although no option configures them. They read as empty.
    unconfigured_ports: Vec<usize>,
    /// What the program did, in order of time.
    events: Vec<TimedEvent>,
    /// Number of further events, which are not listed.
    further_events: u64,
    /// Contents of the brick's files at the end, by name.
    files: BTreeMap<String, String>,
}

/// A place in the program.
#[derive(Serialize, JsonSchema)]
struct FailedAt {
    /// Number of the clump, a task or subroutine.
    clump: u8,
    /// Number of the word in the clump, from 0.
    word: usize,
    /// Name of the instruction.
    instruction: String,
}

/// Something that the program did.
#[derive(Serialize, JsonSchema)]
struct TimedEvent {
    /// When, ms after the start of the program.
    t_ms: u32,
    #[serde(flatten)]
    event: Event,
}

/// The kinds of events.
#[derive(Serialize, JsonSchema)]
#[serde(untagged)]
enum Event {
    /// A motor was given power.
    Power {
        /// The motor: A, B or C.
        motor: char,
        /// Power, percent.
        power: i8,
    },
    /// A motor was stopped.
    Stop {
        /// The motor: A, B or C.
        motor: char,
        /// `brake` or `coast`.
        drive: String,
    },
    /// A tone was started.
    Tone {
        /// Frequency, Hz.
        tone_hz: u16,
        /// Duration, ms.
        tone_ms: u16,
    },
    /// A sound file was started.
    Sound {
        /// Name of the file.
        sound: String,
    },
    /// Text was drawn on the display.
    Text {
        /// The text.
        text: String,
        /// Distance from the left, pixels.
        x: i16,
        /// Distance from the bottom, pixels.
        y: i16,
    },
}

impl BrickResults {
    /// Returns the results of a run whose program read `unconfigured_ports`.
    pub fn new(report: &Report, unconfigured_ports: Vec<usize>) -> Self {
        let file = |(name, content): (&String, &Vec<u8>)| (name.clone(), String::from_utf8_lossy(content).into_owned());
        BrickResults {
            schema: SchemaNumber,
            end: end_words(report.end),
            failed_at: report.failed_at.as_ref().map(FailedAt::from),
            ended_ms: report.ended_ms,
            instructions: report.instructions,
            pool_bytes: report.pool_bytes,
            motors: report.motors.map(drive_word),
            unconfigured_ports,
            events: report.events.iter().map(TimedEvent::from).collect(),
            further_events: report.further_events,
            files: report.files.iter().map(file).collect(),
        }
    }
}

impl From<&CodeLocation> for FailedAt {
    fn from(location: &CodeLocation) -> Self {
        let CodeLocation { clump, word, instruction, .. } = location.clone();
        FailedAt { clump, word, instruction }
    }
}

impl From<&brick::Event> for TimedEvent {
    fn from(event: &brick::Event) -> Self {
        TimedEvent { t_ms: event.t_ms, event: Event::from(&event.kind) }
    }
}

impl From<&EventKind> for Event {
    fn from(kind: &EventKind) -> Self {
        match kind.clone() {
            EventKind::Motor { port, drive: Drive::Power(power) } => Event::Power { motor: MOTORS[port], power },
            EventKind::Motor { port, drive } => Event::Stop { motor: MOTORS[port], drive: drive_word(drive) },
            EventKind::Tone { hz, ms } => Event::Tone { tone_hz: hz, tone_ms: ms },
            EventKind::Sound(sound) => Event::Sound { sound },
            EventKind::Text { x, y, text } => Event::Text { text, x, y },
        }
    }
}
