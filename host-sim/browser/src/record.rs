//! `mindgap record`

use std::path::Path;

use mindgap_built_in_robot::{ActiveEffect, Driving, Effect, default_robot, record_driving, run_script, training_room};
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::{Logs, Run};
use serde::{Deserialize, Serialize};

use crate::drive::Drives;
use crate::report::Answer;

/// Records logs of the built-in robot under random commands.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// Number of runs.
    runs: usize,
    /// Steps per run.
    steps: usize,
    /// Faults, as ID=STRENGTH.
    effects: Vec<String>,
    /// Random seed.
    seed: u64,
}

/// A fault that can be chosen.
#[derive(Serialize)]
struct Fault {
    id: &'static str,
    /// What it is.
    about: &'static str,
    /// Unit of its strength.
    unit: &'static str,
    lowest: f64,
    highest: f64,
    /// A strength that is clearly visible in logs.
    default: f64,
    /// Whether the diagnosis knows an effect of this name.
    is_known: bool,
}

impl Record {
    /// Records the logs.
    ///
    /// # Errors
    /// When an effect is not known or out of its range.
    pub fn answer(&self) -> Result<Answer> {
        let effects = self.effects.iter().map(|text| text.parse::<ActiveEffect>().map_err(Error::new));
        let effects = effects.collect::<Result<Vec<_>>>()?;
        let amount = [self.runs, self.steps];
        let (robot, scene) = (default_robot(), training_room());
        let logs = record_driving(&Driving::MIXED, &robot, &scene, amount, &effects, self.seed)?;
        // The same commands from the same places, by a sound robot.
        let sound = |run: &Run| {
            let start = run.rows.iter().find_map(|row| row.pose);
            let driven = run_script(&robot, &scene, &[], run, start, self.seed)?;
            Ok(Run { name: run.name.clone(), rows: driven.points.into_iter().map(|point| point.row).collect() })
        };
        let runs = logs.runs.iter().map(sound).collect::<Result<Vec<_>>>()?;
        let sound = Drives::of(&Logs { robot, scene: scene.clone(), runs });
        let drives = Some(Drives::of(&logs));
        Ok(Answer { drives, sound_drives: Some(sound), files: Some(logs.to_files()), ..Answer::default() })
    }
}

/// Returns the faults of the built-in robot as JSON.
///
/// # Errors
/// When JSON cannot represent them.
pub fn faults() -> Result<Answer> {
    let fault = |effect: Effect| {
        let range = effect.strength_range();
        Fault {
            id: effect.id(),
            about: effect.about(),
            unit: range.unit,
            lowest: range.lowest,
            highest: range.highest,
            default: range.default,
            is_known: effect.in_table(),
        }
    };
    let faults: Vec<Fault> = Effect::all().map(fault).collect();
    Ok(Answer { json: Some(files::json(Path::new("faults.json"), &faults)?), ..Answer::default() })
}
