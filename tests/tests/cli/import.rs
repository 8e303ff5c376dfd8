//! `mindgap import` on drives of the built-in robot, each split into the log of a brick and the track of a camera.

use mindgap_built_in_robot::{BuiltInRobot, default_robot};
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::random::{Generator, generator};
use mindgap_logs::Scene;
use mindgap_tests::command::Sandbox;
use mindgap_tests::form::short_or_long;
use mindgap_tests::range_sensors::table;
use rand::RngExt;

/// Largest error of a clock offset.
const ALIGNED_MS: f64 = 15.0;
const STEPS: usize = 60;
const STEP_MS: f64 = 400.0;
/// Step of the simulation. A camera's frame comes after three or four of them.
const SLICE_MS: f64 = 10.0;
const SIDE_CM: f64 = 1000.0;
const SCENE: &str = "[arena]\nwidth_cm = 1000\nheight_cm = 1000\n";
pub(super) const CALL: &str =
    "import run-000.csv track.csv --scene scene.toml --robot robot.toml --out logs --json report.json";

/// The camera's clock relative to the brick's.
#[derive(Clone, Copy)]
struct Camera {
    offset_ms: f64,
    drift: f64,
}

impl Camera {
    fn ms(&self, brick_ms: f64) -> f64 {
        self.offset_ms + (1.0 + self.drift) * brick_ms
    }
}

/// A drive as its two recordings show it.
struct Drive {
    brick_log: String,
    /// The robot rests for three seconds before and after the drive. The track has a gap of 1.5 s and some jumps.
    track: String,
    /// True pose at every row.
    poses: Vec<Pose>,
}

fn drive(seed: u64, camera: Camera) -> Drive {
    let rng = &mut generator(seed, &[1]);
    let scene = Scene { arena_cm: Some(glam::DVec2::splat(SIDE_CM)), ..Scene::default() };
    let robot = BuiltInRobot::new(&default_robot(), &scene, &[]);
    let mut body = robot.start(Pose::new(SIDE_CM / 2.0, SIDE_CM / 2.0, 0.0), rng);
    let mut brick_log = "t_ms,left,right,rot_left_deg,rot_right_deg,battery_mv,echo_cm\r\n".to_owned();
    let mut track = "time_s,x_m,y_m,yaw_rad\n".to_owned();
    let mut poses = Vec::new();
    let mut frame = |brick_ms: f64, pose: Option<Pose>, rng: &mut Generator| {
        let time_s = (camera.ms(brick_ms) + rng.random_range(-4.0..4.0)) / 1000.0;
        let lost = (9_000.0..10_500.0).contains(&brick_ms) || rng.random_bool(0.05);
        let jump_m = if rng.random_bool(0.01) { 0.8 } else { 0.0 };
        let seen = pose.filter(|_| !lost).map(|p| (p.position_cm / 100.0, p.heading_rad));
        track += &match seen {
            Some((at_m, rad)) => format!("{time_s:.4},{:.4},{:.4},{rad:.4}\n", at_m.x + jump_m, at_m.y),
            None => format!("{time_s:.4},,,\n"),
        };
    };
    (1..90).rev().for_each(|i| frame(-35.0 * f64::from(i), body.track(rng), rng));
    let mut command = [0.0; 2];
    for step in 0..=STEPS {
        if step % 2 == 0 {
            command = [rng.random_range(-40..80), rng.random_range(-40..80)].map(f64::from);
        }
        let t_ms = STEP_MS * step as f64;
        let row = body.row(command, body.clone().read_sonar(rng), rng);
        let counters = [row.rot_left_deg, row.rot_right_deg].map(|deg| deg.map_or(0.0, f64::round));
        let echo = row.echo_cm.map_or(String::new(), |cm| format!("{cm:.0}"));
        let [left, right] = command;
        brick_log += &format!("{t_ms},{left},{right},{},{},8000,{echo}\r\n", counters[0], counters[1]);
        poses.push(body.true_pose());
        for slice in 0..40 {
            if slice % 7 == 0 || slice % 7 == 4 {
                frame(t_ms + SLICE_MS * f64::from(slice), body.track(rng), rng);
            }
            let [left, right] = if step == STEPS { [0.0; 2] } else { command };
            body.drive([left, right], SLICE_MS, rng);
        }
    }
    let end_ms = STEP_MS * (STEPS + 1) as f64;
    (0..90).for_each(|i| frame(end_ms + 35.0 * f64::from(i), body.track(rng), rng));
    assert!(!body.crashed());
    Drive { brick_log, track, poses }
}

