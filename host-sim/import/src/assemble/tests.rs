//! Assembles recordings of an exactly known drive.

use std::path::{Path, PathBuf};

use glam::DVec2;

use super::*;
use crate::frame::Frame;
use crate::own_motion::OwnMotion;
use crate::recording::{Commands, Readings};
use crate::report::{Determined, Source};
use mindgap_foundations::geometry::{Pose, Rectangle, cast};
use mindgap_logs::Ultrasonic;
use mindgap_logs::range_sensor::Sensors;

/// Commands change every 600 ms.
const HELD_MS: f64 = 600.0;
const LASTS_MS: f64 = 60_000.0;

/// Forward speed (cm/s) and turn rate (rad/s) at a time.
fn twist(t_ms: f64) -> [f64; 2] {
    let k = (t_ms / HELD_MS).floor() as u64;
    let draw = |salt: u64| {
        let x = (k + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ salt.wrapping_mul(0xD1B5_4A32_D192_ED03);
        let x = (x ^ (x >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        ((x ^ (x >> 32)) >> 11) as f64 / (1u64 << 53) as f64
    };
    [5.0 + 15.0 * draw(1), 1.6 * draw(2) - 0.8]
}

/// Poses of an exact robot every 10 ms.
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
        poses: path().into_iter().step_by(3).map(poses).collect(),
        file: PathBuf::from("track.csv"),
        readings: Vec::new(),
        own_motion: OwnMotion::default(),
        has_one_clock: false,
        sources: Vec::new(),
    }
}

fn robot() -> Robot {
    let text = "wheel_diameter_cm = 6\ntrack_cm = 20\nbody_radius_cm = 12\nstep_ms = 400\nfull_speed_cm_s = 50\n";
    mindgap_files::from_toml(Path::new("robot.toml"), text).expect("a robot")
}

fn assembled(recording: Recording) -> Result<Assembled> {
    assemble(vec![recording], Some((robot(), Sensors::default())), Scene::default(), Stated::default(), |_, _| ())
}

/// Largest distance between the logs' poses and the exact ones, cm.
fn max_error_cm(logs: &Logs) -> f64 {
    let path = path();
    let errors = logs.runs[0].rows.iter().filter_map(|row| {
        let exact = path[(row.t_ms / 10.0).round() as usize].pose;
        Some(row.pose?.position_cm.distance(exact.position_cm))
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn rows_have_commands_and_poses_of_their_times() {
    let Assembled { logs, report, draft } = assembled(recording(|frame| frame)).expect("logs");
    assert!(draft.is_none() && logs.runs.len() == 1 && report.frame.is_none());
    assert!(report.recordings[0].clocks.shared, "{:?}", report.recordings[0].clocks);
    assert!(max_error_cm(&logs) < 0.5, "{}", max_error_cm(&logs));
    // 400 ms, half of which belong to the next command.
    let [v, w] = [0, 1].map(|i| (twist(400.0)[i] + twist(600.0)[i]) / 2.0);
    let expected = [v - 10.0 * w, v + 10.0 * w].map(|cm_s| 2.0 * cm_s);
    let row = logs.runs[0].rows.at(1);
    assert!((row.left - expected[0]).abs() < 1e-9 && (row.right - expected[1]).abs() < 1e-9, "{row:?} {expected:?}");
}

#[test]
fn commands_keep_their_own_times_where_they_do_not_fall_on_rows() {
    let changes_ms = |step_ms: f64| {
        let robot = Robot { step_ms, ..robot() };
        let recordings = vec![recording(|frame| frame)];
        let assembled =
            assemble(recordings, Some((robot, Sensors::default())), Scene::default(), Stated::default(), |_, _| ())
                .expect("logs");
        let changes = assembled.logs.runs[0].rows.changes().cloned();
        changes.map(|changes| changes.as_slice().iter().map(|change| change.t_ms).collect::<Vec<_>>())
    };
    let off_rows = changes_ms(400.0).expect("commands between rows");
    assert!(off_rows[..4].iter().zip([0.0, 600.0, 1200.0, 1800.0]).all(|(found, set)| (found - set).abs() < 1.0));
    assert_eq!(changes_ms(HELD_MS), None);
}

#[test]
fn lag_is_kept_and_different_clocks_are_aligned() {
    let late = assembled(recording(|frame| Frame { t_ms: frame.t_ms + 200.0, ..frame })).expect("logs");
    let clocks = &late.report.recordings[0].clocks;
    assert!(clocks.shared && clocks.lag_ms == Some(200.0), "{clocks:?}");
    let other = assembled(recording(|frame| Frame { t_ms: frame.t_ms + 1.7e12, ..frame })).expect("logs");
    let clocks = &other.report.recordings[0].clocks;
    assert!(!clocks.shared && (clocks.offset_ms - 1.7e12).abs() < 20.0, "{clocks:?}");
    assert!(max_error_cm(&other.logs) < 1.0, "{}", max_error_cm(&other.logs));
}

#[test]
fn wrong_frames_are_corrected() {
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
        assert!(report.frame.as_ref().is_some_and(|description| description.contains(what)), "{:?}", report.frame);
        assert!(max_error_cm(&logs) < 0.5, "{what}: {}", max_error_cm(&logs));
    }
}

#[test]
fn mirrored_drive_is_mirrored_back_and_exchanged_wheels_are_shown_by_walls() {
    let mirrored = |frame: Frame| {
        let at = frame.pose.position_cm;
        Frame { pose: Pose::new(at.x, -at.y, -frame.pose.heading_rad), ..frame }
    };
    let Assembled { logs, report, .. } = assembled(recording(mirrored)).expect("logs");
    assert!(report.frame.as_ref().is_some_and(|what| what.contains("the frame is mirrored")), "{:?}", report.frame);
    assert!(max_error_cm(&logs) < 0.5, "{}", max_error_cm(&logs));
    let late = |frame: Frame| Frame { t_ms: frame.t_ms + 7e6, ..mirrored(frame) };
    let Assembled { logs, report, .. } = assembled(recording(late)).expect("logs");
    assert!(!report.recordings[0].clocks.shared && max_error_cm(&logs) < 1.5, "{}", max_error_cm(&logs));

    // A room that differs from its mirror image.
    let mut exchanged = recording(|frame| frame);
    exchanged.commands.kind = Kind::Motors;
    exchanged.commands.samples.iter_mut().for_each(|(_, pair)| {
        let [v, w] = *pair;
        *pair = [v + 10.0 * w, v - 10.0 * w].map(|cm_s| 2.0 * cm_s);
    });
    let beam = Rectangle { low_cm: DVec2::new(0.0, 1900.0), high_cm: DVec2::new(2000.0, 1950.0) };
    let scene = Scene { arena_cm: Some(DVec2::new(2000.0, 2000.0)), obstacles: vec![beam], ..Scene::default() };
    let with_sensor = Robot {
        ultrasonic: Some(Ultrasonic { x_cm: 0.0, y_cm: 0.0, yaw_deg: 0.0, min_cm: 1.0, max_cm: 2500.0 }),
        ..robot()
    };
    let centred = |pose: &Pose| Pose { position_cm: pose.position_cm + DVec2::new(1000.0, 1000.0), ..*pose };
    exchanged.poses.iter_mut().for_each(|frame| frame.pose = centred(&frame.pose));
    let reading = |frame: &Frame| {
        let hit = cast(&scene.sides(), frame.pose.position_cm, frame.pose.direction());
        (frame.t_ms, hit.map(|hit| hit.distance_cm))
    };
    let samples = exchanged.poses.iter().map(reading).collect();
    exchanged.readings = vec![Readings { sensor: 0, samples, on_clock_of_poses: false }];
    let stated = Stated::default();
    let Assembled { report, .. } =
        assemble(vec![exchanged], Some((with_sensor, Sensors::default())), scene, stated, |_, _| ()).expect("logs");
    assert!(
        report.frame.as_ref().is_some_and(|what| what.contains("left and right were exchanged")),
        "{:?}",
        report.frame
    );
}

/// A recording whose commands stop for two seconds now and then, and the number of pauses.
fn paused(stops_after_ms: f64) -> (Recording, usize) {
    let is_paused = |ms: f64| ms % 6000.0 > 4000.0;
    let mut recording = recording(|frame| frame);
    recording.commands.samples.retain(|(ms, _)| !is_paused(*ms));
    let mut pose = Pose::new(50.0, 80.0, 0.3);
    recording.poses.clear();
    for i in 0..(LASTS_MS / 10.0) as usize {
        let t_ms = 10.0 * i as f64;
        recording.poses.extend((i % 3 == 0).then_some(Frame { t_ms, pose }));
        let last_ms =
            if is_paused(t_ms) { (t_ms / 6000.0).floor() * 6000.0 + 4000.0 } else { (t_ms / 50.0).floor() * 50.0 };
        if t_ms - last_ms <= stops_after_ms {
            let [v, w] = twist(last_ms);
            pose = pose.compose(&Pose::new(0.01 * v, 0.0, 0.01 * w));
        }
    }
    (recording, (LASTS_MS / 6000.0) as usize - 1)
}

#[test]
fn pauses_show_whether_the_base_stops_by_itself() {
    for (stops_after_ms, expected) in [(500.0, Some(500.0)), (1200.0, Some(1200.0)), (f64::INFINITY, None)] {
        let (recording, number) = paused(stops_after_ms);
        let Assembled { logs, report, .. } = assembled(recording).expect("logs");
        let RecordingReport { clocks, pauses, .. } = &report.recordings[0];
        let pauses = pauses.as_ref().expect("pauses");
        assert_eq!((pauses.number, pauses.determined), (number, Determined::Inferred), "{pauses:?}");
        let off_ms = pauses.stops_after_ms.zip(expected).map_or(0.0, |(found, expected)| (found - expected).abs());
        assert!(off_ms <= 60.0 && pauses.stops_after_ms.is_some() == expected.is_some(), "{pauses:?}");
        assert!(clocks.unexplained.is_some_and(|share| share < 0.05), "{clocks:?}");
        // In the middle of a pause, the command is zero only if the base has stopped.
        let row = logs.runs[0].rows.at(14);
        assert_eq!(row.command() == [0.0; 2], stops_after_ms < 1600.0, "{row:?}");
    }
    let (recording, _) = paused(500.0);
    let stated = Stated { watchdog: Some(Watchdog::None), ..Stated::default() };
    let held = assemble(vec![recording], Some((robot(), Sensors::default())), Scene::default(), stated, |_, _| ())
        .expect("logs");
    let pauses = held.report.recordings[0].pauses.as_ref().expect("pauses");
    assert_eq!((pauses.stops_after_ms, pauses.determined), (None, Determined::Stated));
}

#[test]
fn robot_that_never_moves_is_reported_and_leaves_the_batch() {
    let still = || recording(|frame| Frame { pose: Pose::new(50.0, 80.0, 0.3), ..frame });
    let error = assembled(still()).err().expect("refused").to_string();
    assert!(error.contains("the robot never moves") && error.contains("are the motors on"), "{error}");
    let both = vec![still(), recording(|frame| frame)];
    let Assembled { logs, report, .. } =
        assemble(both, Some((robot(), Sensors::default())), Scene::default(), Stated::default(), |_, _| ())
            .expect("logs");
    assert_eq!(logs.runs.len(), 1);
    assert!(report.left_out[0].reason.contains("the robot never moves"), "{:?}", report.left_out);
}

#[test]
fn gains_of_travel_and_rotation_are_reported() {
    let half = |frame: Frame| Frame { t_ms: frame.t_ms * 2.0, ..frame };
    let mut slow = recording(half);
    slow.commands.samples.iter_mut().for_each(|(ms, _)| *ms *= 2.0);
    let Assembled { report, .. } = assembled(slow).expect("logs");
    let clocks = &report.recordings[0].clocks;
    let gains = clocks.travel_gain.zip(clocks.rotation_gain).expect("motion");
    assert!((gains.0 - 0.5).abs() < 0.02 && (gains.1 - 0.5).abs() < 0.03, "{clocks:?}");
}

#[test]
fn inconsistent_units_are_rejected_with_both_lengths() {
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
fn streams_of_two_drives_are_rejected() {
    let mut other = recording(|frame| frame);
    other.poses.reverse();
    let times: Vec<f64> = other.poses.iter().rev().map(|frame| frame.t_ms).collect();
    other.poses.iter_mut().zip(times).for_each(|(frame, ms)| frame.t_ms = ms);
    let error = assembled(other).err().expect("refused").to_string();
    assert!(error.contains("nothing in common"), "{error}");
    let mut apart = recording(|frame| Frame { t_ms: frame.t_ms + 1e6, ..frame });
    apart.has_one_clock = true;
    let error = assembled(apart).err().expect("refused").to_string();
    assert!(error.contains("(0.0 to 59.6 s) and poses (1000.0 to 1059.9 s) do not overlap"), "{error}");
}

#[test]
fn missing_robot_is_fitted_and_marked() {
    let mut wheels = recording(|frame| frame);
    wheels.commands.kind = Kind::Motors;
    wheels.commands.samples.iter_mut().for_each(|(_, pair)| {
        let [v, w] = *pair;
        *pair = [v - 10.0 * w, v + 10.0 * w].map(|cm_s| 2.0 * cm_s);
    });
    wheels.readings = vec![Readings { sensor: 0, samples: vec![(0.0, Some(50.0))], on_clock_of_poses: false }];
    let Assembled { logs, draft, .. } =
        assemble(vec![wheels], None, Scene::default(), Stated::default(), |_, _| ()).expect("logs");
    let text = draft.expect("a draft").text();
    assert!((logs.robot.full_speed_cm_s - 50.0).abs() < 1.0 && (logs.robot.track_cm - 20.0).abs() < 0.5, "{text}");
    assert!(text.contains("# FILL IN: fitted to these logs") && text.contains("\n[ultrasonic]"), "{text}");
    assert_eq!((logs.runs[0].rows.at(0).echo_cm, logs.runs[0].rows.at(1).echo_cm), (Some(50.0), None));
    let twist =
        assemble(vec![recording(|frame| frame)], None, Scene::default(), Stated::default(), |_, _| ()).expect("logs");
    assert!([20.0, 25.0, 30.0].contains(&twist.logs.robot.full_speed_cm_s), "{}", twist.logs.robot.full_speed_cm_s);
    assert!(twist.draft.expect("a draft").text().contains("\n# [ultrasonic]"));
}

#[test]
fn readings_are_dropped_without_range_sensor() {
    let mut read = recording(|frame| frame);
    read.readings = vec![Readings { sensor: 0, samples: vec![(0.0, Some(50.0))], on_clock_of_poses: false }];
    read.sources = vec![Source::named("readings".into(), &[0.0, 1.0])];
    let Assembled { logs, report, .. } = assembled(read).expect("logs");
    assert!(logs.runs[0].rows.iter().all(|row| row.echo_cm.is_none()));
    assert!(report.left_out[0].reason.contains("no [ultrasonic]"), "{report:?}");
}

#[test]
fn long_tracker_pause_splits_runs() {
    let mut paused = recording(|frame| frame);
    let is_lost = |ms: f64| (20_000.0..30_000.0).contains(&ms) || (40_000.0..41_000.0).contains(&ms);
    paused.poses.retain(|frame| !is_lost(frame.t_ms));
    let Assembled { logs, report, .. } = assembled(paused).expect("logs");
    assert_eq!(logs.runs.iter().map(|run| run.name.as_str()).collect::<Vec<_>>(), ["run-000", "run-001"]);
    assert!((1..=3).contains(&report.recordings[0].without_pose), "{report:?}");
}
