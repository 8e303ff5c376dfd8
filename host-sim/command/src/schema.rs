//! `mindgap schema`, generated from the types of the outputs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, SchemaGenerator};
use serde_json::Value;

use super::{Run, adapt, brick, compare, demo, diagnose, drive, evolve, export, import, info, record, train};
use mindgap_applications::bundle::About;
use mindgap_applications::challenge::score::Score;
use mindgap_applications::closed_loop::state::State;
use mindgap_applications::fleet::Fleet;
use mindgap_diagnosis::survey::Survey;
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Executor;
use mindgap_learning::crosscheck::Crosscheck;
use mindgap_learning::evaluation::accuracy::Evaluation;
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::monitor::findings::Findings;
use mindgap_models::simulator::rollout_report::RolloutReport;

/// Print the JSON Schema of an output, or write those of all outputs.
#[derive(Args)]
pub struct Schema {
    /// Name of the output; all names are listed if it is omitted.
    output: Option<String>,
    /// Write the schemas of all outputs to this folder.
    #[arg(long, value_name = "DIR", conflicts_with = "output")]
    out: Option<PathBuf>,
}

/// Generates the schema of an output.
type Generate = fn(SchemaGenerator) -> schemars::Schema;

/// All outputs in JSON, by the name of the command, or of the file.
const OUTPUTS: &[(&str, Generate)] = &[
    ("adapt", of::<adapt::AdaptResults>),
    ("brick", of::<brick::results::BrickResults>),
    ("bundle", of::<About>),
    ("challenge-score", of::<Score>),
    ("check", of::<Survey>),
    ("compare", of::<compare::CompareResults>),
    ("crosscheck", of::<Crosscheck>),
    ("demo", of::<demo::DemoResults>),
    ("diagnose", of::<diagnose::DiagnoseResults>),
    ("drive", of::<drive::DriveResults>),
    ("evaluate", of::<Evaluation>),
    ("evolve", of::<evolve::EvolveResults>),
    ("export", of::<export::ExportResults>),
    ("fleet", of::<Fleet>),
    ("import", of::<import::ImportResults>),
    ("import-recordings", of::<import::recordings::RecordingsResults>),
    ("info", of::<info::InfoResults>),
    ("loop", of::<State>),
    ("monitor", of::<Findings>),
    ("record", of::<record::RecordResults>),
    ("simulate", of::<RolloutReport>),
    ("simulator", of::<Simulator>),
    ("train", of::<train::TrainResults>),
];

impl Run for Schema {
    fn places(&self) -> Places {
        Places::default().filling(&self.out)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        if let Some(folder) = &self.out {
            return write(folder);
        }
        let names = || OUTPUTS.iter().map(|(name, _)| *name);
        let Some(output) = &self.output else {
            return Ok(format!("outputs: {}\n", names().collect::<Vec<_>>().join(", ")));
        };
        let found = OUTPUTS.iter().find(|(name, _)| name == output);
        let unknown = || format!("{output} is not an output in JSON{}", files::did_you_mean(output, names()));
        found.map(|(_, generate)| text(*generate)).ok_or_else(|| Error::new(unknown()))
    }
}

/// Writes the schemas of all outputs.
fn write(folder: &Path) -> Result<String> {
    let schemas = OUTPUTS.iter().map(|(name, generate)| (format!("{name}.json"), text(*generate)));
    let schemas: BTreeMap<String, String> = schemas.collect();
    files::write_folder(
        folder,
        |name| schemas.contains_key(name),
        |fresh| schemas.iter().try_for_each(|(name, text)| files::write(&fresh.join(name), text)),
    )?;
    Ok(format!("{} schemas written to {}\n", schemas.len(), folder.display()))
}

fn text(generate: Generate) -> String {
    format!("{:#}\n", schema(generate))
}

/// Returns the schema of what is written.
fn schema(generate: Generate) -> Value {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    generate(settings.with_transform(RecursiveTransform(in_plain_words)).into_generator()).to_value()
}

fn of<T: JsonSchema>(generator: SchemaGenerator) -> schemars::Schema {
    generator.into_root_schema_for::<T>()
}

/// Makes one line of each description, without its examples, and allows fields that are added later.
fn in_plain_words(schema: &mut schemars::Schema) {
    if let Some(Value::String(description)) = schema.get_mut("description") {
        let prose = description.split("```").next().unwrap_or_default();
        *description = prose.split_whitespace().collect::<Vec<_>>().join(" ");
    }
    if schema.get("additionalProperties") == Some(&Value::Bool(false)) {
        schema.remove("additionalProperties");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_field_is_described_in_plain_words() {
        let is_plain = |text: &str| text.ends_with('.') && !text.contains("[`");
        for (name, generate) in OUTPUTS {
            let schema = schema(*generate);
            let unclear =
                fields(&schema).into_iter().filter(|(_, it)| !it["description"].as_str().is_some_and(is_plain));
            assert_eq!(unclear.collect::<Vec<_>>(), [], "{name}");
        }
    }

    /// Returns the fields of all objects in a schema.
    fn fields(schema: &Value) -> Vec<(&str, &Value)> {
        let within = schema.as_object().into_iter().flatten().flat_map(|(_, part)| fields(part));
        let listed = schema.as_array().into_iter().flatten().flat_map(fields);
        let own = schema.get("properties").and_then(Value::as_object).into_iter().flatten();
        own.map(|(name, field)| (name.as_str(), field)).chain(within).chain(listed).collect()
    }
}