/// Returns a folder with a robot, a scene and the two files of a drive.
fn sandbox(drive: &Drive) -> Sandbox {
    let sandbox = Sandbox::new();
    default_robot().write(&sandbox.path().join("robot.toml")).expect("a folder that can be written");
    sandbox.write("scene.toml", SCENE);
    sandbox.write("run-000.csv", &drive.brick_log);
    sandbox.write("track.csv", &drive.track);
    sandbox
}

/// Returns a folder with the inputs of [`CALL`].
pub(super) fn with_a_drive() -> Sandbox {
    sandbox(&drive(0, Camera { offset_ms: 3e4, drift: 5e-5 }))
}

#[test]
fn clocks_are_aligned_and_each_row_gets_its_pose() {
    for seed in 0..short_or_long(3, 12u64) {
        let rng = &mut generator(seed, &[2]);
        let camera = Camera { offset_ms: rng.random_range(-9e4..9e5), drift: rng.random_range(-2e-4..2e-4) };
        let drive = drive(seed, camera);
        let sandbox = sandbox(&drive);
        sandbox.run(CALL);
        let run = sandbox.json("report.json")["logs"][0]["run"].clone();
        let number = |name: &str| run[name].as_f64().expect("a number");
        for brick_ms in [0.0, STEP_MS * STEPS as f64] {
            let off_ms = number("offset_ms") + (1.0 + number("drift")) * brick_ms - camera.ms(brick_ms);
            assert!(off_ms.abs() < ALIGNED_MS, "seed {seed}: off by {off_ms} ms at {brick_ms} ms: {run}");
        }
        assert!((3.0..7.0).contains(&number("in_gaps")) && number("outside") == 0.0, "{run}");
        let jumps = sandbox.json("report.json")["tracks"][0]["jumps"].as_f64().expect("a number");
        assert!((1.0..30.0).contains(&jumps), "{jumps}");
        let logs = sandbox.logs("logs");
        for (row, pose) in logs.runs[0].rows.iter().zip(&drive.poses) {
            let off_cm = row.pose.map_or(0.0, |seen| seen.position_cm.distance(pose.position_cm));
            assert!(off_cm < 2.5, "seed {seed}: {off_cm} cm off at {} ms", row.t_ms);
        }
    }
}

#[test]
fn several_runs_are_matched_to_their_tracks() {
    let cameras = [3e4, -2e3, 7e5].map(|offset_ms| Camera { offset_ms, drift: 5e-5 });
    let [first, second, third] = [21, 22, 23].map(|seed| drive(seed, cameras[seed as usize - 21]));
    let sandbox = sandbox(&first);
    sandbox.write("tired.csv", &second.brick_log);
    sandbox.write("long.csv", second.track + third.track.split_once('\n').expect("a header").1);
    sandbox.write("other.csv", &third.brick_log);
    sandbox.write("torn.csv", &first.brick_log[..first.brick_log.len() - 9]);
    let said = sandbox.run(&CALL.replace("run-000.csv", "run-000.csv long.csv tired.csv other.csv torn.csv"));
    assert!(said.contains("torn.csv: the last line is incomplete and was excluded"), "{said}");
    let report = sandbox.json("report.json");
    let of = |log: usize| report["logs"][log]["run"]["track"].as_str().map(str::to_owned);
    let tracks = ["track.csv", "long.csv", "long.csv", "track.csv"].map(|name| Some(name.to_owned()));
    assert_eq!([of(0), of(1), of(2), of(3)], tracks, "{said}");
    sandbox.run("check logs");
}

