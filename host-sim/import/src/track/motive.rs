//! Tracks as OptiTrack's Motive exports a rigid body: y points up, rotations are quaternions.

use std::path::Path;

use csv::{ReaderBuilder, StringRecord};
use glam::{DQuat, DVec3};

use crate::frame::Frame;
use crate::units::Length;
use mindgap_files::Records;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::Pose;

/// The beginning of such a file.
const BEGINNING: &str = "Format Version";
/// Its header: frame, time, then rotation and position of the first rigid body.
const HEADER: [&str; 9] = ["Frame", "Time (Seconds)", "X", "Y", "Z", "W", "X", "Y", "Z"];

pub(super) fn is_one(text: &str) -> bool {
    text.trim_start_matches('\u{feff}').starts_with(BEGINNING)
}

/// The frames of the first rigid body; `None` where it was lost. The scene's x is Motive's X, and its y is Motive's -Z.
pub(super) fn frames(file: &Path, text: &str) -> Result<Vec<Option<Frame>>> {
    let mut records = Records::with(file, text.as_bytes(), ReaderBuilder::new().has_headers(false).flexible(true));
    let mut unit = None;
    let mut is_body = false;
    let (mut record, mut frames) = (StringRecord::new(), Vec::new());
    while let Some(line) = records.read(&mut record)? {
        let cell = |at: usize| record.get(at).map_or("", str::trim);
        if !is_body {
            let stated = record.iter().position(|cell| cell.trim() == "Length Units").map(|at| cell(at + 1));
            unit = stated.map(str::to_lowercase).or(unit);
            is_body = (0..HEADER.len()).all(|at| cell(at) == HEADER[at]);
            continue;
        }
        let cm = match unit.as_deref() {
            Some("meters") => Length::M,
            Some("centimeters") => Length::Cm,
            Some("millimeters") => Length::Mm,
            _ => return Err(Error::at_line(file, 1, "Length Units are not meters, centimeters or millimeters")),
        }
        .cm();
        let number = |at: usize| match cell(at) {
            "" => Ok(None),
            text => match text.parse::<f64>().ok().filter(|v| v.is_finite()) {
                Some(value) => Ok(Some(value)),
                None => Err(Error::at_line(file, line, format!("{} = {text:?} is no number", HEADER[at]))),
            },
        };
        let time = number(1)?.ok_or_else(|| Error::at_line(file, line, "Time is empty"))?;
        let values = (2..HEADER.len()).map(number).collect::<Result<Option<Vec<f64>>>>()?;
        frames.push(values.map(|v| {
            let forward = DQuat::from_xyzw(v[0], v[1], v[2], v[3]).normalize() * DVec3::X;
            let heading_rad = libm::atan2(-forward.z, forward.x);
            Frame { t_ms: 1000.0 * time, pose: Pose::new(v[4] * cm, -v[6] * cm, heading_rad) }
        }));
    }
    if !is_body {
        let what = format!("has no line {}, so no rigid body with quaternions comes first", HEADER.join(","));
        return Err(Error::in_file(file, what));
    }
    Ok(frames)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "Format Version,1.23,Take Name,Take 1,Length Units,Meters,Coordinate Space,Global\n\n\
                        ,,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body\n\
                        ,,NXT,NXT,NXT,NXT,NXT,NXT,NXT,NXT\n\
                        ,,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Mean Marker Error\n\
                        Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,\n";

    #[test]
    fn a_quarter_turn_to_the_left_is_one() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let text =
            format!("{HEAD}0,0,0,0,0,1,1.5,0.1,-0.5,0.001\n1,0.01,0,{half},0,{half},1.5,0.1,-0.5,0\n2,0.02,,,,,,,,\n");
        assert!(is_one(&text));
        let frames = frames(Path::new("take.csv"), &text).expect("frames");
        assert_eq!(frames[0], Some(Frame { t_ms: 0.0, pose: Pose::new(150.0, 50.0, 0.0) }));
        let turned = frames[1].expect("seen");
        assert!((turned.pose.heading_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-12 && turned.t_ms == 10.0);
        assert_eq!(frames[2], None);
    }

    #[test]
    fn euler_angles_and_odd_units_are_refused() {
        let refused = |text: String| frames(Path::new("take.csv"), &text).expect_err("refused").to_string();
        assert!(refused(HEAD.replace(",W,", ",")).contains("quaternions"));
        assert!(refused(HEAD.replace("Meters", "Feet") + "0,0,0,0,0,1,1,1,1,\n").contains("Length Units"));
        assert!(refused(HEAD.to_owned() + "0,0,0,0,0,1,1,x,1,\n").contains(":7: Y = \"x\""));
    }
}
