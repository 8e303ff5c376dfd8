use std::f64::consts::FRAC_PI_2;

use super::*;
use crate::file_streams::FileStreams;
use crate::statements::Statements;
use mindgap_files as files;

fn read(text: &str) -> Result<FileStreams> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("take.csv");
    files::write(&file, text)?;
    Ok(FileStreams::read(&file, &Statements::default())?.remove(0))
}

/// Poses on a circle of 50 cm about (100, 200), a quarter turn in 40 steps of 100 ms: x (cm), y (cm), heading (rad).
fn circle() -> Vec<[f64; 3]> {
    (0..=40)
        .map(|i| {
            let rad = FRAC_PI_2 * f64::from(i) / 40.0;
            let (sin, cos) = libm::sincos(rad);
            [100.0 + 50.0 * sin, 200.0 - 50.0 * cos, rad]
        })
        .collect()
}

fn rows(row: impl Fn(usize, [f64; 3]) -> String) -> String {
    circle().into_iter().enumerate().map(|(i, pose)| row(i, pose) + "\n").collect()
}

#[track_caller]
fn assert_circle(text: &str, name: &str) {
    let streams = read(text).expect("read");
    let body = streams.bodies.iter().find(|body| body.name == name).expect("the body");
    assert_eq!(body.frames.len(), 41);
    for (i, (frame, [x, y, heading])) in body.frames.iter().zip(circle()).enumerate() {
        let frame = frame.expect("seen");
        let off = (frame.pose.position_cm.x - x).abs() + (frame.pose.position_cm.y - y).abs();
        assert!(off < 0.1 && (frame.pose.heading_rad - heading).abs() < 1e-3, "{i}: {frame:?}");
        assert!((frame.t_ms - body.frames[0].expect("seen").t_ms - 100.0 * i as f64).abs() < 1e-2, "{i}: {frame:?}");
    }
}

const MOTIVE: &str =
    "Format Version,1.23,Take Name,Take 1,Rotation Type,ROTATION,Length Units,Meters,Coordinate Space,Global\n\n";

/// A take with markers, a body at rest and the robot, in this order. `turn` gives the rotation's cells.
fn motive(rotation: &str, axes: &str, robot: impl Fn([f64; 3]) -> String) -> String {
    let count = axes.split(',').count();
    let repeat = |cell: &str, n: usize| vec![cell; n].join(",");
    let names = format!("{},{},{}", repeat("rover:1", 3), repeat("corner", count + 3), repeat("rover", count + 3));
    let types = format!("{},{}", repeat("Rigid Body Marker", 3), repeat("Rigid Body", 2 * (count + 3)));
    let kinds = format!("{},{},{}", repeat("Rotation", count), repeat("Position", 3), "");
    let kinds = kinds.trim_end_matches(',');
    let head = format!(
        ",Type,{types}\n,Name,{names}\n,ID,{}\n,,{},{kinds},{kinds}\nFrame,Time (Seconds),X,Y,Z,{axes},X,Y,Z,{axes},X,Y,Z\n",
        repeat("1", 2 * count + 9),
        repeat("Position", 3),
    );
    let still = format!("{},2,0.1,2", if count == 4 { "0,0,0,1" } else { "0,0,0" });
    let body = rows(|i, pose| format!("{i},{:.1},0,0,0,{still},{}", 0.1 * i as f64, robot(pose)));
    MOTIVE.replace("ROTATION", rotation) + &head + &body
}

#[test]
fn motive_is_read_with_either_axis_upwards() {
    let half = |rad: f64| libm::sincos(rad / 2.0);
    let y_up = motive("Quaternion", "X,Y,Z,W", |[x, y, rad]| {
        let (sin, cos) = half(rad);
        format!("0,{sin:.6},0,{cos:.6},{:.5},0.1,{:.5}", x / 100.0, -y / 100.0)
    });
    assert_circle(&y_up, "rover");
    let z_up = motive("Quaternion", "X,Y,Z,W", |[x, y, rad]| {
        let (sin, cos) = half(rad);
        format!("0,0,{sin:.6},{cos:.6},{:.5},{:.5},0.1", x / 100.0, y / 100.0)
    });
    assert_circle(&z_up, "rover");
    let euler = motive("XYZ", "X,Y,Z", |[x, y, rad]| {
        format!("0,{:.4},0,{:.5},0.1,{:.5}", rad.to_degrees(), x / 100.0, -y / 100.0)
    });
    assert_circle(&euler, "rover");
    let unused = read(&y_up).expect("read").source.unused;
    assert!(
        unused.iter().any(|unused| unused.name.contains("rover:1") && unused.reason.contains("no rotation")),
        "{unused:?}"
    );
}

