//! `mindgap export`

mod collect;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use mindgap_controller_export::budget::Budget;
use mindgap_controller_export::c_monitor::c_monitor;
use mindgap_controller_export::c_networks::c_networks;
use mindgap_controller_export::collect::{CollectOptions, Commands};
use mindgap_controller_export::names::{BrickName, RunLogs};
use mindgap_controller_export::nxc::{self, NxcOptions};
use mindgap_controller_export::nxc_networks::{self, NetworksBudget, nxc_networks};
use mindgap_controller_export::onboard::Safety;
use mindgap_controller_export::pybricks_networks::{PybricksNetwork, pybricks_networks};
use mindgap_controller_export::rust_monitor::rust_monitor;
use mindgap_controller_export::rust_networks::rust_networks;
use mindgap_controller_export::{
    ExportError, Origin, arduino, c, collect as data_collection, pybricks, pybricks_collect, rust, rxe,
};
use schemars::JsonSchema;
use serde::Serialize;

use super::json_output::JsonOption;
use super::ports::PortOptions;
use super::{Run, kinds};
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Executor;
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_logs::controller_file::ControllerFile;
use mindgap_logs::range_sensor::ULTRASONIC;
use mindgap_models::simulator::fixed_point::{COMMANDS, DOCUMENTATION, FACING, FixedNetworks};
use mindgap_models::simulator::monitor::MonitorLaw;
use mindgap_models::simulator::monitor::directions::NAMED;
use mindgap_models::simulator::{Learned, Simulator};

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
    #[arg(long, value_enum)]
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

/// Memory and time that a program needs on a brick, as text and as JSON.
struct Takes {
    text: String,
    resources: Resources,
}

impl From<Budget> for Takes {
    fn from(budget: Budget) -> Self {
        let Budget { program_bytes, memory_bytes, log_bytes, step_ms, worst_step_ms, .. } = budget;
        let resources = Resources::Program { program_bytes, memory_bytes, log_bytes, step_ms, worst_step_ms };
        Takes { text: budget.to_string(), resources }
    }
}

impl From<NetworksBudget> for Takes {
    fn from(budget: NetworksBudget) -> Self {
        let text = budget.to_string();
        let NetworksBudget { program_bytes, memory_bytes, answer_ms, .. } = budget;
        let answer_ms = answer_ms.into_iter().collect();
        Takes { text, resources: Resources::Networks { program_bytes, memory_bytes, answer_ms } }
    }
}

/// Output formats.
#[derive(Clone, Copy, ValueEnum)]
enum Format {
    /// NXC source for the LEGO NXT's standard firmware.
    Nxc,
    /// Executable for the brick, without log and display.
    Rxe,
    /// Constants for the crate `mindgap-core`.
    Rust,
    /// C99 header with the controller's state machine.
    C,
    /// Arduino sketch; for a simulator, a header to include in one.
    Arduino,
    /// MicroPython program for an NXT, EV3, SPIKE or Technic hub with Pybricks firmware; for a simulator, a module to
    /// import in one.
    Pybricks,
    /// NXC source of a program that drives at random or by a script, and logs.
    NxcCollect,
    /// MicroPython program for hubs with Pybricks firmware that drives at random or by a script, and prints a log.
    PybricksCollect,
}

