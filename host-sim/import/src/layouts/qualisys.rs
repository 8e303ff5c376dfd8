//! Exports by Qualisys Track Manager: lines of keys, then a table of bodies in six dimensions.

use super::{Layout, cm, ms};
use crate::body::{Body, Rotation};
use crate::column::Column;
use crate::columns::{Columns, TimeColumns};
use crate::quantities::Unit;
use crate::table::{Header, cells, lines};
use std::result::Result;

/// The first word of such a file.
const SIGNATURE: &str = "NO_OF_FRAMES";
/// Keys that have the names of the bodies.
const NAMES: &str = "BODY_NAMES";

/// Recognises an export.
pub fn layout(text: &str) -> Option<Result<Layout, (u64, String)>> {
    text.starts_with(SIGNATURE).then(|| read(text))
}

fn read(text: &str) -> Result<Layout, (u64, String)> {
    let lines = lines(text);
    let separator = if lines[0].text.contains('\t') { b'\t' } else { b',' };
    let rows: Vec<Vec<String>> = lines.iter().take(64).map(|line| cells(line.text, separator)).collect();
    let key = |name: &str| rows.iter().find(|row| row[0] == name).map(|row| &row[1..]);
    let is_header = |row: &Vec<String>| row.iter().any(|cell| cell == "Yaw") && row.iter().any(|cell| cell == "X");
    let what = "has no table of bodies with X, Y, Z, Roll, Pitch, Yaw, so the heading is unknown: export 6D data with Euler angles";
    let at = rows.iter().position(is_header).ok_or((1, what.to_owned()))?;
    let names = &rows[at];
    let starts: Vec<usize> = (0..names.len()).filter(|index| names[*index] == "X").chain([names.len()]).collect();
    let bodies = key(NAMES).unwrap_or_default();
    let mut found = Columns::default();
    for (body, range) in starts.windows(2).enumerate() {
        let name =
            bodies.get(body).filter(|name| !name.is_empty()).cloned().unwrap_or_else(|| format!("body {}", body + 1));
        let column = |axis: &str, unit: Option<Unit>| {
            let index = (range[0]..range[1]).find(|index| names[*index] == axis)?;
            Some(Column::of(index, format!("{name} {axis}"), unit))
        };
        let millimetres = cm(0.1);
        let whole = || {
            let position = [Some(column("X", millimetres)?), Some(column("Y", millimetres)?), column("Z", millimetres)];
            let rotation = Rotation::Heading(column("Yaw", Unit::from_name("deg"))?);
            let residual = column("Residual", None);
            Some(Body { name: name.clone(), position, rotation, residual, is_lost_at_origin: true })
        };
        found.bodies.extend(whole());
    }
    let time = match names.iter().position(|name| name == "Time") {
        Some(time) => Column::of(time, "Time", ms(1000.0)),
        None => {
            let rate_hz =
                key("FREQUENCY").and_then(|values| values.first()?.parse::<f64>().ok()).filter(|rate| *rate > 0.0);
            let frame = names.iter().position(|name| name == "Frame").zip(rate_hz);
            let (frame, rate_hz) =
                frame.ok_or((lines[at].number, "has neither Time nor Frame and FREQUENCY".to_owned()))?;
            Column::of(frame, "Frame", ms(1000.0 / rate_hz))
        }
    };
    found.times.push(TimeColumns { columns: vec![time], is_stamp: false, is_shared: true });
    let first = lines.get(at + 1);
    let body = first.map_or(text.len(), |line| line.start)..text.len();
    let lines_before = first.map_or(lines[at].number, |line| line.number - 1);
    Ok((Header { line: lines[at].number, ..Header::given(names.clone(), separator, body, lines_before) }, found))
}
