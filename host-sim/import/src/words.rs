//! The words of a name.

/// Splits a name into lower-case words at non-alphanumeric characters and at changes from lower to upper case.
pub fn words(name: &str) -> Vec<String> {
    let mut separated = String::new();
    let mut before = ' ';
    for c in name.chars() {
        if before.is_lowercase() && c.is_uppercase() {
            separated.push(' ');
        }
        separated.extend(if c.is_alphanumeric() { c.to_lowercase().collect::<Vec<_>>() } else { vec![' '] });
        before = c;
    }
    separated.split_whitespace().map(str::to_owned).collect()
}

/// Returns whether a name contains the words of another one after the other.
pub fn contains(name: &str, other: &str) -> bool {
    let (all, sought) = (words(name), words(other));
    !sought.is_empty() && all.windows(sought.len()).any(|part| part == sought)
}
