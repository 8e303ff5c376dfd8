//! The table of effects in docs/reference/effects.md is the catalogue.

use std::path::Path;

use mindgap_models::effects::{CATALOGUE, Candidate, Parameter};

const HEADER: &str = "| effect | variant | parameters |\n| --- | --- | --- |\n";

fn row(candidate: Candidate) -> String {
    let parameter = |p: &Parameter| {
        let (name, has_side) = p.setting();
        let side = if has_side { "`side`, " } else { "" };
        match p.unit {
            unit if name == p.name && !unit.is_empty() => format!("`{name}` ({unit})"),
            _ => format!("{side}`{name}`"),
        }
    };
    let parameters: Vec<String> = candidate.variant.parameters.iter().map(parameter).collect();
    format!("| `{}` | `{}` | {} |\n", candidate.effect, candidate.variant.id, parameters.join(", "))
}

#[test]
fn the_documented_effects_are_those_of_the_catalogue() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/reference/effects.md");
    let document = std::fs::read_to_string(path).expect("docs/reference/effects.md is there");
    let table: String = Candidate::all(CATALOGUE).into_iter().map(row).collect();
    let expected = format!("{HEADER}{table}\n");
    assert!(document.contains(&expected), "docs/reference/effects.md has to hold this table:\n{expected}");
}
