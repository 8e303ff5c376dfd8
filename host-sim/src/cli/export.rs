//! `mindgap export`

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use mindgap_controller_export::names::BrickName;
use mindgap_controller_export::nxc::{self, NxcOptions};
use mindgap_controller_export::wiring::{MotorPort, SensorPort, Wiring};
use mindgap_controller_export::{ExportError, Origin, c, rust, rxe};

use crate::evolve::controller_file::ControllerFile;
use crate::files;
use crate::problem::{Problem, Result};

/// Turn a controller into an onboard program.
#[derive(Args)]
pub struct Export {
    /// The controller file.
    controller: PathBuf,
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
    /// Writes the program.
    pub fn run(&self) -> Result<String> {
        let file = ControllerFile::read(&self.controller)?;
        let refused = |e: ExportError| Problem::in_file(&self.controller, e.to_string());
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