#[test]
fn the_robot_is_found_among_the_bodies_of_a_take() {
    let sandbox = with_a_drive();
    let mut take = "Format Version,1.23,Rotation Type,Quaternion,Length Units,Meters\n\n".to_owned();
    let repeat = |cell: &str, count: usize| vec![cell; count].join(",");
    let kinds = format!("{},{}", repeat("Rotation", 4), repeat("Position", 3));
    take += &format!(",Type,{}\n,Name,{},{}\n", repeat("Rigid Body", 14), repeat("corner", 7), repeat("rover", 7));
    take += &format!(",,{kinds},{kinds}\nFrame,Time (Seconds),X,Y,Z,W,X,Y,Z,X,Y,Z,W,X,Y,Z\n");
    for (i, line) in sandbox.text("track.csv").lines().skip(1).enumerate() {
        let cells: Vec<Option<f64>> = line.split(',').map(|cell| cell.parse().ok()).collect();
        let rover = cells[1].zip(cells[2]).zip(cells[3]).map_or(",,,,,,".into(), |((x, y), rad)| {
            let (sin, cos) = libm::sincos(rad / 2.0);
            format!("0,{sin},0,{cos},{x},0.1,{}", -y)
        });
        take += &format!("{i},{},0,0,0,1,2,0.1,2,{rover}\n", cells[0].expect("a time"));
    }
    sandbox.write("take.csv", take);
    sandbox.run(CALL);
    let expected = sandbox.text("logs/run-000.csv");
    let said = sandbox.run(&format!("{} --force", CALL.replace("track.csv", "take.csv")));
    assert!(said.contains("run-000 (rover)") && said.contains("excluded: body corner: it does not move"), "{said}");
    assert_eq!(sandbox.json("report.json")["left_out"][0]["name"], "corner");
    let cells = |text: &str| {
        text.lines().skip(1).flat_map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>()).collect::<Vec<_>>()
    };
    for (a, b) in cells(&expected).iter().zip(cells(&sandbox.text("logs/run-000.csv"))) {
        let off = a.parse::<f64>().unwrap_or(0.0) - b.parse::<f64>().unwrap_or(0.0);
        assert!(off.abs() < 0.1 || off.abs() > 359.9, "{a} and {b}");
    }
    let refusal = sandbox.refused(&format!("{} --force --body cat", CALL.replace("track.csv", "take.csv")));
    assert!(refusal.starts_with("take.csv: has no body of the name that --body states"), "{refusal}");
    let info = sandbox.run("info take.csv --json info.json");
    assert!(info.contains("motion capture by Motive") && info.contains("bodies: corner, rover"), "{info}");
    assert_eq!(sandbox.json("info.json")["files"][0]["bodies"][1], "rover");
}

