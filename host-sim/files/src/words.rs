//! What a parser says, in words of the file instead of the program's; and the known word that was meant by another.

/// Types of the program, and what they are to somebody who writes a file.
const TYPES: [(&str, &str); 11] = [
    ("expected i8", "expected a whole number from -128 to 127"),
    ("expected i16", "expected a whole number from -32768 to 32767"),
    ("expected u16", "expected a whole number from 0 to 65535"),
    ("expected u32", "expected a whole number"),
    ("expected u64", "expected a whole number"),
    ("expected usize", "expected a whole number"),
    ("expected f32", "expected a number"),
    ("expected f64", "expected a number"),
    ("expected a string", "expected a text in quotes"),
    ("expected a sequence", "expected a list"),
    ("expected a map", "expected a table"),
];
/// What is found instead, likewise.
const FOUND: [(&str, &str); 7] = [
    ("invalid type: string", "found the text"),
    ("invalid type: floating point", "found the number"),
    ("invalid type: integer", "found the number"),
    ("invalid type: boolean", "found"),
    ("invalid type: sequence", "found a list (tables of which there are several have two brackets, others one)"),
    ("invalid type: map", "found a table (tables of which there are several have two brackets, as [[obstacle]])"),
    ("invalid value: integer", "found the number"),
];

/// Words that are this much alike are taken for each other, as clap does with options.
const ALIKE: f64 = 0.7;

/// "; did you mean X?" where one of the known words is like this one; else nothing.
pub fn did_you_mean<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let likeness = |other: &'a str| (strsim::jaro(word, other), other);
    let nearest = known.into_iter().map(likeness).max_by(|a, b| a.0.total_cmp(&b.0));
    let nearest = nearest.filter(|(likeness, _)| *likeness > ALIKE);
    nearest.map_or_else(String::new, |(_, known)| format!("; did you mean {known}?"))
}

/// What a TOML parser says, in one line.
pub fn of_toml(message: &str) -> String {
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

/// That a key is not known, and which are.
fn unknown_key(words: &str) -> Option<String> {
    let (key, known) = words.strip_prefix("unknown field ")?.split_once(", expected ")?;
    let known = known.strip_prefix("one of ").unwrap_or(known);
    let names = known.split(", ").map(|name| name.trim_matches('`'));
    let meant = did_you_mean(key.trim_matches('`'), names);
    Some(format!("the key {key} is not known; known are {known}{meant}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_are_those_of_the_file() {
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
                "the key `obstacles` is not known; known are `arena`, `obstacle`; did you mean obstacle?",
            ),
            ("expected newline", "expected newline"),
        ] {
            assert_eq!(of_toml(message), words);
        }
    }

    #[test]
    fn the_word_that_was_meant_is_the_most_alike() {
        let known = ["slip", "slope", "latency"];
        assert_eq!(did_you_mean("slipp", known), "; did you mean slip?");
        assert_eq!(did_you_mean("latencies", known), "; did you mean latency?");
        assert_eq!(did_you_mean("compass", known), "");
        assert_eq!(did_you_mean("slip", []), "");
    }
}
