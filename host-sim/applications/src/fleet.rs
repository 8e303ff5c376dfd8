//! A fleet: one diagnosis per robot, and joint statistics: prevalence of effects, outliers, groups of robots with similar
//! gaps, and effects common to all robots, which are errors of the simulator.
//!
//! Robots are processed in the order of their names; a [`tally`] keeps a few hundred bytes per robot.

pub mod answer;
pub mod common;
pub mod frequency;
pub mod groups;
mod listing;
pub mod outliers;
pub mod robot;
pub mod spread;
#[cfg(feature = "parquet")]
mod table;
pub mod tally;

use std::path::Path;

use serde::{Deserialize, Serialize};

pub use answer::Fleet;
use listing::Listing;
use robot::Robot;
use tally::Tally;

use mindgap_diagnosis::request::Request;
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::{self, Executor};
use mindgap_logs::Logs;

/// File of the results in a fleet's folder.
pub const ANSWER: &str = "fleet.json";
/// File of the table in a fleet's folder, if it is written.
pub const TABLE: &str = "robots.parquet";
/// Folder of the diagnoses in a fleet's folder.
pub const DIAGNOSES: &str = "diagnoses";

/// The result for one robot.
#[derive(Serialize, Deserialize)]
struct Examined {
    name: String,
    /// Summary and JSON of the diagnosis, or the reason why there is none.
    outcome: std::result::Result<(Robot, String), String>,
}

/// Diagnoses every robot of a fleet, one per folder in `logs`, writes the diagnoses to `folder`, and returns the joint
/// results. `watch` is called with the number of finished robots and the total.
///
/// # Errors
/// If the robots cannot be listed, none of them can be diagnosed, or the folder cannot be written.
pub fn diagnose(
    executor: &dyn Executor,
    logs: &Path,
    request: &Request<'_>,
    folder: &Path,
    mut watch: impl FnMut(usize, usize),
) -> Result<Fleet> {
    let listing = Listing::of(logs)?;
    let diagnoses = folder.join(DIAGNOSES);
    if executor.is_first() {
        files::make_folder(&diagnoses)?;
    }
    #[cfg(feature = "parquet")]
    let mut table = table::Table::at(&folder.join(TABLE));
    let mut tally = Tally::new(request.method.catalogue);
    let count = listing.names.len();
    let work = |index: usize| Ok(examined(logs, &listing.names[index], request));
    executor::in_order(executor, count, work, |index, Examined { name, outcome }: Examined| {
        watch(index + 1, count);
        #[cfg(feature = "parquet")]
        table.add(&name, outcome.as_ref().map(|(robot, _)| robot))?;
        match outcome {
            Ok((robot, json)) => {
                files::write(&diagnoses.join(format!("{name}.json")), json)?;
                tally.add(name, &robot);
            }
            Err(reason) => {
                log::warn!("{name} is excluded: {reason}");
                tally.refuse(name, reason);
            }
        }
        Ok(())
    })?;
    if let (true, Some(first)) = (tally.names.is_empty(), tally.refused.first()) {
        return Err(Error::new(format!("none of {count} robots can be diagnosed; the first: {}", first.reason)));
    }
    let fleet = Fleet::of(tally, listing.left_out, request.method.seed);
    #[cfg(feature = "parquet")]
    table.close(&fleet.robots.iter().map(|robot| (robot.name.as_str(), robot.group)).collect())?;
    Ok(fleet)
}

fn examined(logs: &Path, name: &str, request: &Request) -> Examined {
    let folder = logs.join(name);
    let diagnosed = || -> Result<(Robot, String)> {
        let logs = Logs::read(&folder, |oddity| log::info!("{oddity}"))?;
        if logs.sensors().are_several() {
            let what = "has several range sensors, and a fleet is compared by one: diagnose this robot by itself";
            return Err(Error::in_file(&folder, what));
        }
        let answered = request.of(logs, |_| ()).map_err(|error| error.or_in_file(&folder))?;
        let json = files::json(&folder, &answered.findings.diagnosis)?;
        Ok((Robot::of(&answered), json))
    };
    Examined { name: name.into(), outcome: diagnosed().map_err(|error| error.to_string()) }
}
