//! `mindgap new`

use std::path::{Path, PathBuf};

use clap::Args;

use super::Run;
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_import::draft::{RobotDraft, SCENE};

/// Create a folder for your robot: robot.toml and scene.toml to fill in, and a folder for recordings.
#[derive(Args)]
pub struct New {
    /// Folder to create.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Folder of the recordings.
const RECORDINGS: &str = "recordings";
/// Files in the folder.
const FILES: [&str; 3] = ["robot.toml", "scene.toml", "README.md"];

impl Run for New {
    fn places(&self) -> Places {
        Places::default().filling([&self.folder])
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let contents = [RobotDraft::blank().text(), SCENE.to_owned(), readme(&self.folder)];
        let has_recordings = self.folder.join(RECORDINGS).is_dir();
        files::write_folder(
            &self.folder,
            |name| FILES.contains(&name),
            |fresh| {
                if !has_recordings {
                    files::make_folder(&fresh.join(RECORDINGS))?;
                }
                FILES.iter().zip(contents).try_for_each(|(name, content)| files::write(&fresh.join(name), content))
            },
        )?;
        Ok(format!(
            "{}: fill in robot.toml (and scene.toml, if there are walls), put the robot's recordings into {RECORDINGS}, then:\n{}",
            self.folder.display(),
            next(&self.folder)
        ))
    }
}

/// Returns the next three commands.
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
         - `robot.toml`: dimensions of the robot. Values marked FILL IN are not known yet.\n\
         - `scene.toml`: the walls where it drove; empty means open ground.\n\
         - `{RECORDINGS}`: its recordings, unchanged: CSV files with commands and poses, or bags of ROS.\n\n\
         Drive all kinds of commands, slow and fast, straight and in turns, and change them every few steps. In every third \
         run, hold each command for ten steps or more: controllers do so, and errors of a fraction of a degree per step \
         add up there.\n\n\
         Then run these commands (`mindgap import bag {}/{RECORDINGS}/*.mcap ...` for bags):\n\n{}",
        folder.display(),
        next(folder).lines().map(|line| format!("  {line}\n")).collect::<String>()
    )
}
