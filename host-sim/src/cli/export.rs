//! `mindgap export`

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use mindgap_controller_export::names::BrickName;
use mindgap_controller_export::nxc::{self, NxcOptions};
use mindgap_controller_export::rust_networks::rust_networks;
use mindgap_controller_export::wiring::{MotorPort, SensorPort, Wiring};
use mindgap_controller_export::{ExportError, Origin, c, rust, rxe};

use crate::evolve::controller_file::ControllerFile;
use crate::files;
use crate::problem::{Problem, Result};
use crate::simulator::Simulator;
use crate::simulator::fixed_point::FixedNetworks;

/// Turn a controller into an onboard program, or a simulator's networks into constants for a board.
#[derive(Args)]
pub struct Export {
    /// The controller file; or a simulator file, whose networks have the format rust alone.
    #[arg(value_name = "CONTROLLER")]
    input: PathBuf,
    /// What to make of it.
    #[arg(long, value_enum)]
    format: Format,
    /// The file to write.
    #[arg(long)]
    out: PathBuf,
    /// Port of the left motor.
    #[arg(long, default_value = "B")]
    left: MotorPort,
    /// Port of the right motor.
    #[arg(long, default_value = "C")]
    right: MotorPort,
    /// Port of the ultrasonic sensor.
    #[arg(long, default_value = "4")]
    sonar: SensorPort,
    /// Log every step to a file of this name on the brick.
    #[arg(long, value_name = "NAME")]
    log: Option<BrickName>,
    /// Show tuple, reading and outcome on the brick's display.
    #[arg(long)]
    display: bool,
}

/// What a controller can be turned into.
#[derive(Clone, Copy, ValueEnum)]
enum Format {
    /// NXC source for the LEGO NXT's standard firmware.
    Nxc,
    /// The brick's executable itself, without log and display.
    Rxe,
    /// Constants for the crate `mindgap-core`.
    Rust,
    /// A C99 header with the stepping machine.
    C,
}

impl Export {
    /// Writes the program or the networks.
    pub fn run(&self) -> Result<String> {
        // Simulators are JSON; no TOML begins like that.
        if files::read_text(&self.input)?.trim_start().starts_with('{') { self.networks() } else { self.controller() }
    }

    fn networks(&self) -> Result<String> {
        let simulator = Simulator::read(&self.input)?;
        if !matches!(self.format, Format::Rust) {
            return Err(Problem::in_file(&self.input, "holds networks, which are exported with --format rust alone"));
        }
        let networks = FixedNetworks::quantise(&simulator).map_err(|problem| problem.or_in_file(&self.input))?;
        files::write(&self.out, rust_networks(&networks.rust_definitions()))?;
        Ok(format!("{} written\n", self.out.display()))
    }

    fn controller(&self) -> Result<String> {
        let file = ControllerFile::read(&self.input)?;
        let refused = |e: ExportError| Problem::in_file(&self.input, e.to_string());
        let (controller, origin) = (&file.controller, &Origin::from(&file));
        let wiring = Wiring { left: self.left, right: self.right, sonar: self.sonar };
        let stem = self.out.file_stem().unwrap_or_default().to_string_lossy();
        let name = || BrickName::program(&stem).map_err(|e| Problem::in_file(&self.out, e.to_string()));
        let (program, budget) = match self.format {
            Format::Nxc => {
                let options = NxcOptions { program: name()?, wiring, log: self.log.clone(), display: self.display };
                let source = nxc::program(controller, origin, &options).map_err(refused)?;
                (source.into_bytes(), Some(nxc::budget(controller, &options)))
            }
            Format::Rxe => {
                name()?;
                (rxe::program(controller, &wiring).map_err(refused)?, Some(rxe::budget(controller)))
            }
            Format::Rust => (rust::module(controller, origin).map_err(refused)?.into_bytes(), None),
            Format::C => (c::header(controller, origin).map_err(refused)?.into_bytes(), None),
        };
        files::write(&self.out, program)?;
        let budget = budget.map_or(String::new(), |budget| format!("{budget}\n"));
        Ok(format!("{} written\n{budget}", self.out.display()))
    }
}
