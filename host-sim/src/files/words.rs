//! What a parser says, in words of the file instead of the program's.

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
    Some(format!("the key {key} is not known; known are {known}"))
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
                "the key `obstacles` is not known; known are `arena`, `obstacle`",
            ),
            ("expected newline", "expected newline"),
        ] {
            assert_eq!(of_toml(message), words);
        }
    }
}