impl Run for Export {
    fn places(&self) -> Places {
        let places = Places::default().reading(&self.input).writing([&self.out], kinds::PROGRAM);
        places.writing(self.json.path(), kinds::REPORT)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        if (self.log.is_some() || self.display) && !matches!(self.format()?, Format::Nxc) {
            return Err(Error::new("--log and --display need a controller and --format nxc"));
        }
        let runs_on_a_brick = matches!(self.format()?, Format::Nxc | Format::Rxe | Format::NxcCollect);
        if self.safety() != Safety::default() && !runs_on_a_brick {
            return Err(Error::new(
                "--stop-cm and --stall need a program for a brick: --format nxc, rxe or nxc-collect",
            ));
        }
        if self.monitor && !matches!(self.format()?, Format::C | Format::Arduino | Format::Rust) {
            return Err(Error::new("--monitor needs a simulator and --format c, arduino or rust"));
        }
        let (program, budget) = match &self.input {
            None if self.format.is_none() => {
                let what =
                    "a controller or a simulator is needed; --format nxc-collect and pybricks-collect alone need none";
                return Err(Error::new(what));
            }
            None => self.collection(self.collect.random())?,
            // Simulators are JSON; no TOML file begins with a brace.
            Some(input) if files::read_text(input)?.trim_start().starts_with('{') => self.networks(input)?,
            Some(input) if self.monitor => {
                return Err(Error::in_file(input, "is no simulator, which --monitor needs"));
            }
            Some(input) => self.onboard(input)?,
        };
        let bytes = program.len();
        files::write(&self.out, program)?;
        let (budget, takes) = budget.map(|Takes { text, resources }| (text + "\n", resources)).unzip();
        let text = format!("{} written\n{}", self.out.display(), budget.unwrap_or_default());
        let results = ExportResults { schema: SchemaNumber, program: &self.out, bytes, takes };
        self.json.emit_sorted(&results, text)
    }
}

impl Export {
    fn collection(&self, (step_ms, commands): (u16, Commands)) -> Result<(Vec<u8>, Option<Takes>)> {
        let named = self.input.as_ref().unwrap_or(&self.out);
        let refused = |e: ExportError| Error::in_file(named, e.to_string());
        if let Format::PybricksCollect = self.format()? {
            return Ok((pybricks_collect::program(step_ms, &commands).map_err(refused)?.into_bytes(), None));
        }
        let (program, wiring, safety) = (self.program_name()?, self.ports.wiring(), self.safety());
        let options = CollectOptions { program, wiring, safety, step_ms, commands };
        let source = data_collection::program(&options).map_err(refused)?;
        Ok((source.into_bytes(), Some(data_collection::budget(&options).into())))
    }

    fn networks(&self, input: &Path) -> Result<(Vec<u8>, Option<Takes>)> {
        let simulator = Simulator::read(input)?;
        let law = self.monitor.then(|| MonitorLaw::of(&simulator)).transpose();
        let law = law.map_err(|error| error.or_in_file(input))?;
        let quantised = || FixedNetworks::quantise(&simulator).map_err(|error| error.or_in_file(input));
        match self.format()? {
            Format::Rust => {
                let monitor = law.map_or(String::new(), |law| format!("\n{}", rust_monitor(&law.law())));
                Ok(((rust_networks(&quantised()?.rust_definitions()) + &monitor).into_bytes(), None))
            }
            Format::Nxc => {
                let networks = quantised()?.tabulated(["Turn", "Forward", "Lateral", "EchoProbability", "EchoValue"]);
                Ok((nxc_networks(&networks).into_bytes(), Some(nxc_networks::budget(&networks).into())))
            }
            Format::C | Format::Arduino => {
                let monitor = law.as_ref().map(monitor_in_c).unwrap_or_default();
                Ok((c_networks(&quantised()?.tabulated(NAMES), &monitor).into_bytes(), None))
            }
            Format::Pybricks => {
                let networks = float_networks(&simulator).map_err(|error| error.or_in_file(input))?;
                Ok((pybricks_networks(&networks).into_bytes(), None))
            }
            Format::Rxe | Format::NxcCollect | Format::PybricksCollect => Err(Error::in_file(
                input,
                "contains networks, which the formats rxe, nxc-collect and pybricks-collect do not support",
            )),
        }
    }

