//! `mindgap export`

mod collect;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;
use mindgap_applications::export::{Format, Options, Program, Subject, Takes, export};
use mindgap_controller_export::budget::Budget;
use mindgap_controller_export::names::BrickName;
use mindgap_controller_export::nxc_networks::NetworksBudget;
use mindgap_controller_export::onboard::Safety;
use schemars::JsonSchema;
use serde::Serialize;

use super::choices::{FORMATS, one_of};
use super::json_output::JsonOption;
use super::ports::PortOptions;
use super::{Run, kinds};
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Executor;
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_logs::controller_file::ControllerFile;
use mindgap_models::simulator::Simulator;

/// Export a controller as an onboard program.
///
/// Also exports a simulator's networks as constants for a board, and the program that collects a robot's first logs.
#[derive(Args)]
pub struct Export {
    /// Controller file; or a simulator file, for all formats but rxe and those that collect. For nxc-collect and
    /// pybricks-collect none, or a run whose commands serve as the script.
    #[arg(
        value_name = "CONTROLLER",
        required_if_eq_any = [("format", "nxc"), ("format", "rxe"), ("format", "rust"), ("format", "c"), ("format", "pybricks"), ("format", "arduino")]
    )]
    input: Option<PathBuf>,
    /// Output format (default: by the ending of --out: .nxc, .rxe, .rs, .c or .h, .ino, .py).
    #[arg(long, value_name = "FORMAT", value_parser = one_of::<Format>(FORMATS))]
    format: Option<Format>,
    /// The file to write.
    #[arg(long)]
    out: PathBuf,
    #[command(flatten)]
    ports: PortOptions,
    /// Log every step on the brick. Each start of the program writes a new file, such as NAME_000.csv; NAME is that of
    /// the program by default.
    #[arg(long, value_name = "NAME.csv", num_args = 0..=1)]
    log: Option<Option<BrickName>>,
    /// Show the tuple, reading and outcome on the brick's display.
    #[arg(long)]
    display: bool,
    /// Stop the robot when a reading is below this distance.
    #[arg(long, value_name = "CM", value_parser = clap::value_parser!(u8).range(1..=254))]
    stop_cm: Option<u8>,
    /// Stop the robot when a driven wheel does not turn.
    #[arg(long)]
    stall: bool,
    /// Also export the simulator's monitor, which finds out on board whether the robot has changed.
    #[arg(long)]
    monitor: bool,
    #[command(flatten)]
    json: JsonOption,
    #[command(flatten)]
    collect: collect::Collect,
}

/// Results of `mindgap export`.
#[derive(Serialize, JsonSchema)]
pub struct ExportResults<'a> {
    /// Version of the JSON.
    schema: SchemaNumber<1>,
    /// The program.
    program: &'a Path,
    /// Size of the program, bytes.
    bytes: usize,
    /// Resources of a brick that it needs; null for other boards.
    takes: Option<Resources>,
}

/// Memory and time that a program needs on a brick.
#[derive(Serialize, JsonSchema)]
#[serde(untagged)]
enum Resources {
    /// Those of a program.
    Program {
        /// Upper limit of the program's size on the brick, bytes.
        program_bytes: u32,
        /// Upper limit of the memory, bytes.
        memory_bytes: u32,
        /// Flash memory reserved for the log, bytes.
        log_bytes: u32,
        /// Time between two steps, ms.
        step_ms: u16,
        /// Upper limit of the duration of a step, ms.
        worst_step_ms: u16,
    },
    /// Those of networks.
    Networks {
        /// Upper limit of the size on the brick of a program that only evaluates the networks, bytes.
        program_bytes: usize,
        /// Upper limit of its memory, bytes.
        memory_bytes: usize,
        /// Upper limit of the time to evaluate each network, ms.
        answer_ms: BTreeMap<&'static str, usize>,
    },
}

impl From<Takes> for Resources {
    fn from(takes: Takes) -> Self {
        match takes {
            Takes::Program(Budget { program_bytes, memory_bytes, log_bytes, step_ms, worst_step_ms, .. }) => {
                Resources::Program { program_bytes, memory_bytes, log_bytes, step_ms, worst_step_ms }
            }
            Takes::Networks(NetworksBudget { program_bytes, memory_bytes, answer_ms, .. }) => {
                Resources::Networks { program_bytes, memory_bytes, answer_ms: answer_ms.into_iter().collect() }
            }
        }
    }
}

impl Run for Export {
    fn places(&self) -> Places {
        let places = Places::default().reading(&self.input).writing([&self.out], kinds::PROGRAM);
        places.writing(self.json.path(), kinds::REPORT)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let named = self.input.as_ref().unwrap_or(&self.out);
        let Program { content, takes } = self.program().map_err(|error| error.or_in_file(named))?;
        let bytes = content.len();
        files::write(&self.out, content)?;
        let needs = takes.as_ref().map_or(String::new(), |takes| format!("{takes}\n"));
        let text = format!("{} written\n{needs}", self.out.display());
        let takes = takes.map(Resources::from);
        self.json.emit_sorted(&ExportResults { schema: SchemaNumber, program: &self.out, bytes, takes }, text)
    }
}

impl Export {
    fn program(&self) -> Result<Program> {
        let options = Options {
            format: self.format()?,
            file: &self.out,
            wiring: self.ports.wiring(),
            safety: Safety { stop_cm: self.stop_cm, stall: self.stall },
            log: self.log.clone(),
            display: self.display,
            monitor: self.monitor,
        };
        let Some(input) = &self.input else {
            let (step_ms, commands) = self.collect.random();
            return export(&Subject::Collection(step_ms, commands), &options);
        };
        // Simulators are JSON; no TOML file begins with a brace.
        if files::read_text(input)?.trim_start().starts_with('{') {
            export(&Subject::Simulator(&Simulator::read(input)?), &options)
        } else if options.format.collects() {
            let (step_ms, commands) = collect::script(input)?;
            export(&Subject::Collection(step_ms, commands), &options)
        } else {
            export(&Subject::Controller(&ControllerFile::read(input)?), &options)
        }
    }

    /// Returns the format that was given, or that of the output's ending.
    fn format(&self) -> Result<Format> {
        let ending = self.out.extension().unwrap_or_default().to_ascii_lowercase();
        Ok(match (self.format, ending.to_str()) {
            (Some(format), _) => format,
            (None, Some("nxc")) => Format::Nxc,
            (None, Some("rxe")) => Format::Rxe,
            (None, Some("rs")) => Format::Rust,
            (None, Some("c" | "h")) => Format::C,
            (None, Some("ino")) => Format::Arduino,
            (None, Some("py")) => Format::Pybricks,
            _ => return Err(Error::in_file(&self.out, "has an ending that stands for no format: give --format")),
        })
    }
}
