//! Onboard programs in all formats: controllers, networks of simulators, and programs that collect logs.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use mindgap_controller_export::budget::Budget;
use mindgap_controller_export::c_monitor::c_monitor;
use mindgap_controller_export::c_networks::c_networks;
use mindgap_controller_export::collect::{self, CollectOptions, Commands};
use mindgap_controller_export::names::{BrickName, RunLogs};
use mindgap_controller_export::nxc::{self, NxcOptions};
use mindgap_controller_export::nxc_networks::{self, NetworksBudget, nxc_networks};
use mindgap_controller_export::onboard::Safety;
use mindgap_controller_export::pybricks_networks::{PybricksNetwork, pybricks_networks};
use mindgap_controller_export::rust_monitor::rust_monitor;
use mindgap_controller_export::rust_networks::rust_networks;
use mindgap_controller_export::wiring::Wiring;
use mindgap_controller_export::{ExportError, Origin, arduino, c, pybricks, pybricks_collect, rust, rxe};
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::controller_file::ControllerFile;
use mindgap_logs::range_sensor::ULTRASONIC;
use mindgap_models::simulator::fixed_point::{COMMANDS, DOCUMENTATION, FACING, FixedNetworks};
use mindgap_models::simulator::monitor::MonitorLaw;
use mindgap_models::simulator::monitor::directions::NAMED;
use mindgap_models::simulator::{Learned, Simulator};

/// What is exported.
pub enum Subject<'a> {
    /// A controller.
    Controller(&'a ControllerFile),
    /// The networks of a simulator.
    Simulator(&'a Simulator),
    /// A program that collects logs: the time between two rows, ms, and its commands.
    Collection(u16, Commands),
}

/// How it is exported.
pub struct Options<'a> {
    /// Format of the program.
    pub format: Format,
    /// File of the program; its stem is the program's name on a brick.
    pub file: &'a Path,
    /// Ports of a brick.
    pub wiring: Wiring,
    /// Additional reasons to stop.
    pub safety: Safety,
    /// Whether every step is logged on the brick, and in files of which name; by default that of the program.
    pub log: Option<Option<BrickName>>,
    /// Whether the brick's display shows tuple, reading and outcome.
    pub display: bool,
    /// Whether a simulator's monitor is exported too.
    pub monitor: bool,
}

/// Output formats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// NXC source.
    Nxc,
    /// Executable for a brick.
    Rxe,
    /// Constants for the crate `mindgap-core`.
    Rust,
    /// C99 header.
    C,
    /// Arduino sketch or header.
    Arduino,
    /// MicroPython program or module.
    Pybricks,
    /// NXC source of a program that collects logs.
    NxcCollect,
    /// MicroPython program that collects logs.
    PybricksCollect,
}

/// A program.
pub struct Program {
    /// Its text, or the bytes of an executable.
    pub content: Vec<u8>,
    /// Resources of a brick that it needs; none for other boards.
    pub takes: Option<Takes>,
}

/// Resources of a brick.
pub enum Takes {
    /// Those of a program.
    Program(Budget),
    /// Those of networks.
    Networks(NetworksBudget),
}

impl fmt::Display for Takes {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Takes::Program(budget) => budget.fmt(f),
            Takes::Networks(budget) => budget.fmt(f),
        }
    }
}

/// Exports a program.
///
/// # Errors
/// If the format does not support the subject or an option, or the program would not run on its board.
pub fn export(subject: &Subject, options: &Options) -> Result<Program> {
    options.check(subject)?;
    match subject {
        Subject::Controller(file) => options.onboard(file),
        Subject::Simulator(simulator) => options.networks(simulator),
        Subject::Collection(step_ms, commands) => options.collection(*step_ms, commands.clone()),
    }
}

impl FromStr for Format {
    type Err = String;

    fn from_str(name: &str) -> std::result::Result<Self, String> {
        match name {
            "nxc" => Ok(Format::Nxc),
            "rxe" => Ok(Format::Rxe),
            "rust" => Ok(Format::Rust),
            "c" => Ok(Format::C),
            "arduino" => Ok(Format::Arduino),
            "pybricks" => Ok(Format::Pybricks),
            "nxc-collect" => Ok(Format::NxcCollect),
            "pybricks-collect" => Ok(Format::PybricksCollect),
            _ => Err(format!("{name:?} is not a format of programs")),
        }
    }
}

impl Format {
    /// Returns whether its programs collect logs.
    pub fn collects(self) -> bool {
        matches!(self, Format::NxcCollect | Format::PybricksCollect)
    }
}

impl Program {
    fn text(text: String) -> Self {
        Program { content: text.into_bytes(), takes: None }
    }
}

