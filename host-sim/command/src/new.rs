//! `mindgap new`

use std::path::{Path, PathBuf};

use clap::Args;

use super::Run;
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_import::draft::{RobotDraft, SCENE};

/// Make a folder for a robot of your own: robot.toml and scene.toml to fill in, and a place for recordings.
#[derive(Args)]
pub struct New {
    /// The folder.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Where recordings go.
const RECORDINGS: &str = "recordings";
/// The files of the folder.
const FILES: [&str; 3] = ["robot.toml", "scene.toml", "README.md"];

impl Run for New {
    fn places(&self) -> Places {
        Places::default().filling([&self.folder])
    }

    fn run(&self) -> Result<String> {
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
            "{}: fill in robot.toml (and scene.toml, if there are walls), put what the robot recorded into {RECORDINGS}, then:\n{}",
            self.folder.display(),
            next(&self.folder)
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
         Drive all kinds of commands, slow and fast, straight and in turns, and change them every few steps. In every third \
         run hold each for ten steps and more: controllers do, and what is a fraction of a degree in one step adds up \
         there.\n\n\
         Then, one after the other (`mindgap import bag {}/{RECORDINGS}/*.mcap ...` for bags):\n\n{}",
        folder.display(),
        next(folder).lines().map(|line| format!("  {line}\n")).collect::<String>()
    )
}
