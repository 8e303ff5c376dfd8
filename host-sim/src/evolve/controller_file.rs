//! `controller.toml`: a controller, and where it came from.

use std::path::Path;

use mindgap_core::controller::{Controller, InvalidController, TUPLES, Tuple};
use serde::{Deserialize, Serialize};
use toml::Spanned;

use crate::files;
use crate::problem::{Problem, Result};

/// A controller with its origin, as a file holds it.
#[derive(Clone, Debug, PartialEq)]
pub struct ControllerFile {
    /// The controller.
    pub controller: Controller,
    /// Where it came from, when the file says so.
    pub origin: Option<Origin>,
}

/// How a controller was evolved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    /// The simulator file.
    pub simulator: String,
    /// The scene file.
    pub scene: String,
    /// Its start, from 1.
    pub start: usize,
    /// The seed.
    pub seed: u64,
    /// Generations in all.
    pub generations: usize,
    /// Equation (3), summed over its runs, when the controller was chosen.
    pub fitness: f64,
    /// Share of fresh simulated runs that reached the target.
    pub success: f64,
}

impl ControllerFile {
    /// Reads a controller.
    ///
    /// # Errors
    /// When the file is missing or broken, has not exactly six tuples, or holds a number out of range.
    pub fn read(path: &Path) -> Result<Self> {
        let text = files::read_text(path)?;
        let file: ControllerTable<Spanned<Tuple>> = files::read_toml(path)?;
        let line = |tuple: usize| files::line_at(&text, file.tuple[tuple].span().start);
        let count = file.tuple.len();
        let Ok(tuples) = <[Tuple; TUPLES]>::try_from(file.tuple.iter().map(|t| *t.get_ref()).collect::<Vec<_>>())
        else {
            return Err(Problem::in_file(path, format!("has {count} tuples; a controller has exactly {TUPLES}")));
        };
        let controller = Controller { step_ms: file.step_ms, max_steps: file.max_steps, tuples };
        let problem = match controller.check() {
            Ok(()) => return Ok(ControllerFile { controller, origin: file.origin }),
            Err(InvalidController::Speed(t)) => Problem::at_line(path, line(t), "a speed lies outside -100..100"),
            Err(InvalidController::Threshold(t)) => {
                Problem::at_line(path, line(t), "the threshold lies outside 0..255 cm")
            }
            Err(InvalidController::StepTime) => Problem::in_file(path, "step_ms must be at least 1"),
            Err(InvalidController::StepLimit) => Problem::in_file(path, "max_steps must be at least 1"),
        };
        Err(problem)
    }

    /// Writes a controller.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        let Controller { step_ms, max_steps, tuples } = self.controller.clone();
        let form = ControllerTable { step_ms, max_steps, tuple: tuples.to_vec(), origin: self.origin.clone() };
        files::write(path, toml::to_string(&form).expect("numbers and text have a TOML form"))
    }
}

/// What an exporter prints of it.
impl From<&ControllerFile> for mindgap_controller_export::Origin {
    fn from(file: &ControllerFile) -> Self {
        let Some(origin) = file.origin.clone() else { return Self::default() };
        Self {
            simulator: Some(origin.simulator),
            scene: Some(origin.scene),
            start: Some(origin.start),
            seed: Some(origin.seed),
            generations: u32::try_from(origin.generations).ok(),
            fitness: Some(origin.fitness),
        }
    }
}

#[derive(Serialize, Deserialize)]
struct ControllerTable<T> {
    step_ms: u16,
    max_steps: u16,
    tuple: Vec<T>,
    #[serde(skip_serializing_if = "Option::is_none")]
    origin: Option<Origin>,
}
