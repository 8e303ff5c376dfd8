//! Rewords parser messages for people who write files by hand, and suggests the known name closest to a misspelt one.

/// Rust types in parser messages, and how they are reported.
const TYPES: [(&str, &str); 11] = [
    ("expected i8", "expected a whole number from -128 to 127"),
    ("expected i16", "expected a whole number from -32768 to 32767"),
    ("expected u16", "expected a whole number from 0 to 65535"),
    ("expected u32", "expected a whole number"),
    ("expected u64", "expected a whole number"),
    ("expected usize", "expected a whole number"),
    ("expected f32", "expected a number"),
    ("expected f64", "expected a number"),
    ("expected a string", "expected text in quotes"),
    ("expected a sequence", "expected a list"),
    ("expected a map", "expected a table"),
];
/// What a parser found instead, and how it is reported.
const FOUND: [(&str, &str); 7] = [
    ("invalid type: string", "found the text"),
    ("invalid type: floating point", "found the number"),
    ("invalid type: integer", "found the number"),
    ("invalid type: boolean", "found"),
    ("invalid type: sequence", "found a list ([[name]] starts one of several tables, [name] a single one)"),
    ("invalid type: map", "found a table (one of several tables starts with two brackets, as in [[obstacle]])"),
    ("invalid value: integer", "found the number"),
];

/// Names at least this similar are suggested, as clap does for options.
const MIN_SIMILARITY: f64 = 0.7;

/// Returns "; did you mean X?" if a known name is similar to `word`, otherwise an empty text.
pub fn did_you_mean<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let similarity = |other: &'a str| (strsim::jaro(word, other), other);
    let nearest = known.into_iter().map(similarity).max_by(|a, b| a.0.total_cmp(&b.0));
    let nearest = nearest.filter(|(similarity, _)| *similarity > MIN_SIMILARITY);
    nearest.map_or_else(String::new, |(_, known)| format!("; did you mean {known}?"))
}

/// Rewords a TOML parser's message as one line.
pub fn toml_message(message: &str) -> String {
    let mut words = message.replace('\n', "; ");
    for (from, to) in FOUND {
        words = words.replace(from, to);
    }
    for (from, to) in TYPES {
        words = match words.strip_suffix(from) {
            Some(found) => format!("{found}{to}"),
            None => words,
        };
    }
    match words.split_once("expected struct ") {
        Some((found, _)) => format!("{found}expected a table"),
        None => unknown_key(&words).unwrap_or(words),
    }
}

/// Rewords the message for an unknown key.
fn unknown_key(words: &str) -> Option<String> {
    let (key, known) = words.strip_prefix("unknown field ")?.split_once(", expected ")?;
    let known = known.strip_prefix("one of ").unwrap_or(known);
    let names = known.split(", ").map(|name| name.trim_matches('`'));
    let suggestion = did_you_mean(key.trim_matches('`'), names);
    Some(format!("unknown key {key}; expected one of {known}{suggestion}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rust_types_are_reworded() {
        for (message, words) in [
            (
                "invalid type: string \"55\", expected i8",
                "found the text \"55\", expected a whole number from -128 to 127",
            ),
            (
                "invalid type: floating point `1.5`, expected u16",
                "found the number `1.5`, expected a whole number from 0 to 65535",
            ),
            ("invalid type: integer `3`, expected struct ArenaTable", "found the number `3`, expected a table"),
            (
                "unknown field `obstacles`, expected one of `arena`, `obstacle`",
                "unknown key `obstacles`; expected one of `arena`, `obstacle`; did you mean obstacle?",
            ),
            ("expected newline", "expected newline"),
        ] {
            assert_eq!(toml_message(message), words);
        }
    }

    #[test]
    fn most_similar_name_is_suggested() {
        let known = ["slip", "slope", "latency"];
        assert_eq!(did_you_mean("slipp", known), "; did you mean slip?");
        assert_eq!(did_you_mean("latencies", known), "; did you mean latency?");
        assert_eq!(did_you_mean("compass", known), "");
        assert_eq!(did_you_mean("slip", []), "");
    }
}
