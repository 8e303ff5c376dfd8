//! Plain tables for the terminal.

/// Rows under a header, the first column to the left and all others to the right.
pub fn text<const N: usize>(header: [&str; N], rows: &[[String; N]]) -> String {
    let widths: [usize; N] = std::array::from_fn(|i| {
        rows.iter().map(|row| row[i].chars().count()).chain([header[i].chars().count()]).max().unwrap_or(0)
    });
    let line = |cells: [&str; N]| {
        let padded: Vec<String> = (0..N)
            .map(|i| {
                let room = " ".repeat(widths[i] - cells[i].chars().count());
                if i == 0 { format!("{}{room}", cells[i]) } else { format!("{room}{}", cells[i]) }
            })
            .collect();
        padded.join("  ").trim_end().to_owned() + "\n"
    };
    let body = rows.iter().map(|row| line(row.each_ref().map(String::as_str)));
    line(header) + &body.collect::<String>()
}

/// A number with so many decimals, or a dash for none.
pub fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or("-".into(), |v| format!("{v:.decimals$}"))
}

/// So many of something, in words: "1 run", "2 runs".
pub fn count(of: usize, what: &str) -> String {
    format!("{of} {what}{}", if of == 1 { "" } else { "s" })
}