impl Options<'_> {
    fn check(&self, subject: &Subject) -> Result<()> {
        let format = self.format;
        if (self.log.is_some() || self.display) && format != Format::Nxc {
            return Err(Error::new("a log and a display need a controller and format nxc"));
        }
        let runs_on_a_brick = matches!(format, Format::Nxc | Format::Rxe | Format::NxcCollect);
        if self.safety != Safety::default() && !runs_on_a_brick {
            let what = "a stop distance and a stall check need a program for a brick: format nxc, rxe or nxc-collect";
            return Err(Error::new(what));
        }
        let has_monitor =
            matches!(subject, Subject::Simulator(_)) && matches!(format, Format::C | Format::Arduino | Format::Rust);
        if self.monitor && !has_monitor {
            return Err(Error::new("a monitor needs a simulator and format c, arduino or rust"));
        }
        Ok(())
    }

    fn onboard(&self, file: &ControllerFile) -> Result<Program> {
        // A program reads the one sensor on its port; which one of the robot's that is, the wiring decides.
        file.sensor(ULTRASONIC)?;
        let (controller, origin) = (&file.controller, Origin::from(file));
        let text = match self.format {
            Format::Rxe => {
                self.program_name()?;
                let content = rxe::program(controller, &self.wiring, self.safety).map_err(refused)?;
                let takes = Some(Takes::Program(rxe::budget(controller, self.safety)));
                return Ok(Program { content, takes });
            }
            Format::Nxc => {
                let program = self.program_name()?;
                let log = self.logs(&program).transpose().map_err(|e| self.bad_name(e))?;
                let (wiring, safety, display) = (self.wiring, self.safety, self.display);
                let options = NxcOptions { program, wiring, safety, log, display };
                let source = nxc::program(controller, &origin, &options).map_err(refused)?;
                let takes = Some(Takes::Program(nxc::budget(controller, &options)));
                return Ok(Program { takes, ..Program::text(source) });
            }
            Format::Rust => rust::module(controller, &origin),
            Format::C => c::header(controller, &origin),
            Format::Arduino => arduino::sketch(controller, &origin),
            Format::Pybricks => pybricks::program(controller, &origin),
            Format::NxcCollect | Format::PybricksCollect => {
                return Err(Error::new("formats nxc-collect and pybricks-collect need no controller"));
            }
        };
        text.map(Program::text).map_err(refused)
    }

    fn networks(&self, simulator: &Simulator) -> Result<Program> {
        let law = self.monitor.then(|| MonitorLaw::of(simulator)).transpose()?;
        let quantised = || FixedNetworks::quantise(simulator);
        Ok(match self.format {
            Format::Rust => {
                let monitor = law.map_or(String::new(), |law| format!("\n{}", rust_monitor(&law.law())));
                Program::text(rust_networks(&quantised()?.rust_definitions()) + &monitor)
            }
            Format::Nxc => {
                let networks = quantised()?.tabulated(["Turn", "Forward", "Lateral", "EchoProbability", "EchoValue"]);
                let takes = Some(Takes::Networks(nxc_networks::budget(&networks)));
                Program { takes, ..Program::text(nxc_networks(&networks)) }
            }
            Format::C | Format::Arduino => {
                let monitor = law.as_ref().map(monitor_in_c).unwrap_or_default();
                Program::text(c_networks(&quantised()?.tabulated(NAMES), &monitor))
            }
            Format::Pybricks => Program::text(pybricks_networks(&float_networks(simulator)?)),
            Format::Rxe | Format::NxcCollect | Format::PybricksCollect => {
                let what = "contains networks, which the formats rxe, nxc-collect and pybricks-collect do not support";
                return Err(Error::new(what));
            }
        })
    }

    fn collection(&self, step_ms: u16, commands: Commands) -> Result<Program> {
        match self.format {
            Format::PybricksCollect => {
                pybricks_collect::program(step_ms, &commands).map(Program::text).map_err(refused)
            }
            Format::NxcCollect => {
                let (program, wiring, safety) = (self.program_name()?, self.wiring, self.safety);
                let options = CollectOptions { program, wiring, safety, step_ms, commands };
                let source = collect::program(&options).map_err(refused)?;
                let takes = Some(Takes::Program(collect::budget(&options)));
                Ok(Program { takes, ..Program::text(source) })
            }
            _ => {
                let what =
                    "a controller or a simulator is needed; formats nxc-collect and pybricks-collect alone need none";
                Err(Error::new(what))
            }
        }
    }

    /// Returns the names of the logs, if logging is requested.
    fn logs(&self, program: &BrickName) -> Option<std::result::Result<RunLogs, ExportError>> {
        let named = |name: &BrickName| RunLogs::named_after(name);
        let by_program = || named(&format!("{}.csv", program.stem()).parse()?);
        self.log.as_ref().map(|name| name.as_ref().map_or_else(by_program, named))
    }

    /// Returns the compiled program's name on the brick.
    fn program_name(&self) -> Result<BrickName> {
        let stem = self.file.file_stem().unwrap_or_default().to_string_lossy();
        BrickName::program(&stem).map_err(|e| self.bad_name(e))
    }

    fn bad_name(&self, why: ExportError) -> Error {
        Error::in_file(self.file, why.to_string())
    }
}

fn refused(why: ExportError) -> Error {
    Error::new(why.to_string())
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
