//! Plain tables for the terminal.

pub use mindgap_pages::words::count;

/// Returns a table with a header, the first column aligned left and all others right.
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

/// Returns a number with `decimals` decimals, or a dash for `None`.
pub fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or("-".into(), |v| format!("{v:.decimals$}"))
}
