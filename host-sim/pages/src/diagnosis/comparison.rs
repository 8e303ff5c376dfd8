//! What was written into model files, whether it was proved, and runs of both sides with the same commands.

use maud::{Markup, html};

use crate::document::{Section, open_table};
use mindgap_applications::compare::pairs::{self, Pair};
use mindgap_applications::compare::verify::Verification;
use mindgap_logs::{Logs, Run};
use mindgap_patch::patch::{NotPatched, Patch};

/// A comparison of a user's own simulator with the robot, beyond its diagnosis.
#[derive(Clone, Copy, Default)]
pub struct Comparison<'a> {
    /// Runs of both sides with the same commands.
    pub pairs: &'a [Pair],
    /// The runs of the simulator, if they were recorded.
    pub simulator: Option<&'a Logs>,
    /// Changed tags.
    pub patches: &'a [Patch],
    /// Causes that have no tag in a model file.
    pub not_patched: &'a [NotPatched],
    /// Path ends before and after the patch.
    pub verification: &'a [Verification],
}

impl<'a> Comparison<'a> {
    /// Returns the simulator's recording of the commands of a robot's run.
    pub fn recorded(&self, run: &Run) -> Option<&'a Run> {
        pairs::recorded(self.pairs, self.simulator?, run)
    }
}

/// Returns the sections that have something to show.
pub fn sections(comparison: &Comparison) -> Vec<Section> {
    let Comparison { pairs, patches, not_patched, verification, .. } = comparison;
    let mut sections = Vec::new();
    if !patches.is_empty() || !not_patched.is_empty() {
        sections.push(Section {
            id: "patch",
            title: "What to change in the model file",
            body: patch(patches, not_patched),
        });
    }
    if !verification.is_empty() {
        sections.push(Section {
            id: "proof",
            title: "Whether the patch brings path ends nearer",
            body: proof(verification),
        });
    }
    if !pairs.is_empty() {
        let row = |pair: &Pair| {
            [pair.real.clone(), pair.simulated.clone(), format!("{:.1}", pair.mean_cm), format!("{:.1}", pair.end_cm)]
        };
        let header = ["robot's run", "simulator's run", "mean distance (cm)", "distance of ends (cm)"];
        let body = html! {
            p { "These runs drove the same commands. They are aligned at their starts; the replay shows both." }
            (open_table(header, &pairs.iter().map(row).collect::<Vec<_>>()))
        };
        sections.push(Section { id: "pairs", title: "Run by run", body });
    }
    sections
}

fn patch(patches: &[Patch], not_patched: &[NotPatched]) -> Markup {
    let row = |patch: &Patch| {
        let file = patch.file.display().to_string();
        [
            file,
            patch.tag.clone(),
            patch.old.clone(),
            patch.new.clone(),
            patch.unit.into(),
            patch.effect.clone(),
            patch.reason.clone(),
        ]
    };
    let header = ["file", "tag", "old", "new", "unit", "cause", "reason"];
    html! {
        @if !patches.is_empty() { (open_table(header, &patches.iter().map(row).collect::<Vec<_>>())) }
        @for not in not_patched {
            p { "Not patched: " b { (not.effect) } ": " (not.reason) "." }
            @if let Some(snippet) = &not.snippet { pre { (snippet) } }
        }
    }
}

fn proof(verification: &[Verification]) -> Markup {
    let row = |length: &Verification| {
        [length.steps.to_string(), format!("{:.1}", length.before_cm), format!("{:.1}", length.after_cm)]
    };
    let header = ["steps", "before the patch (cm)", "after it (cm)"];
    html! {
        (open_table(header, &verification.iter().map(row).collect::<Vec<_>>()))
        @if verification.iter().any(|length| length.withdrawn) { p { "The patch was withdrawn." } }
    }
}
