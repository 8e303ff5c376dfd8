//! What can be explained, as text and Markdown.

use mindgap_diagnosis::budget::{SCATTER, UNEXPLAINED};
use mindgap_models::effects::{CATALOGUE, Effect, Parameter, Variant};
use mindgap_pages::words::{self, Cause};

use super::entry::Entry;
use super::findings::FINDINGS;
use super::terms::TERMS;
use super::verdicts::VERDICTS;

/// An effect, a finding, a verdict or a term with its explanation.
pub struct Topic {
    /// Id as in JSON.
    pub id: &'static str,
    /// Kind of the topic.
    pub kind: Kind,
    name: &'static str,
    what: &'static str,
    in_logs: Option<&'static str>,
    imitated_by: String,
    check: &'static str,
    /// Parameters of each variant of an effect.
    variants: Vec<String>,
}

/// Kind of a topic.
#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    /// An effect of the catalogue.
    Effect,
    /// A part of a budget that is not an effect.
    Part,
    /// A defect of logs.
    Finding,
    /// The verdict of a diagnosis or a loop.
    Verdict,
    /// A word of reports and files.
    Term,
}

/// Returns all topics: effects, other parts of a budget, findings, verdicts, terms.
pub fn all() -> Vec<Topic> {
    let effects = CATALOGUE.iter().copied().map(of_effect);
    let parts = [SCATTER, UNEXPLAINED].into_iter().filter_map(of_part);
    let findings = FINDINGS.iter().map(|entry| of_entry(Kind::Finding, entry));
    let verdicts = VERDICTS.iter().map(|entry| of_entry(Kind::Verdict, entry));
    let terms = TERMS.iter().map(|entry| of_entry(Kind::Term, entry));
    effects.chain(parts).chain(findings).chain(verdicts).chain(terms).collect()
}

impl Kind {
    /// All kinds in the order of [`all`].
    pub const ALL: [Kind; 5] = [Kind::Effect, Kind::Part, Kind::Finding, Kind::Verdict, Kind::Term];

    /// Returns the name of the kind.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Effect => "effect",
            Kind::Part => "part",
            Kind::Finding => "finding",
            Kind::Verdict => "verdict",
            Kind::Term => "term",
        }
    }
}

impl Topic {
    /// Returns the explanation as text for the terminal.
    pub fn text(&self) -> String {
        let Topic { id, kind, name, what, .. } = self;
        let title = if *name == *id { String::new() } else { format!(", {name}") };
        let lines = self.lines().map(|(label, line)| format!("  {label:<14}{line}\n"));
        format!("{id} ({}{title})\n{what}\n{}", kind.name(), lines.collect::<String>())
    }

    /// Returns the explanation as a section in Markdown.
    pub fn markdown(&self) -> String {
        let Topic { id, name, what, .. } = self;
        let lines = self.lines().map(|(label, line)| format!("- {label}: {line}\n"));
        format!("\n## {id}\n\n{name}: {what}\n\n{}", lines.collect::<String>())
    }

    fn lines(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let in_logs = self.in_logs.map(|line| ("in logs", line));
        let imitated_by = Some(("imitated by", self.imitated_by.as_str())).filter(|(_, line)| !line.is_empty());
        let variants = self.variants.iter().map(|line| ("variant", line.as_str()));
        in_logs.into_iter().chain(imitated_by).chain([("check", self.check)]).chain(variants)
    }
}

fn of_effect(effect: &'static Effect) -> Topic {
    Topic {
        id: effect.id,
        kind: Kind::Effect,
        name: effect.name,
        what: effect.what,
        in_logs: Some(effect.in_logs),
        imitated_by: effect.imitated_by.join(", "),
        check: effect.check,
        variants: effect.variants.iter().map(variant).collect(),
    }
}

fn of_part(id: &'static str) -> Option<Topic> {
    let Cause { name, what, check } = words::cause(id, CATALOGUE)?;
    Some(Topic {
        id,
        kind: Kind::Part,
        name,
        what,
        in_logs: None,
        imitated_by: String::new(),
        check,
        variants: Vec::new(),
    })
}

fn of_entry(kind: Kind, &Entry { id, what, imitated_by, check }: &Entry) -> Topic {
    let imitated_by = imitated_by.into();
    Topic { id, kind, name: id, what, in_logs: None, imitated_by, check, variants: Vec::new() }
}

/// Returns a variant with its parameters, named as in files and answers, and their units.
fn variant(variant: &Variant) -> String {
    let parameters: Vec<String> = variant.parameters.iter().map(parameter).collect();
    format!("{}: {}", variant.id, parameters.join(", "))
}

fn parameter(parameter: &Parameter) -> String {
    let (name, has_side) = parameter.setting();
    let side = if has_side { "side (left or right), " } else { "" };
    match parameter.reported_unit() {
        "" => format!("{side}{name}"),
        unit => format!("{side}{name} ({unit})"),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_topic_has_its_own_id_and_full_sentences() {
        let topics = all();
        let ids: BTreeSet<&str> = topics.iter().map(|topic| topic.id).collect();
        assert_eq!(ids.len(), topics.len());
        for topic in &topics {
            assert!(topic.what.ends_with('.') && topic.check.ends_with('.'), "{}", topic.id);
        }
    }
}
