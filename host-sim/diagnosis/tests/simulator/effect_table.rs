//! The table of effects in docs/formats.md is the catalogue.

use std::path::Path;

use mindgap_models::effects::{CATALOGUE, Candidate, Parameter};

const HEADER: &str = "| effect | variant | parameters |\n| --- | --- | --- |\n";

fn row(candidate: Candidate) -> String {
    let parameter = |p: &Parameter| match p.unit {
        "" => format!("`{}`", p.name),
        unit => format!("`{}` ({unit})", p.name),
    };
    let parameters: Vec<String> = candidate.variant.parameters.iter().map(parameter).collect();
    format!("| `{}` | `{}` | {} |\n", candidate.effect, candidate.variant.id, parameters.join(", "))
}

#[test]
fn the_documented_effects_are_those_of_the_catalogue() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/formats.md");
    let document = std::fs::read_to_string(path).expect("docs/formats.md is there");
    let table: String = Candidate::all(CATALOGUE).into_iter().map(row).collect();
    let expected = format!("{HEADER}{table}\n");
    assert!(document.contains(&expected), "docs/formats.md has to hold this table:\n{expected}");
}
