//! Recognises files that are not tables, and says how to make one of them.

/// Number of first bytes that [`signature`] needs.
pub const SIGNATURE: usize = 16;

/// First bytes of other formats, and what to do.
const SIGNATURES: [(&[u8], &str); 7] = [
    (b"\x89MCAP0", "is a bag in MCAP: use `mindgap import bag`"),
    (b"SQLite format 3", "is a bag in SQLite: use `mindgap import bag`"),
    (b"#ROSBAG", "is a ROS 1 bag: use `mindgap import bag`"),
    (b"PK\x03\x04", "is a spreadsheet or zip archive: save the table as CSV"),
    (b"\xD0\xCF\x11\xE0", "is a spreadsheet: save the table as CSV"),
    (b"PAR1", "is a Parquet file: write the table as CSV"),
    (b"MATLAB 5.0", "is a MATLAB file: write the table as CSV with writetable"),
];

/// Returns what to do with a file that begins with the bytes of another format.
pub fn signature(start: &[u8]) -> Option<String> {
    SIGNATURES.iter().find(|(bytes, _)| start.starts_with(bytes)).map(|(_, what)| (*what).into())
}

/// Returns what to do with a text that is not a table.
pub fn refusal(text: &str) -> Option<String> {
    let mut lines = text.lines().filter(|line| !line.trim().is_empty() && *line != "---");
    let (first, second) = (lines.next()?, lines.next().unwrap_or_default());
    if is_key(first) && (is_key(second.trim_start()) || text.contains("\n---")) {
        let what = "is YAML, as `ros2 topic echo` writes it: record a bag with `ros2 bag record`, or write the topic with \
                    `ros2 topic echo --csv`";
        return Some(what.into());
    }
    match first.trim_start().chars().next()? {
        '{' => Some("is JSON: write the table as CSV".into()),
        '<' => Some("is XML or HTML: write the table as CSV".into()),
        _ => None,
    }
}

/// Returns whether a line is a key of YAML, with or without a value.
fn is_key(line: &str) -> bool {
    let Some((key, value)) = line.trim_start_matches("- ").split_once(':') else { return false };
    let is_name = !key.is_empty() && key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    is_name && (value.trim().is_empty() || value.starts_with(' ')) && !value.contains([',', ';', '\t'])
}