#[test]
fn without_a_track_counters_are_imported_and_diagnosed() {
    let sandbox = with_a_drive();
    let untracked = CALL.replace("track.csv", "");
    let said = sandbox.run(&untracked);
    assert!(
        said.contains("poses: no poses were found: a diagnosis compares the commands with rotation counters"),
        "{said}"
    );
    let report = sandbox.json("report.json");
    let run = &report["logs"][0]["run"];
    assert!(run["track"].is_null() && run["offset_ms"].is_null() && run["outside"] == run["rows"], "{run}");
    let logs = sandbox.logs("logs");
    let rows = &logs.runs[0].rows;
    assert!(rows.len() == STEPS + 1 && rows.iter().all(|row| row.pose.is_none() && row.rot_left_deg.is_some()));
    assert!(sandbox.run("check logs").contains("100 % of rows have rot_left_deg, rot_right_deg"));
    sandbox.run("diagnose kinematic logs --json gap.json");
    assert_eq!(sandbox.json("gap.json")["compared"], serde_json::json!(["rot_left", "rot_right"]));
    // A track that cannot be read is no missing track, and a log that cannot be read leaves the others.
    sandbox.write("broken.csv", "time_s,x_m\n0,1\n1,1\n");
    let refusal = sandbox.refused(&format!("{untracked} broken.csv").replace("--out logs", "--out none"));
    assert!(refusal.starts_with("broken.csv:1: no column for y"), "{refusal}");
    sandbox.write("torn.csv", "t_ms,left,right,rot_left_deg,rot_right_deg\n0,1,1,0,0\n");
    let said = sandbox.run(&format!("{untracked} torn.csv --force"));
    assert!(said.contains("excluded: torn.csv: has 1 row(s)"), "{said}");
    sandbox.edit_cells("run-000.csv", |cells| (cells[3], cells[4]) = ("0", "0"));
    let refusal = sandbox.refused(&untracked.replace("--out logs", "--out none"));
    assert!(refusal.starts_with("run-000.csv: its rotation counters never change"), "{refusal}");
}

#[test]
fn every_range_sensor_of_a_brick_is_read_under_its_name() {
    let sandbox = with_a_drive();
    sandbox.edit("robot.toml", |text| text + &table("left", 90.0) + &table("rear", 180.0));
    let header = "t_ms,left,right,rot_left_deg,rot_right_deg,battery_mv,echo_cm";
    sandbox.edit("run-000.csv", |text| {
        let row = |(at, line): (usize, &str)| {
            format!("{line},{}\r\n", if at == 0 { "echo_left_cm".into() } else { (50 + at).to_string() })
        };
        assert!(text.starts_with(header), "{text}");
        text.lines().enumerate().map(row).collect()
    });
    let outcome = sandbox.call(CALL);
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    assert!(
        outcome.err.contains("range sensor rear of robot.toml has no readings: echo_rear_cm is not written"),
        "{}",
        outcome.err
    );
    let logs = sandbox.logs("logs");
    let rows = &logs.runs[0].rows;
    assert_eq!(rows.sensors().names().collect::<Vec<_>>(), ["ultrasonic", "left"]);
    assert!((0..rows.len()).all(|row| rows.further_cm(0, row) == Some(51.0 + row as f64)));
    assert!(rows.iter().any(|row| row.echo_cm.is_some()) && rows.iter().any(|row| row.pose.is_some()));
}

#[test]
fn logs_and_tracks_of_different_drives_are_refused() {
    let camera = Camera { offset_ms: 5e3, drift: 0.0 };
    let drive_of = |seed| drive(seed, camera);
    let sandbox = sandbox(&drive_of(31));
    sandbox.write("track.csv", drive_of(32).track);
    let refusal = sandbox.refused(CALL);
    assert!(refusal.starts_with("run-000.csv: no track matches"), "{refusal}");
    let brief: String = drive_of(31).track.lines().take(40).map(|line| line.to_owned() + "\n").collect();
    sandbox.write("track.csv", brief);
    let refusal = sandbox.refused(CALL);
    assert!(refusal.starts_with("run-000.csv: no track overlaps"), "{refusal}");
    sandbox.write("track.csv", drive(31, Camera { drift: 0.01, ..camera }).track);
    let refusal = sandbox.refused(CALL);
    assert!(refusal.contains("drift apart by 10.") || refusal.contains("drift apart by 9."), "{refusal}");
    let refusal = sandbox.refused(&CALL.replace("run-000.csv", ""));
    assert!(refusal.contains("none of the files is a log of a brick"), "{refusal}");
    sandbox.write("track.csv", "t,x,y,theta\n0,1,1,0\n33,1,1,0\n");
    let refusal = sandbox.refused(CALL);
    assert!(refusal.starts_with("track.csv:1: column x has no unit: name it x_m"), "{refusal}");
}
