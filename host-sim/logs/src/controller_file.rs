//! `controller.toml`: a controller and its origin (docs/reference/formats.md).

use std::path::Path;

use mindgap_core::controller::{Controller, InvalidController, TUPLES, Tuple, When};
use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::Robot;
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};

/// The contents of `controller.toml`.
#[derive(Clone, Debug, PartialEq)]
pub struct ControllerFile {
    /// The controller.
    pub controller: Controller,
    /// The range sensor that each tuple asks; `None` for the robot's first.
    pub sensors: [Option<String>; TUPLES],
    /// How it was evolved, if the file states it.
    pub origin: Option<Origin>,
}

/// How a controller was evolved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    /// The simulator file.
    pub simulator: String,
    /// The scene file.
    pub scene: String,
    /// The start within the scene, from 1.
    pub start: usize,
    /// Seed of the evolution.
    pub seed: u64,
    /// Total number of generations.
    pub generations: usize,
    /// Fitness when the controller was selected: equation (3) of the paper, summed over its runs; none where it was selected
    /// by its chance of success.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fitness: Option<f64>,
    /// Success rate in simulated runs that played no part in the evolution, 0..=1.
    pub success: f64,
}

impl ControllerFile {
    /// Reads a controller.
    ///
    /// # Errors
    /// When the file cannot be read or parsed, does not have exactly six tuples, or holds a number out of range.
    pub fn read(path: &Path) -> Result<Self> {
        let text = files::read_text(path)?;
        let file: ControllerTable<Spanned<TupleTable>> = files::from_toml(path, &text)?;
        let line = |tuple: usize| files::line_at(&text, file.tuple[tuple].span().start);
        let count = file.tuple.len();
        let Ok(tuples) = <[&TupleTable; TUPLES]>::try_from(file.tuple.iter().map(Spanned::get_ref).collect::<Vec<_>>())
        else {
            return Err(Error::in_file(path, format!("has {count} tuples; a controller has exactly {TUPLES}")));
        };
        let sensors = tuples.map(|tuple| tuple.sensor.clone());
        let tuples = tuples.map(TupleTable::tuple);
        let controller = Controller { step_ms: file.step_ms, max_steps: file.max_steps, tuples };
        let error = match controller.check() {
            Ok(()) => return Ok(ControllerFile { controller, sensors, origin: file.origin }),
            Err(InvalidController::Speed(t)) => Error::at_line(path, line(t), "a speed lies outside -100..100"),
            Err(InvalidController::Threshold(t)) => {
                Error::at_line(path, line(t), "the threshold lies outside 0..255 cm")
            }
            Err(InvalidController::StepTime) => Error::in_file(path, "step_ms must be at least 1"),
            Err(InvalidController::StepLimit) => Error::in_file(path, "max_steps must be at least 1"),
            Err(error) => Error::in_file(path, error.to_string()),
        };
        Err(error)
    }

    /// Reads a controller that is to run on a robot.
    ///
    /// # Errors
    /// As [`ControllerFile::read`], or when its steps are not those of the robot.
    pub fn read_for(path: &Path, robot: &Robot) -> Result<Self> {
        let file = ControllerFile::read(path)?;
        file.check_for(robot).map_err(|error| error.or_in_file(path))?;
        Ok(file)
    }

    /// Checks that the controller is to run on a robot.
    ///
    /// # Errors
    /// When its steps are not those of the robot.
    pub fn check_for(&self, robot: &Robot) -> Result<()> {
        let (its, robots) = (self.controller.step_ms, robot.step_ms.round());
        if f64::from(its) == robots {
            return Ok(());
        }
        Err(Error::new(format!(
            "has step_ms = {its}, but the simulator's steps are {robots} ms: write step_ms = {robots}, or evolve it again"
        )))
    }

    /// Returns the range sensor that the controller asks on a robot with this first sensor.
    ///
    /// # Errors
    /// When its tuples ask several: a run, a search and a program each read one.
    pub fn sensor<'a>(&'a self, first: &'a str) -> Result<&'a str> {
        let asked = self.sensors.each_ref().map(|sensor| sensor.as_deref().unwrap_or(first));
        match asked.iter().position(|sensor| *sensor != asked[0]) {
            None => Ok(asked[0]),
            Some(other) => Err(Error::new(format!(
                "tuple 1 asks range sensor {:?} and tuple {} asks {:?}: all tuples must ask the same one",
                asked[0],
                other + 1,
                asked[other]
            ))),
        }
    }

    /// Checks that the controller asks the first range sensor of a robot.
    ///
    /// # Errors
    /// When a tuple asks another.
    pub fn check_asks(&self, first: &str) -> Result<()> {
        match self.sensor(first)? {
            asked if asked == first => Ok(()),
            asked => Err(Error::new(format!(
                "the controller asks range sensor {asked:?}, but the runs here are of the sensor {first:?}"
            ))),
        }
    }

    /// Writes a controller.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        let Controller { step_ms, max_steps, tuples } = self.controller.clone();
        let tuple = tuples.iter().zip(&self.sensors).map(|(tuple, sensor)| TupleTable::of(tuple, sensor.clone()));
        let table = ControllerTable { step_ms, max_steps, tuple: tuple.collect(), origin: self.origin.clone() };
        files::write(path, toml::to_string(&table).expect("numbers and text have a TOML form"))
    }
}

/// The part of the origin that exporters print.
impl From<&ControllerFile> for mindgap_controller_export::Origin {
    fn from(file: &ControllerFile) -> Self {
        let Some(origin) = file.origin.clone() else { return Self::default() };
        Self {
            simulator: Some(origin.simulator),
            scene: Some(origin.scene),
            start: Some(origin.start),
            seed: Some(origin.seed),
            generations: u32::try_from(origin.generations).ok(),
            fitness: origin.fitness,
        }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ControllerTable<T> {
    step_ms: u16,
    max_steps: u16,
    tuple: Vec<T>,
    #[serde(skip_serializing_if = "Option::is_none")]
    origin: Option<Origin>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct TupleTable {
    left: i8,
    right: i8,
    when: When,
    threshold_cm: i16,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sensor: Option<String>,
}

impl TupleTable {
    fn of(tuple: &Tuple, sensor: Option<String>) -> Self {
        let Tuple { left, right, when, threshold_cm } = *tuple;
        TupleTable { left, right, when, threshold_cm, sensor }
    }

    fn tuple(&self) -> Tuple {
        let TupleTable { left, right, when, threshold_cm, .. } = *self;
        Tuple { left, right, when, threshold_cm }
    }
}