    fn onboard(&self, input: &Path) -> Result<(Vec<u8>, Option<Takes>)> {
        let read = || {
            let file = ControllerFile::read(input)?;
            // A program reads the one sensor on its port; which one of the robot's that is, the wiring decides.
            file.sensor(ULTRASONIC).map_err(|error| error.or_in_file(input))?;
            let origin = Origin::from(&file);
            Ok((file.controller, origin))
        };
        let refused = |e: ExportError| Error::in_file(input, e.to_string());
        Ok(match self.format()? {
            Format::Rxe => {
                self.program_name()?;
                let (controller, _) = read()?;
                (
                    rxe::program(&controller, &self.ports.wiring(), self.safety()).map_err(refused)?,
                    Some(rxe::budget(&controller, self.safety()).into()),
                )
            }
            Format::NxcCollect | Format::PybricksCollect => self.collection(collect::script(input)?)?,
            Format::Rust => {
                let (controller, origin) = read()?;
                (rust::module(&controller, &origin).map_err(refused)?.into_bytes(), None)
            }
            Format::C => {
                let (controller, origin) = read()?;
                (c::header(&controller, &origin).map_err(refused)?.into_bytes(), None)
            }
            Format::Arduino => {
                let (controller, origin) = read()?;
                (arduino::sketch(&controller, &origin).map_err(refused)?.into_bytes(), None)
            }
            Format::Pybricks => {
                let (controller, origin) = read()?;
                (pybricks::program(&controller, &origin).map_err(refused)?.into_bytes(), None)
            }
            Format::Nxc => {
                let ((controller, origin), program) = (read()?, self.program_name()?);
                let (wiring, safety, display) = (self.ports.wiring(), self.safety(), self.display);
                let log = self.logs(&program).transpose().map_err(|e| Error::in_file(&self.out, e.to_string()))?;
                let options = NxcOptions { program, wiring, safety, log, display };
                let source = nxc::program(&controller, &origin, &options).map_err(refused)?;
                (source.into_bytes(), Some(nxc::budget(&controller, &options).into()))
            }
        })
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

    fn safety(&self) -> Safety {
        Safety { stop_cm: self.stop_cm, stall: self.stall }
    }

    /// Returns the names of the logs, if logging is requested.
    fn logs(&self, program: &BrickName) -> Option<std::result::Result<RunLogs, ExportError>> {
        let named = |name: &BrickName| RunLogs::named_after(name);
        let by_program = || named(&format!("{}.csv", program.stem()).parse()?);
        self.log.as_ref().map(|name| name.as_ref().map_or_else(by_program, named))
    }

    /// Returns the compiled program's name on the brick, which is that of the output file.
    fn program_name(&self) -> Result<BrickName> {
        let stem = self.out.file_stem().unwrap_or_default().to_string_lossy();
        BrickName::program(&stem).map_err(|e| Error::in_file(&self.out, e.to_string()))
    }
}

/// Names of the networks in C and Python.
const NAMES: [&str; 5] = ["turn", "forward", "lateral", "echo_probability", "echo_value"];

fn monitor_in_c(law: &MonitorLaw) -> String {
    c_monitor(&law.law(), &NAMED.map(|named| named.name))
}

fn float_networks(simulator: &Simulator) -> Result<[PybricksNetwork; 5]> {
    simulator.need_no_filter()?;
    Ok([
        float_network(simulator, &simulator.turn, 0, COMMANDS)?,
        float_network(simulator, &simulator.forward, 1, COMMANDS)?,
        float_network(simulator, &simulator.lateral, 2, COMMANDS)?,
        float_network(simulator, &simulator.echo_probability, 3, FACING)?,
        float_network(simulator, &simulator.echo_value, 4, FACING)?,
    ])
}

fn float_network<const N: usize>(
    simulator: &Simulator,
    learned: &Option<Learned<N>>,
    place: usize,
    inputs: [&str; N],
) -> Result<PybricksNetwork> {
    let learned = simulator.need(learned, NAMES[place])?;
    Ok(PybricksNetwork::new(NAMES[place], DOCUMENTATION[place], inputs, &learned.network))
}
