//! Exports by Vicon: objects (or segments) with rotations and positions, numbered frames, and the rate in the second line.

use super::{Layout, ms};
use crate::body::{Body, Rotation};
use crate::column::Column;
use crate::columns::{Columns, TimeColumns};
use crate::left_out::LeftOut;
use crate::quantities::{Dimension, Unit};
use crate::table::{Header, cells, lines};
use std::result::Result;

/// First lines of the sections that such a file may hold.
const SECTIONS: [&str; 6] = ["Objects", "Segments", "Trajectories", "Devices", "Joints", "Model Outputs"];

/// Recognises an export.
pub fn layout(text: &str) -> Option<Result<Layout, (u64, String)>> {
    let first = text.lines().next()?.trim_end_matches([',', '\r', ' ']);
    SECTIONS.contains(&first).then(|| read(text))
}

fn read(text: &str) -> Result<Layout, (u64, String)> {
    let lines = lines(text);
    let rows: Vec<Vec<String>> = lines.iter().take(64).map(|line| cells(line.text, b',')).collect();
    let is_poses = |row: &Vec<String>| row.iter().any(|cell| cell == "RX") && row.iter().any(|cell| cell == "TX");
    let what =
        "has no objects with rotations and positions (RX to TZ), so the heading is unknown: export objects or segments";
    let at = rows.iter().position(is_poses).ok_or((1, what.to_owned()))?;
    let rate_line = at.checked_sub(2).map_or((1, String::new()), |line| (lines[line].number, rows[line][0].clone()));
    let rate_hz = rate_line.1.parse::<f64>().ok().filter(|rate| *rate > 0.0 && rate.is_finite());
    let rate_hz = rate_hz.ok_or((rate_line.0, format!("{:?} is not a rate of frames per second", rate_line.1)))?;
    let (names, axes, units) = (&rows[at - 1], &rows[at], rows.get(at + 1).cloned().unwrap_or_default());
    let unit = |index: usize, dimension| {
        units.get(index).and_then(|unit| Unit::from_name(unit)).filter(|unit| unit.dimension == dimension)
    };
    let starts = (0..axes.len()).filter(|i| names.get(*i).is_some_and(|name| !name.is_empty()));
    let starts: Vec<usize> = starts.chain([axes.len()]).collect();
    let mut found = Columns::default();
    for range in starts.windows(2) {
        let of = |axis: &str| (range[0]..range[1]).find(|index| axes[*index] == axis);
        let name = short(&names[range[0]]);
        let column = |axis: &str, dimension| {
            let index = of(axis)?;
            Some(Column::of(index, format!("{name} {axis}"), Some(unit(index, dimension)?)))
        };
        let body = || {
            let [length, angle] = [Dimension::Length, Dimension::Angle];
            let position = [Some(column("TX", length)?), Some(column("TY", length)?), Some(column("TZ", length)?)];
            let rotation = Rotation::Vector([column("RX", angle)?, column("RY", angle)?, column("RZ", angle)?]);
            Some(Body { name: name.clone(), position, rotation, residual: None, is_lost_at_origin: true })
        };
        match body() {
            Some(body) => found.bodies.push(body),
            None => found.left_out.push(LeftOut::body(&name, None, "has no rotation, or no units below its columns")),
        }
    }
    if found.bodies.is_empty() {
        let what = "has no units of rotations (rad, deg) and positions (mm) below its header";
        return Err((lines[at].number, what.into()));
    }
    let frame = axes.iter().position(|cell| cell == "Frame");
    let frame = frame.ok_or((lines[at].number, "has no column Frame".to_owned()))?;
    let columns = vec![Column::of(frame, "Frame", ms(1000.0 / rate_hz))];
    found.times.push(TimeColumns { columns, is_stamp: false, is_shared: true });
    found.guessed.push(format!("Frame counts {rate_hz} per second"));
    // A blank line ends the section.
    let first = lines.get(at + 2);
    let start = first.map_or(text.len(), |line| line.start);
    let end = ["\n\n", "\n\r\n"].iter().filter_map(|blank| text[start..].find(blank)).min();
    let end = end.map_or(text.len(), |end| start + end + 1);
    let others: Vec<&str> = text[end..]
        .lines()
        .map(|line| line.trim_end_matches([',', '\r']))
        .filter(|line| SECTIONS.contains(line))
        .collect();
    found.left_out.extend(others.into_iter().map(|section| LeftOut::rows(section, 0, "another section of the file")));
    let mut all_units: Vec<Option<Unit>> = units.iter().map(|unit| Unit::from_name(unit)).collect();
    all_units.resize(axes.len(), None);
    all_units[frame] = ms(1000.0 / rate_hz);
    let lines_before = first.map_or(lines[at].number, |line| line.number - 1);
    let given = Header::given(axes.clone(), b',', start..end, lines_before);
    Ok((Header { line: lines[at].number, units: all_units, ..given }, found))
}

/// Returns the name of an object whose subject has the same name, as in `rover:rover`.
fn short(name: &str) -> String {
    match name.split_once(':') {
        Some((subject, object)) if subject == object => object.to_owned(),
        _ => name.to_owned(),
    }
}
