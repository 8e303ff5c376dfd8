//! `mindgap new`

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;

use super::check_free;
use crate::error::{Error, Result};
use crate::files;
use crate::import::draft::{RobotDraft, SCENE};

/// Make a folder for a robot of your own: robot.toml and scene.toml to fill in, and a place for recordings.
#[derive(Args)]
pub struct New {
    /// The folder.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Where recordings go.
const RECORDINGS: &str = "recordings";

impl New {
    /// Makes the folder and says what comes next.
    pub fn run(&self) -> Result<String> {
        check_free(&self.folder, false)?;
        let next = next(&self.folder);
        files::write_folder(&self.folder, |_| false, |fresh| {
            files::write(&fresh.join("robot.toml"), RobotDraft::blank().text())?;
            files::write(&fresh.join("scene.toml"), SCENE)?;
            files::write(&fresh.join("README.md"), readme(&self.folder))?;
            fs::create_dir(fresh.join(RECORDINGS))
                .map_err(|e| Error::in_file(&self.folder, format!("cannot be written: {e}")))
        })?;
        Ok(format!(
            "{}: fill in robot.toml (and scene.toml, if there are walls), put what the robot recorded into {RECORDINGS}, then:\n{next}",
            self.folder.display()
        ))
    }
}

/// The next three commands.
fn next(folder: &Path) -> String {
    let folder = folder.display();
    format!(
        "  mindgap import streams {folder}/{RECORDINGS}/*.csv --robot {folder}/robot.toml --scene {folder}/scene.toml --out \
         {folder}/logs\n  mindgap check {folder}/logs\n  mindgap diagnose kinematic {folder}/logs --html {folder}/gap.html\n"
    )
}

fn readme(folder: &Path) -> String {
    format!(
        "# A robot\n\n\
         - `robot.toml`: measures of the robot. What is marked FILL IN is not known yet.\n\
         - `scene.toml`: the walls where it drove; open ground as it stands.\n\
         - `{RECORDINGS}`: what it recorded, as it came: CSV files with commands and poses, or ROS 2 bags (MCAP).\n\n\
         Then, one after the other (`mindgap import bag {}/{RECORDINGS}/*.mcap ...` for bags):\n\n{}",
        folder.display(),
        next(folder).lines().map(|line| format!("  {line}\n")).collect::<String>()
    )
}
