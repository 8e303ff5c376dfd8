//! Which cause goes into which file, and why the others do not.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use super::cause::{Cause, Query};
use super::edit::{Change, applied};
use super::engine::Engine;
use super::model::Model;
use super::refusal;
use super::snippet;
use mindgap_logs::Robot;

/// A change of a tag.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Patch {
    /// The file that is written.
    pub file: PathBuf,
    /// Where the tag is: an XPath; for YAML, TOML and PROTO files a dotted path.
    pub tag: String,
    /// Its text before; empty if it was added.
    pub old: String,
    /// Its text afterwards.
    pub new: String,
    /// Unit of its numbers; empty if they have none.
    pub unit: &'static str,
    /// Id of the effect that it stands for.
    pub effect: String,
    /// 95 % interval of the number, in its unit, if known.
    pub ci95: Option<[f64; 2]>,
    /// Why, with the formula.
    pub reason: String,
}

/// A cause that is in no file.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct NotPatched {
    /// Id of the effect.
    pub effect: String,
    /// Why it is not written.
    pub reason: String,
    /// Lines for a driver that have the same effect, if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub snippet: Option<String>,
}

/// Patched files.
#[derive(Clone, Debug, Default)]
pub struct Patched {
    /// Text of each file, in the order of the models; a file without a patch is as it was.
    pub texts: Vec<String>,
    /// What was changed.
    pub patches: Vec<Patch>,
    /// What was not, and why.
    pub not_patched: Vec<NotPatched>,
    /// What engines add to the files by themselves.
    pub notes: Vec<String>,
}

/// Causes with a smaller share of the gap are not written.
const LEAST_SHARE: f64 = 0.05;

/// Writes causes into models. Each model goes to the file beside it. Every cause is written once, into the first model that has
/// a tag for it: two that stand for the same would count twice, or cancel. Without a model nothing is asked for.
pub fn patch(models: &[(Model, PathBuf)], causes: &[Cause], robot: &Robot, engine: Option<Engine>) -> Patched {
    if models.is_empty() {
        return Patched::default();
    }
    let mut current: Vec<Model> = models.iter().map(|(model, _)| model.clone()).collect();
    let (mut patches, mut not_patched) = (Vec::new(), Vec::new());
    for cause in causes {
        match write(&current, &Query { cause, robot, engine }) {
            Ok((index, changes)) => {
                let edits: Vec<_> = changes.iter().flat_map(|change| change.edits.clone()).collect();
                current[index].text = applied(&current[index].text, &edits);
                patches.extend(changes.into_iter().map(|change| of(change, &models[index].1, &cause.effect)));
            }
            Err(reason) => {
                let snippet = snippet::of(cause, robot);
                not_patched.push(NotPatched { effect: cause.effect.clone(), reason, snippet });
            }
        }
    }
    let notes = models.iter().flat_map(|(model, _)| model.notes(engine)).collect();
    Patched { texts: current.into_iter().map(|model| model.text).collect(), patches, not_patched, notes }
}

impl Patched {
    /// Takes all patches back, for a reason.
    pub fn withdraw(&mut self, models: &[(Model, PathBuf)], reason: &str) {
        self.texts = models.iter().map(|(model, _)| model.text.clone()).collect();
        for Patch { effect, .. } in self.patches.drain(..) {
            if !self.not_patched.iter().any(|not| not.effect == effect) {
                self.not_patched.push(NotPatched { effect, reason: reason.into(), snippet: None });
            }
        }
    }
}

/// Returns the first model that has tags for a cause, and the changes.
fn write(models: &[Model], query: &Query) -> Result<(usize, Vec<Change>), String> {
    if let Some(share) = query.cause.share.filter(|share| *share < LEAST_SHARE) {
        return Err(format!("it is {:.1} % of the gap, less than {:.0} %", 100.0 * share, 100.0 * LEAST_SHARE));
    }
    if let Some(sensor) = &query.cause.sensor {
        return Err(format!("it sits in range sensor {sensor}: only the first range sensor of a robot is patched"));
    }
    if let Some(reason) = refusal::of_any_format(&query.cause.effect) {
        return Err(reason.into());
    }
    let mut reasons: Vec<String> = Vec::new();
    for (index, model) in models.iter().enumerate() {
        match model.changes(query) {
            Ok(changes) if changes.iter().any(|change| !change.edits.is_empty()) => return Ok((index, changes)),
            Ok(_) => reasons.push("the file already says so".into()),
            Err(reason) if !reasons.contains(&reason) => reasons.push(reason),
            Err(_) => {}
        }
    }
    Err(reasons.join("; "))
}

fn of(change: Change, file: &Path, effect: &str) -> Patch {
    let Change { tag, old, new, unit, ci95, reason, .. } = change;
    Patch { file: file.into(), tag, old, new, unit, effect: effect.into(), ci95, reason }
}

#[cfg(test)]
mod tests;
