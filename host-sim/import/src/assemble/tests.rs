//! Recordings of a drive that is known exactly.

use std::path::{Path, PathBuf};

use super::*;
use crate::frame::Frame;
use crate::recording::{Commands, Readings};
use crate::report::Source;
use mindgap_foundations::geometry::Pose;

/// Commands change every 600 ms.
const HELD_MS: f64 = 600.0;
const LASTS_MS: f64 = 60_000.0;

/// Speed ahead (cm/s) and turn rate (rad/s) at a time.
fn twist(t_ms: f64) -> [f64; 2] {
    let k = (t_ms / HELD_MS).floor() as u64;
    let draw = |salt: u64| {
        let x = (k + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ salt.wrapping_mul(0xD1B5_4A32_D192_ED03);
        let x = (x ^ (x >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        ((x ^ (x >> 32)) >> 11) as f64 / (1u64 << 53) as f64
    };
    [5.0 + 15.0 * draw(1), 1.6 * draw(2) - 0.8]
}

/// Poses every 10 ms, as an exact robot drives.
fn path() -> Vec<Frame> {
    let mut pose = Pose::new(50.0, 80.0, 0.3);
    let mut frames = Vec::new();
    for i in 0..(LASTS_MS / 10.0) as usize {
        let t_ms = 10.0 * i as f64;
        frames.push(Frame { t_ms, pose });
        let [v, w] = twist(t_ms);
        pose = pose.compose(&Pose::new(0.01 * v, 0.0, 0.01 * w));
    }
    frames
}

fn recording(poses: impl Fn(Frame) -> Frame) -> Recording {
    let samples = (0..(LASTS_MS / 50.0) as usize).map(|i| 50.0 * i as f64);
    Recording {
        commands: Commands { kind: Kind::Twist, samples: samples.map(|ms| (ms, twist(ms))).collect() },
        poses: path().into_iter().step_by(3).map(|frame| Some(poses(frame))).collect(),
        track: PathBuf::from("track.csv"),
        readings: None,
        has_one_clock: false,
        sources: Vec::new(),
    }
}

fn robot() -> Robot {
    let text = "wheel_diameter_cm = 6\ntrack_cm = 20\nbody_radius_cm = 12\nstep_ms = 400\nfull_speed_cm_s = 50\n";
    mindgap_files::from_toml(Path::new("robot.toml"), text).expect("a robot")
}

fn assembled(recording: Recording) -> Result<Assembled> {
    assemble(vec![recording], Some(robot()), Scene::default(), None, |_, _| ())
}

/// How far the logs' poses lie from the exact ones, cm, at most.
fn off_cm(logs: &Logs) -> f64 {
    let path = path();
    let off = logs.runs[0].rows.iter().filter_map(|row| {
        let exact = path[(row.t_ms / 10.0).round() as usize].pose;
        Some(row.pose?.position_cm.distance(exact.position_cm))
    });
    off.fold(0.0, f64::max)
}

#[test]
fn rows_have_the_commands_and_poses_of_their_times() {
    let Assembled { logs, report, draft } = assembled(recording(|frame| frame)).expect("logs");
    assert!(draft.is_none() && logs.runs.len() == 1 && report.frame.is_none());
    assert!(report.recordings[0].clocks.one, "{:?}", report.recordings[0].clocks);
    assert!(off_cm(&logs) < 0.5, "{}", off_cm(&logs));
    // 400 ms of which 200 belong to the next command.
    let [v, w] = [0, 1].map(|i| (twist(400.0)[i] + twist(600.0)[i]) / 2.0);
    let expected = [v - 10.0 * w, v + 10.0 * w].map(|cm_s| 2.0 * cm_s);
    let row = logs.runs[0].rows.at(1);
    assert!((row.left - expected[0]).abs() < 1e-9 && (row.right - expected[1]).abs() < 1e-9, "{row:?} {expected:?}");
}

#[test]
fn a_lag_is_the_robots_and_another_clock_is_aligned() {
    let late = assembled(recording(|frame| Frame { t_ms: frame.t_ms + 200.0, ..frame })).expect("logs");
    let clocks = &late.report.recordings[0].clocks;
    assert!(clocks.one && clocks.lag_ms == Some(200.0), "{clocks:?}");
    let other = assembled(recording(|frame| Frame { t_ms: frame.t_ms + 1.7e12, ..frame })).expect("logs");
    let clocks = &other.report.recordings[0].clocks;
    assert!(!clocks.one && (clocks.offset_ms - 1.7e12).abs() < 20.0, "{clocks:?}");
    assert!(off_cm(&other.logs) < 1.0, "{}", off_cm(&other.logs));
}

#[test]
fn frames_are_put_right() {
    let mirrored = |frame: Frame| {
        let at = frame.pose.position_cm;
        Frame { pose: Pose::new(at.x, -at.y, frame.pose.heading_rad), ..frame }
    };
    let compass = |frame: Frame| {
        let at = frame.pose.position_cm;
        Frame { pose: Pose::new(at.x, at.y, std::f64::consts::FRAC_PI_2 - frame.pose.heading_rad), ..frame }
    };
    for (change, what) in [(&mirrored as &dyn Fn(Frame) -> Frame, "mirrored back"), (&compass, "clockwise")] {
        let Assembled { logs, report, .. } = assembled(recording(change)).expect("logs");
        assert!(report.frame.as_ref().is_some_and(|told| told.contains(what)), "{:?}", report.frame);
        assert!(off_cm(&logs) < 0.5, "{what}: {}", off_cm(&logs));
    }
}

#[test]
fn units_that_do_not_go_together_are_refused_with_both_sides() {
    let metres = |frame: Frame| {
        let at = frame.pose.position_cm / 100.0;
        Frame { pose: Pose::new(at.x, at.y, frame.pose.heading_rad), ..frame }
    };
    let error = assembled(recording(metres)).err().expect("refused").to_string();
    assert!(error.contains("the track seems to be in m and was read in cm"), "{error}");
    let millimetres = |frame: Frame| {
        let at = frame.pose.position_cm * 10.0;
        Frame { pose: Pose::new(at.x, at.y, frame.pose.heading_rad), ..frame }
    };
    let error = assembled(recording(millimetres)).err().expect("refused").to_string();
    assert!(error.contains("the track seems to be in mm and was read in cm"), "{error}");
}

#[test]
fn what_is_of_two_drives_is_refused() {
    let mut other = recording(|frame| frame);
    other.poses.reverse();
    let times: Vec<f64> = other.poses.iter().rev().flatten().map(|frame| frame.t_ms).collect();
    other.poses.iter_mut().flatten().zip(times).for_each(|(frame, ms)| frame.t_ms = ms);
    let error = assembled(other).err().expect("refused").to_string();
    assert!(error.contains("nothing in common"), "{error}");
    let mut apart = recording(|frame| Frame { t_ms: frame.t_ms + 1e6, ..frame });
    apart.has_one_clock = true;
    let error = assembled(apart).err().expect("refused").to_string();
    assert!(error.contains("(0.0 to 59.6 s) and poses (1000.0 to 1059.9 s) do not overlap"), "{error}");
}

#[test]
fn without_a_robot_its_measures_are_fitted_and_marked() {
    let mut wheels = recording(|frame| frame);
    wheels.commands.kind = Kind::Motors;
    wheels.commands.samples.iter_mut().for_each(|(_, pair)| {
        let [v, w] = *pair;
        *pair = [v - 10.0 * w, v + 10.0 * w].map(|cm_s| 2.0 * cm_s);
    });
    wheels.readings = Some(Readings { samples: vec![(0.0, Some(50.0))], on_clock_of_poses: false });
    let Assembled { logs, draft, .. } = assemble(vec![wheels], None, Scene::default(), None, |_, _| ()).expect("logs");
    let text = draft.expect("a draft").text();
    assert!((logs.robot.full_speed_cm_s - 50.0).abs() < 1.0 && (logs.robot.track_cm - 20.0).abs() < 0.5, "{text}");
    assert!(text.contains("# FILL IN: fitted to these logs") && text.contains("\n[ultrasonic]"), "{text}");
    assert_eq!((logs.runs[0].rows.at(0).echo_cm, logs.runs[0].rows.at(1).echo_cm), (Some(50.0), None));
    let twist = assemble(vec![recording(|frame| frame)], None, Scene::default(), None, |_, _| ()).expect("logs");
    assert!([20.0, 25.0, 30.0].contains(&twist.logs.robot.full_speed_cm_s), "{}", twist.logs.robot.full_speed_cm_s);
    assert!(twist.draft.expect("a draft").text().contains("\n# [ultrasonic]"));
}

#[test]
fn a_robot_without_a_range_sensor_has_no_readings() {
    let mut read = recording(|frame| frame);
    read.readings = Some(Readings { samples: vec![(0.0, Some(50.0))], on_clock_of_poses: false });
    read.sources = vec![Source::named("readings".into(), &[0.0, 1.0])];
    let Assembled { logs, report, .. } = assembled(read).expect("logs");
    assert!(logs.runs[0].rows.iter().all(|row| row.echo_cm.is_none()));
    assert!(report.recordings[0].sources[0].left_out[0].contains("no [ultrasonic]"), "{report:?}");
}

#[test]
fn a_long_pause_of_the_tracker_parts_runs() {
    let mut paused = recording(|frame| frame);
    paused
        .poses
        .iter_mut()
        .filter(|f| f.is_some_and(|f| (20_000.0..30_000.0).contains(&f.t_ms)))
        .for_each(|f| *f = None);
    paused
        .poses
        .iter_mut()
        .filter(|f| f.is_some_and(|f| (40_000.0..41_000.0).contains(&f.t_ms)))
        .for_each(|f| *f = None);
    let Assembled { logs, report, .. } = assembled(paused).expect("logs");
    assert_eq!(logs.runs.iter().map(|run| run.name.as_str()).collect::<Vec<_>>(), ["run-000", "run-001"]);
    assert!((1..=3).contains(&report.recordings[0].without_pose), "{report:?}");
}
