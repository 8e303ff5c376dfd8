//! The options `--patch` and `--engine`: causes written into copies of model files.

use std::path::PathBuf;

use clap::Args;

use super::choices::{ENGINES, one_of};
use super::kinds;
use mindgap_diagnosis::Findings;
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_logs::Robot;
use mindgap_pages::diagnosis::comparison::Comparison;
use mindgap_patch::cause::Cause;
use mindgap_patch::diff::diff;
use mindgap_patch::engine::Engine;
use mindgap_patch::model::Model;
use mindgap_patch::patch::{Patch, Patched, patch};

/// The options of commands that patch model files.
#[derive(Args)]
pub struct PatchOptions {
    /// Write a copy of a model file with its parameters corrected for the causes found: URDF, SDF, MJCF, Webots world or PROTO,
    /// ROS controller YAML, or robot.toml; repeatable.
    #[arg(long, value_name = "MODEL=OUT", value_parser = model_and_out)]
    patch: Vec<(PathBuf, PathBuf)>,
    /// Simulator or physics engine that reads the patched file; tags that it ignores are not changed.
    #[arg(long, value_name = "NAME", value_parser = one_of::<Engine>(ENGINES), requires = "patch")]
    engine: Option<Engine>,
}

/// Models, each with the file to write.
pub type Models = Vec<(Model, PathBuf)>;

fn model_and_out(text: &str) -> std::result::Result<(PathBuf, PathBuf), String> {
    match text.split_once('=') {
        Some((model, out)) if !model.is_empty() && !out.is_empty() => Ok((model.into(), out.into())),
        _ => Err("expected MODEL=OUT".into()),
    }
}

impl PatchOptions {
    /// Adds what is read and written.
    pub fn places(&self, places: Places) -> Places {
        let (models, outs): (Vec<&PathBuf>, Vec<&PathBuf>) = self.patch.iter().map(|(model, out)| (model, out)).unzip();
        places.reading(models).writing(outs, kinds::UNSIGNED)
    }

    /// Returns whether a file is to be patched.
    pub fn is_given(&self) -> bool {
        !self.patch.is_empty()
    }

    /// Reads and checks the models of a robot.
    ///
    /// # Errors
    /// As [`Model::new`], or if a file cannot be read.
    pub fn models(&self, robot: &Robot) -> Result<Models> {
        let read =
            |(path, out): &(PathBuf, PathBuf)| Ok((Model::new(path, files::read_raw_text(path)?, robot)?, out.clone()));
        self.patch.iter().map(read).collect()
    }

    /// Returns the models with the causes of a diagnosis in their tags.
    pub fn patched(&self, models: &Models, findings: &Findings) -> Patched {
        patch(models, &Cause::all(findings), &findings.robot, self.engine)
    }
}

/// Writes patched files; one without a patch is a copy.
///
/// # Errors
/// If a file cannot be written.
pub fn write(models: &Models, patched: &Patched) -> Result<()> {
    models.iter().zip(&patched.texts).try_for_each(|((_, out), text)| files::write(out, text))
}

/// Returns what was patched and what was not, for a page.
pub fn on_page(patched: &Patched) -> Comparison<'_> {
    Comparison { patches: &patched.patches, not_patched: &patched.not_patched, ..Comparison::default() }
}

/// Returns what was patched and what was not, for the terminal: a diff per file with its reasons, and a line per other cause.
pub fn text(models: &Models, patched: &Patched) -> String {
    let mut text = String::new();
    for ((model, out), new) in models.iter().zip(&patched.texts) {
        let patches: Vec<&Patch> = patched.patches.iter().filter(|patch| patch.file == *out).collect();
        let names = [model.path.display().to_string(), out.display().to_string()];
        text += &match patches.as_slice() {
            [] => format!("{}: nothing to patch; {} is a copy\n", names[0], names[1]),
            _ => diff((&names[0], &model.text), (&names[1], new), &patches),
        };
    }
    for not in &patched.not_patched {
        text += &format!("Not patched: {}: {}\n", not.effect, not.reason);
        if not.snippet.is_some() {
            text += "  A ROS 2 node that does it is in the JSON (snippet).\n";
        }
    }
    patched.notes.iter().for_each(|note| text += &format!("Note: {note}\n"));
    text
}