#[test]
fn motive_without_rotations_is_refused() {
    let text = motive("Quaternion", "X,Y,Z,W", |_| "0,0,0,1,1,1,1".into()).replace("Rotation,", "Other,");
    let error = read(&text).expect_err("refused").to_string();
    assert!(error.contains("the heading is unknown") && error.contains("Rotation Type Quaternion"), "{error}");
    let feet = text.replace("Meters", "Feet");
    assert!(read(&feet).expect_err("refused").to_string().contains("Length Units"));
}

#[test]
fn vicon_qualisys_and_tum_are_read() {
    let vicon =
        rows(|i, [x, y, rad]| format!("{},0,0,0,0,1,2,3,0,0,{rad:.5},{:.2},{:.2},100", i + 1, 10.0 * x, 10.0 * y));
    let head = "Objects\n10\n,,corner:corner,,,,,,rover:rover,,,,,\n\
                Frame,Sub Frame,RX,RY,RZ,TX,TY,TZ,RX,RY,RZ,TX,TY,TZ\n,,rad,rad,rad,mm,mm,mm,rad,rad,rad,mm,mm,mm\n";
    assert_circle(&format!("{head}{vicon}"), "rover");
    let tail = "\nTrajectories\n10\n,,a,,\nFrame,Sub Frame,X,Y,Z\n,,mm,mm,mm\n1,0,1,1,1\n";
    assert_circle(&format!("{head}{vicon}{tail}"), "rover");
    let qualisys = rows(|i, [x, y, rad]| {
        format!(
            "{}\t{:.3}\t{:.2}\t{:.2}\t100\t0\t0\t{:.4}\t0.4",
            i + 1,
            0.1 * i as f64,
            10.0 * x,
            10.0 * y,
            rad.to_degrees()
        )
    });
    let head = "NO_OF_FRAMES\t41\nFREQUENCY\t10\nDATA_INCLUDED\t6D\nBODY_NAMES\trover\n";
    let columns = "Frame\tTime\tX\tY\tZ\tRoll\tPitch\tYaw\tResidual\n";
    assert_circle(&format!("{head}{columns}{qualisys}"), "rover");
    let lost = format!("{head}{columns}{qualisys}42\t4.2\t0\t0\t0\t0\t0\t0\t-1\n43\t4.3\t0\t0\t0\t0\t0\t0\t0\n");
    let frames = &read(&lost).expect("read").bodies[0].frames;
    assert_eq!((frames.len(), frames[41], frames[42]), (43, None, None));
    let tum = rows(|i, [x, y, rad]| {
        let (sin, cos) = libm::sincos(rad / 2.0);
        format!("{:.1} {:.5} {:.5} 0.1 0 0 {sin:.6} {cos:.6}", 1.7e9 + 0.1 * i as f64, x / 100.0, y / 100.0)
    });
    assert_circle(&tum, "");
    assert_circle(&format!("# timestamp tx ty tz qx qy qz qw\n{tum}"), "");
    let echo = tum.lines().enumerate().map(|(i, line)| {
        let rest = line.split_once(' ').expect("cells").1.replace(' ', ",");
        format!("{},{},map,{rest}\n", i / 10, i % 10 * 100_000_000)
    });
    assert_circle(&echo.collect::<String>(), "");
    let error = read("0.2,0.0,0.0,0.0,0.0,0.1\n0.2,0.0,0.0,0.0,0.0,0.1\n").expect_err("no time").to_string();
    assert!(error.contains("no time") && error.contains("ros2 bag record"), "{error}");
}
