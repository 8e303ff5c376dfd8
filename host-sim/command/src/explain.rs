//! `mindgap explain`

mod entry;
mod findings;
mod terms;
mod topic;
mod verdicts;

use clap::Args;

use super::Run;
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Executor;
use topic::{Kind, Topic};

/// Explain an effect, a finding, a verdict or a term: what it is, what imitates it, and how to check it.
#[derive(Args)]
pub struct Explain {
    /// Id or term as in diagnosis.json, loop.json or a report; all ids are listed if it is omitted.
    id: Option<String>,
    /// Print the catalogue of all effects as Markdown.
    #[arg(long, conflicts_with = "id")]
    markdown: bool,
}

impl Run for Explain {
    fn places(&self) -> Places {
        Places::default()
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let topics = topic::all();
        let Some(id) = &self.id else {
            return Ok(if self.markdown { markdown(&topics) } else { list(&topics) });
        };
        let known = topics.iter().map(|topic| topic.id);
        let found = topics.iter().find(|topic| topic.id == id);
        let unknown = || format!("{id} is not an effect, finding, verdict or term{}", files::did_you_mean(id, known));
        found.map(Topic::text).ok_or_else(|| Error::new(unknown()))
    }
}

/// Returns the ids of all topics by kind.
fn list(topics: &[Topic]) -> String {
    let of_kind = |kind: Kind| {
        let ids: Vec<&str> = topics.iter().filter(|topic| topic.kind == kind).map(|topic| topic.id).collect();
        format!("{}s: {}\n", kind.name(), ids.join(", "))
    };
    Kind::ALL.map(of_kind).concat()
}

/// Returns the catalogue of effects as a page in Markdown.
fn markdown(topics: &[Topic]) -> String {
    let effects: String = topics.iter().filter(|topic| topic.kind == Kind::Effect).map(Topic::markdown).collect();
    format!(
        "# Effects\n\nEverything that a diagnosis can name, with its parameters in each variant. `mindgap explain ID` prints \
         the same, and explains findings, verdicts and terms as well.\n{effects}"
    )
}
