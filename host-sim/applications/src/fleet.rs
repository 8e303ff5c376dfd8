//! A fleet: one diagnosis a robot, and what they say together. Which effect is how frequent, who stands out, which robots
//! have gaps of one kind, and what is common to all of them and therefore the simulator's fault.
//!
//! Robots come one after the other in the order of their names; what is kept of each is a [`tally`] of a few hundred bytes.

pub mod answer;
pub mod common;
pub mod frequency;
pub mod groups;
pub mod listing;
pub mod outliers;
pub mod robot;
pub mod source;
pub mod spread;
#[cfg(feature = "cloud")]
pub mod storage;
#[cfg(feature = "parquet")]
mod table;
pub mod tally;

use std::path::Path;

use serde::{Deserialize, Serialize};

pub use answer::Fleet;
use robot::Robot;
use source::Source;
use tally::Tally;

use mindgap_diagnosis::request::Request;
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::Logs;
use mindgap_workers as workers;

/// The file of the answer within a fleet's folder.
pub const ANSWER: &str = "fleet.json";
/// The table within it, where it is written.
pub const TABLE: &str = "robots.parquet";
/// The folder of the diagnoses within it.
pub const DIAGNOSES: &str = "diagnoses";

/// What came of one robot's logs.
#[derive(Serialize, Deserialize)]
struct Examined {
    name: String,
    /// What is kept of the diagnosis and its JSON, or why there is none.
    outcome: std::result::Result<(Robot, String), String>,
}

/// Diagnoses every robot of a fleet into a folder, and answers for all of them. `watch` is told how many robots are done,
/// of how many.
///
/// # Errors
/// When the robots cannot be listed, when none of them can be diagnosed, or when the folder cannot be written.
pub fn diagnose(
    source: &Source,
    request: &Request<'_>,
    folder: &Path,
    mut watch: impl FnMut(usize, usize),
) -> Result<Fleet> {
    let listing = source.listing()?;
    let diagnoses = folder.join(DIAGNOSES);
    if workers::is_first() {
        files::make_folder(&diagnoses)?;
    }
    #[cfg(feature = "parquet")]
    let mut table = table::Table::at(&folder.join(TABLE));
    let mut tally = Tally::new(request.method.catalogue);
    let count = listing.names.len();
    let work = |index: usize| Ok(examined(source, &listing.names[index], request));
    workers::in_order(count, work, |index, Examined { name, outcome }: Examined| {
        watch(index + 1, count);
        #[cfg(feature = "parquet")]
        table.add(&name, outcome.as_ref().map(|(robot, _)| robot))?;
        match outcome {
            Ok((robot, json)) => {
                files::write(&diagnoses.join(format!("{name}.json")), json)?;
                tally.add(name, &robot);
            }
            Err(reason) => {
                log::warn!("{name} is left out: {reason}");
                tally.refuse(name, reason);
            }
        }
        Ok(())
    })?;
    if let (true, Some(first)) = (tally.names.is_empty(), tally.refused.first()) {
        return Err(Error::new(format!("none of {count} robots can be diagnosed; the first one: {}", first.reason)));
    }
    let fleet = Fleet::of(tally, listing.left_out, request.method.seed);
    #[cfg(feature = "parquet")]
    table.close(&fleet.robots.iter().map(|robot| (robot.name.as_str(), robot.group)).collect())?;
    Ok(fleet)
}

fn examined(source: &Source, name: &str, request: &Request) -> Examined {
    let outcome = source.with_logs(name, |folder| {
        let logs = Logs::read(folder, |oddity| log::info!("{oddity}"))?;
        let answered = request.of(logs, |_| ()).map_err(|error| error.or_in_file(folder))?;
        let json = files::json(folder, &answered.findings.diagnosis)?;
        Ok((Robot::of(&answered), json))
    });
    Examined { name: name.into(), outcome: outcome.map_err(|error| error.to_string()) }
}
