//! Takes exported by OptiTrack's Motive: rigid bodies with rotations, and markers, in any order.

use super::{Layout, cm, ms, plain};
use crate::body::{Body, Rotation};
use crate::column::Column;
use crate::columns::{Columns, TimeColumns};
use crate::left_out::LeftOut;
use crate::quantities::Unit;
use crate::table::{Header, cells, lines};
use crate::upright::Axis;
use std::result::Result;

/// The first words of such a file.
const SIGNATURE: &str = "Format Version";

/// Recognises a take.
pub fn layout(text: &str) -> Option<Result<Layout, (u64, String)>> {
    text.starts_with(SIGNATURE).then(|| read(text))
}

fn read(text: &str) -> Result<Layout, (u64, String)> {
    let lines = lines(text);
    let rows: Vec<Vec<String>> = lines.iter().map(|line| cells(line.text, b',')).collect();
    let is_header = |row: &Vec<String>| row.first().is_some_and(|cell| cell == "Frame");
    let at = rows
        .iter()
        .position(is_header)
        .ok_or((1, "has no line that begins with Frame, as Motive's exports do".to_owned()))?;
    let stated = |key: &str| {
        let place = rows[0].iter().position(|cell| cell == key)?;
        rows[0].get(place + 1).map(|value| value.to_lowercase())
    };
    let length = match stated("Length Units").as_deref() {
        Some("meters") => cm(100.0),
        Some("centimeters") => cm(1.0),
        Some("millimeters") => cm(0.1),
        _ => return Err((1, "Length Units are not meters, centimeters or millimeters".into())),
    };
    let rotation_type = stated("Rotation Type").unwrap_or_else(|| "quaternion".into());
    let of_type = |row: &Vec<String>| row.iter().any(|cell| cell == "Rigid Body" || cell == "Marker");
    let types = rows[1..at].iter().position(of_type).map(|i| i + 1);
    let types = types.ok_or((lines[at].number, "has neither rigid bodies nor markers".to_owned()))?;
    let (names, kinds, axes) = (&rows[types + 1], &rows[at - 1], &rows[at]);
    let bodies = columns_by_body(&rows[types], names, kinds, axes);
    let mut found = Columns { upright: Axis::Y, ..Columns::default() };
    let time = axes.iter().position(|cell| cell.starts_with("Time"));
    let time = time.ok_or((lines[at].number, "has no column Time (Seconds)".to_owned()))?;
    let columns = vec![Column::of(time, "Time (Seconds)", ms(1000.0))];
    found.times.push(TimeColumns { columns, is_stamp: false, is_shared: true });
    let mut without_rotation = Vec::new();
    for (name, columns) in bodies {
        match body(&name, &columns, length, &rotation_type) {
            Some(body) => found.bodies.push(body),
            None => without_rotation.push(name),
        }
    }
    if found.bodies.is_empty() {
        let what = format!(
            "has no rotations, so the heading is unknown: export rigid bodies with Rotation Type Quaternion (it holds {})",
            without_rotation.join(", ")
        );
        return Err((lines[at].number, what));
    }
    let markers = without_rotation.into_iter().map(|name| LeftOut::body(&name, None, "has no rotation"));
    found.left_out.extend(markers);
    let body = lines.get(at + 1).map_or(text.len(), |line| line.start)..text.len();
    let lines_before = lines.get(at + 1).map_or(lines[at].number, |line| line.number - 1);
    // The names of axes repeat, so those of the bodies stand for them.
    let header = Header { line: lines[at].number, ..Header::given(axes.clone(), b',', body, lines_before) };
    Ok((header, found))
}

/// The columns of an asset: index, kind and axis.
type AssetColumns<'a> = Vec<(usize, &'a str, &'a str)>;

/// Groups columns by the asset that they belong to; the markers of a rigid body are assets of their own.
fn columns_by_body<'a>(
    types: &'a [String],
    names: &'a [String],
    kinds: &'a [String],
    axes: &'a [String],
) -> Vec<(String, AssetColumns<'a>)> {
    let mut bodies: Vec<(String, AssetColumns)> = Vec::new();
    for (index, asset) in
        types.iter().enumerate().filter(|(_, asset)| asset.contains("Body") || asset.contains("Marker"))
    {
        let cell = |row: &'a [String]| row.get(index).map_or("", String::as_str);
        let name = if asset == "Rigid Body" {
            cell(names).to_owned()
        } else {
            format!("{} ({})", cell(names), asset.to_lowercase())
        };
        let column = (index, cell(kinds), cell(axes));
        match bodies.iter_mut().find(|(other, _)| *other == name) {
            Some((_, columns)) => columns.push(column),
            None => bodies.push((name, vec![column])),
        }
    }
    bodies
}

fn body(name: &str, columns: &AssetColumns, length: Option<Unit>, rotation_type: &str) -> Option<Body> {
    let of =
        |kind: &str, axis: &str| columns.iter().find(|(_, k, a)| *k == kind && *a == axis).map(|(index, ..)| *index);
    let position = |axis: &str| Some(Column::of(of("Position", axis)?, format!("{name} Position {axis}"), length));
    let part = |axis: &str| plain(of("Rotation", axis)?, &format!("{name} Rotation {axis}"));
    let position = [Some(position("X")?), Some(position("Y")?), Some(position("Z")?)];
    let rotation = match part("W") {
        Some(w) => Rotation::Quaternion([Some(part("X")?), Some(part("Y")?), Some(part("Z")?), Some(w)]),
        None if rotation_type == "xyz" => {
            let angle = |axis| Some(Column { unit: Unit::from_name("deg"), ..part(axis)? });
            Rotation::Euler([angle("X")?, angle("Y")?, angle("Z")?])
        }
        None => return None,
    };
    Some(Body { name: name.into(), position, rotation, residual: None, is_lost_at_origin: true })
}
