//! Cells of tables: numbers with decimal points or commas, and words for a missing number.

/// Texts that stand for a missing number, in lower case.
const MISSING: [&str; 22] = [
    "",
    "nan",
    "-nan",
    "na",
    "n/a",
    "#n/a",
    "#na",
    "#nv",
    "#null!",
    "#value!",
    "#num!",
    "#div/0!",
    "#ref!",
    "null",
    "none",
    "nil",
    "-",
    "--",
    "?",
    "nan(ind)",
    "-nan(ind)",
    "<na>",
];
/// Number of characters of a cell that messages show.
const SHOWN: usize = 40;

/// Returns whether a cell says that a number is missing.
pub fn is_missing(cell: &str) -> bool {
    cell.len() < 10 && MISSING.contains(&cell.to_ascii_lowercase().as_str())
}

/// Parses a number with a decimal point or comma, and possibly separators of thousands.
pub fn number(cell: &str) -> Option<f64> {
    let parsed = cell.parse().or_else(|_| plain(cell).parse::<f64>());
    parsed.ok().filter(|value| !value.is_nan())
}

/// Returns the text of a number with a decimal point and a plain minus sign.
fn plain(cell: &str) -> String {
    let cell = cell.replace('\u{2212}', "-");
    match (cell.rfind(','), cell.rfind('.')) {
        (Some(comma), Some(point)) if comma < point => cell.replace(',', ""),
        (Some(_), Some(_)) => cell.replace('.', "").replacen(',', ".", 1),
        _ => cell.replacen(',', ".", 1),
    }
}

/// Returns the beginning of a cell, for messages.
pub fn shortened(cell: &str) -> String {
    match cell.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}...", &cell[..end]),
        None => cell.to_owned(),
    }
}
