//! `mindgap import streams` and `mindgap import bag` on an exactly known drive.

use std::fmt::Write;

use mindgap_foundations::geometry::Pose;
use mindgap_logs::Row;
use mindgap_tests::command::Sandbox;
use mindgap_tests::ros_bags;

pub(super) const STREAMS: &str =
    "import streams command.csv track.csv --robot robot.toml --out logs --json report.json";
pub(super) const ROBOT: &str =
    "wheel_diameter_cm = 6\ntrack_cm = 20\nbody_radius_cm = 12\nstep_ms = 400\nfull_speed_cm_s = 50\n";
pub(super) const SENSOR: &str = "[ultrasonic]\nx_cm = 0\ny_cm = 0\nyaw_deg = 0\nmin_cm = 4\nmax_cm = 250\n";
/// Number of samples between changes of the command.
const HELD: usize = 12;
const SAMPLES: usize = 1600;
pub(super) const SAMPLE_S: f64 = 0.05;
/// Start of the drive, Unix time.
const BEGIN_S: f64 = 1_717_243_200.0;

/// State of the drive at one time.
pub(super) struct Sample {
    pub(super) s: f64,
    /// m/s and rad/s.
    pub(super) twist: [f64; 2],
    pose: Pose,
    pub(super) range_m: f64,
}

/// Returns a drive by commands that never repeat, without noise.
pub(super) fn drive() -> Vec<Sample> {
    let mut pose = Pose::new(100.0, 50.0, 0.4);
    let samples = (0..SAMPLES).map(|i| {
        let k = (i / HELD) as f64;
        let twist = [0.14 + 0.06 * libm::sin(1.3 * k), 0.5 * libm::sin(2.1 * k) + 0.3 * libm::cos(0.37 * k)];
        let here = Sample { s: SAMPLE_S * i as f64, twist, pose, range_m: 0.5 + 0.001 * i as f64 };
        (0..5).for_each(|_| pose = pose.compose(&Pose::new(100.0 * twist[0] * 0.01, 0.0, twist[1] * 0.01)));
        here
    });
    samples.collect()
}

fn table(header: &str, row: impl Fn(&Sample) -> String) -> String {
    drive().iter().fold(header.to_owned() + "\n", |mut text, sample| {
        writeln!(text, "{}", row(sample)).expect("memory");
        text
    })
}

fn commands() -> String {
    table("t_s,v_m_s,w_rad_s", |s| format!("{:.3},{:.4},{:.4}", s.s, s.twist[0], s.twist[1]))
}

fn track() -> String {
    table("t_s,x_m,y_m,yaw_rad", |s| format!("{:.3},{:.5},{:.5},{:.5}", s.s, x_m(s), y_m(s), s.pose.heading_rad))
}

fn x_m(sample: &Sample) -> f64 {
    sample.pose.position_cm.x / 100.0
}

fn y_m(sample: &Sample) -> f64 {
    sample.pose.position_cm.y / 100.0
}

fn sandbox(commands: &str, track: &str) -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("robot.toml", ROBOT);
    sandbox.write("command.csv", commands);
    sandbox.write("track.csv", track);
    sandbox
}

/// Returns a folder with the inputs of [`STREAMS`].
pub(super) fn with_streams() -> Sandbox {
    sandbox(&commands(), &track())
}

pub(super) fn rows(sandbox: &Sandbox) -> Vec<Row> {
    let logs = sandbox.logs("logs");
    logs.runs.iter().flat_map(|run| &run.rows).collect()
}

/// Expects rows that follow the drive, the first of them `off_ms` after its start.
#[track_caller]
fn assert_driven(rows: &[Row], off_ms: f64, within_cm: f64) {
    let drive = drive();
    assert!(rows.len() > 180, "{}", rows.len());
    for row in rows {
        let sample = &drive[((row.t_ms + off_ms) / 1e3 / SAMPLE_S).round() as usize];
        let pose = row.pose.expect("a pose");
        let off_cm = pose.position_cm.distance(sample.pose.position_cm);
        assert!(off_cm < within_cm, "{off_cm} cm off at {} ms", row.t_ms);
    }
}

#[test]
fn streams_in_any_form_become_the_same_rows() {
    let plain = sandbox(&commands(), &track());
    let said = plain.run(STREAMS);
    assert!(said.contains("forward = v_m_s") && said.contains("one clock: motion lags the commands by 0 ms"), "{said}");
    assert!(said.ends_with("logs: 1 runs\n"), "{said}");
    let expected = rows(&plain);
    assert_driven(&expected, 0.0, 1.0);
    let twist = drive()[0].twist;
    assert!((expected[0].left - 200.0 * (twist[0] - 0.1 * twist[1])).abs() < 0.02, "{:?}", expected[0]);

    // Other separators, names, units and timestamps give the same rows.
    let wheels = table("Time (ms);VL [cm/s];VR [cm/s]", |s| {
        let [v, w] = s.twist;
        format!("{:.0};{:.4};{:.4}", 1000.0 * s.s, 100.0 * v - 10.0 * w, 100.0 * v + 10.0 * w).replace('.', ",")
    });
    let quaternions = table("# by hand\n# stamp\tpose.position.x_mm\tpose.position.y_mm\tqz\tqw", |s| {
        let (sin, cos) = libm::sincos(s.pose.heading_rad / 2.0);
        format!("{:.3}\t{:.2}\t{:.2}\t{sin:.6}\t{cos:.6}", s.s, 1000.0 * x_m(s), 1000.0 * y_m(s))
    });
    let other = sandbox(&wheels, &quaternions);
    other.run(STREAMS);
    assert_alike(&rows(&other), &expected);
}

#[track_caller]
fn assert_alike(found: &[Row], expected: &[Row]) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((a.left - b.left).abs() < 0.05 && (a.right - b.right).abs() < 0.05, "{a:?} {b:?}");
        let off_cm = a.pose.zip(b.pose).map_or(9.0, |(a, b)| a.position_cm.distance(b.position_cm));
        assert!(off_cm < 0.05, "{a:?} {b:?}");
    }
}

/// Expects rotation counters of wheels of 6 cm, and a gyro, that show the drive.
#[track_caller]
pub(super) fn assert_measured(rows: &[Row]) {
    let cm_per_deg = std::f64::consts::PI * 6.0 / 360.0;
    for pair in rows.windows(2) {
        let counted = |deg: fn(&Row) -> Option<f64>| Some((deg(&pair[1])? - deg(&pair[0])?) * cm_per_deg);
        let wheels_cm = [counted(|row| row.rot_left_deg), counted(|row| row.rot_right_deg)];
        for (counted_cm, command) in wheels_cm.into_iter().zip(pair[0].command()) {
            assert!((counted_cm.expect("counters") - 0.2 * command).abs() < 0.1, "{pair:?}");
        }
    }
    // The gyro is that of a sample between two steps.
    let drive = drive();
    for row in rows {
        let near = (row.t_ms / 1e3 / SAMPLE_S).round() as usize;
        let rates =
            drive[near.saturating_sub(1)..(near + 2).min(SAMPLES)].iter().map(|sample| sample.twist[1].to_degrees());
        let (low, high) =
            rates.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), deg| (low.min(deg), high.max(deg)));
        let gyro = row.gyro_deg_s.expect("a gyro");
        assert!((low - 0.01..high + 0.01).contains(&gyro), "{gyro} is not within {low} and {high} at {} ms", row.t_ms);
    }
}

#[test]
fn tables_in_any_dialect_become_the_same_rows() {
    let plain = sandbox(&commands(), &track());
    plain.run(STREAMS);
    let expected = rows(&plain);
    let pose = |s: &Sample| {
        let (sin, cos) = libm::sincos(s.pose.heading_rad / 2.0);
        format!("{:.5},{:.5},0.1,0,0,{sin:.6},{cos:.6}", x_m(s), y_m(s))
    };
    let ns = |s: &Sample| (1e3 * s.s).round() as u64 * 1_000_000 + 1_717_243_200_000_000_000;
    let rostopic = table("%time,field.linear.x,field.linear.y,field.angular.z", |s| {
        format!("{},{:.4},0.0,{:.4}", ns(s), s.twist[0], s.twist[1])
    });
    let fields = "field.pose.position.x,field.pose.position.y,field.pose.position.z,field.pose.orientation.x,\
                  field.pose.orientation.y,field.pose.orientation.z,field.pose.orientation.w";
    let stamped = table(&format!("%time,field.header.seq,field.header.stamp,{fields}"), |s| {
        format!("{},1,{},{}", ns(s) + 4_000_000, ns(s), pose(s))
    });
    let tum = drive()
        .iter()
        .fold(String::new(), |text, s| text + &format!("{:.3} {}\n", BEGIN_S + s.s, pose(s).replace(',', " ")));
    let spreadsheet = commands().replace('.', ",").replace("t_s,v_m_s,w_rad_s", "sep=;\nt_s;v_m_s;w_rad_s");
    let spreadsheet: String = spreadsheet
        .lines()
        .map(|line| {
            // Three cells with decimal commas.
            let parts: Vec<&str> = line.split(',').collect();
            if let [a, b, c, d, e, f] = parts.as_slice() {
                format!("{a},{b};{c},{d};{e},{f}\n")
            } else {
                format!("{line}\n")
            }
        })
        .collect();
    let of_day = table("time,x_m,y_m,yaw_rad", |s| {
        let seconds = 86_390.0 + s.s;
        let (hours, rest) = ((seconds / 3600.0).floor() % 24.0, seconds % 3600.0);
        let (minutes, seconds) = ((rest / 60.0).floor(), rest % 60.0);
        format!("{hours:02}:{minutes:02}:{seconds:06.3},{:.5},{:.5},{:.5}", x_m(s), y_m(s), s.pose.heading_rad)
    });
    let boot = format!("rst:0x1 (POWERON),boot:0x13\nready\n{}99", commands());
    for (name, commands, track, words) in [
        ("rostopic", &rostopic, &stamped, "the stamps in the messages"),
        ("spreadsheet", &spreadsheet, &tum, "a TUM trajectory"),
        ("boot", &boot, &track(), "the last line, is incomplete"),
        ("times of day", &commands(), &of_day, "two clocks"),
    ] {
        let other = sandbox(commands, track);
        let said = other.run(STREAMS);
        assert!(said.contains(words), "{name}: {said}");
        if name == "rostopic" || name == "boot" {
            assert_alike(&rows(&other), &expected);
        } else {
            assert_driven(&rows(&other), 0.0, 1.5);
        }
    }
}

#[test]
fn a_bad_file_leaves_the_batch_and_the_rest_is_imported() {
    let sandbox = sandbox(&commands(), &track());
    sandbox.write("empty.csv", "");
    sandbox.write("other.csv", track());
    let back = track().replacen("2.000,", "0.400,", 1);
    sandbox.write("back.csv", &back);
    sandbox.write("more.csv", commands());
    let call = STREAMS.replace("command.csv track.csv", "command.csv empty.csv more.csv track.csv other.csv back.csv");
    let said = sandbox.run(&call);
    assert!(said.contains("excluded: other.csv: the other file of its drive cannot be used"), "{said}");
    assert!(said.contains("excluded: empty.csv: is empty") && said.contains("logs: 1 runs"), "{said}");
    let report = sandbox.json("report.json");
    let left_out: Vec<String> = report["left_out"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|entry| {
            format!(
                "{} {}: {}",
                entry["what"].as_str().unwrap_or(""),
                entry["name"].as_str().unwrap_or(""),
                entry["reason"]
            )
        })
        .collect();
    assert!(
        left_out.iter().any(|line| line.starts_with("file back.csv: \"line 42: the clock goes back")),
        "{left_out:?}"
    );
    let refusal = sandbox.refused(&STREAMS.replace("track.csv", "back.csv").replace("--out logs", "--out none"));
    assert!(refusal.starts_with("back.csv:42: the clock goes back"), "{refusal}");
    sandbox.write("bag.csv", b"\x89MCAP0\r\n");
    let refusal = sandbox.refused(&STREAMS.replace("track.csv", "bag.csv").replace("--out logs", "--out none"));
    assert!(refusal.starts_with("bag.csv: is a bag in MCAP: use `mindgap import bag`"), "{refusal}");
}

#[test]
fn a_track_without_rotation_and_a_track_width_in_metres_are_refused() {
    let constant = table("t_s,x_m,y_m,yaw_rad", |s| format!("{:.3},{:.5},{:.5},0.1", s.s, x_m(s), y_m(s)));
    let refusal = sandbox(&commands(), &constant).refused(STREAMS);
    assert!(refusal.contains("the heading never changes, although the commands turn the robot by"), "{refusal}");
    let wheels = table("t_s,vl_m_s,vr_m_s", |s| {
        format!("{:.3},{:.4},{:.4}", s.s, s.twist[0] - 0.1 * s.twist[1], s.twist[0] + 0.1 * s.twist[1])
    });
    for (track_cm, unit) in [("0.2", "m"), ("200", "mm")] {
        let sandbox = sandbox(&wheels, &track());
        sandbox.write("robot.toml", ROBOT.replace("track_cm = 20", &format!("track_cm = {track_cm}")));
        let refusal = sandbox.refused(STREAMS);
        assert!(refusal.contains(&format!("track_cm in robot.toml seems to be in {unit};")), "{refusal}");
    }
}

#[test]
fn recordings_and_exchanged_arguments_are_pointed_out() {
    let sandbox = with_streams();
    sandbox.write("drive.mcap", b"\x89MCAP0\r\n");
    let outcome = sandbox.call("diagnose drive.mcap");
    assert!(outcome.code == 2 && outcome.err.contains("mindgap import bag drive.mcap"), "{}", outcome.err);
    let refusal = sandbox.refused("diagnose kinematic drive.mcap");
    assert!(refusal.starts_with("drive.mcap: is a file, not a folder of logs: import it with"), "{refusal}");
    sandbox.run(STREAMS);
    let refusal = sandbox.refused("diagnose logs robot.toml");
    assert!(refusal.contains("exchanged"), "{refusal}");
    sandbox.write("scene.toml", "[arena]\nwidth_cm = 300\nheight_cm = 200\n");
    let exchanged = STREAMS.replace("robot.toml", "scene.toml").replace("--out", "--scene robot.toml --out");
    assert!(sandbox.refused(&exchanged.replace("--out logs", "--out none")).contains("--robot and --scene exchanged"));
    sandbox.write("logs/run-001.CSV", "");
    sandbox.write("logs/run_002.csv", "");
    let said = sandbox.call("check logs").err;
    assert!(said.contains("logs: passed over run-001.CSV, run_002.csv"), "{said}");
}

#[test]
fn separate_clocks_are_aligned_by_the_motion() {
    let iso = table("timestamp,x_m,y_m,yaw_deg", |s| {
        let seconds = 5.0 + s.s;
        let (minutes, seconds) = ((seconds / 60.0).floor(), seconds % 60.0);
        let heading_deg = s.pose.heading_rad.to_degrees();
        format!("2024-06-01T12:{minutes:02}:{seconds:06.3}Z,{:.5},{:.5},{heading_deg:.3}", x_m(s), y_m(s))
    });
    let sandbox = sandbox(&commands(), &iso);
    let said = sandbox.run(STREAMS);
    assert!(said.contains("two clocks") && said.contains("a delay of the robot is not visible"), "{said}");
    let clocks = sandbox.json("report.json")["recordings"][0]["clocks"].clone();
    let off_ms = clocks["offset_ms"].as_f64().expect("a number") - 1e3 * (BEGIN_S + 5.0);
    assert!(off_ms.abs() < 25.0, "{clocks}");
    assert_driven(&rows(&sandbox), 0.0, 1.5);
    sandbox.run(&format!("{STREAMS} --force --offset-ms {}", 1e3 * (BEGIN_S + 5.0)));
    assert_driven(&rows(&sandbox), 0.0, 1.0);
}

#[test]
fn inconsistent_streams_are_refused_with_both_values() {
    let metres_as_cm = track().replacen("x_m,y_m", "x_cm,y_cm", 1);
    let refusal = sandbox(&commands(), &metres_as_cm).refused(STREAMS);
    assert!(refusal.starts_with("track.csv: the commands travel 1"), "{refusal}");
    assert!(refusal.contains("the track seems to be in m and was read in cm"), "{refusal}");
    let degrees_as_rad = table("t_s,x_m,y_m,yaw_rad", |s| {
        format!("{:.3},{:.5},{:.5},{:.4}", s.s, x_m(s), y_m(s), s.pose.heading_rad.to_degrees())
    });
    sandbox(&commands(), &degrees_as_rad).refused(STREAMS);
    let later = table("t_s,x_m,y_m,yaw_rad", |s| format!("{:.3},1,1,0", 500.0 + s.s));
    let refusal = sandbox(&commands(), &later).refused(STREAMS);
    assert!(refusal.contains("the robot never moves"), "{refusal}");
    let unknown = sandbox(&commands().replacen("v_m_s", "speedy", 1), &track());
    let refusal = unknown.refused(STREAMS);
    assert!(refusal.starts_with("command.csv:1: no column for forward"), "{refusal}");
    unknown.write(
        "map.toml",
        "[\"command.csv\"]\ntime = \"t_s\"\nforward = { column = \"speedy\", unit = \"m/s\" }\nturn = \"w_rad_s\"\n",
    );
    unknown.run(&format!("{STREAMS} --map map.toml"));
    assert_driven(&rows(&unknown), 0.0, 1.0);
}

#[test]
fn a_frame_with_y_downwards_is_corrected() {
    let downwards =
        table("t_s,x_m,y_m,yaw_rad", |s| format!("{:.3},{:.5},{:.5},{:.5}", s.s, x_m(s), -y_m(s), s.pose.heading_rad));
    let sandbox = sandbox(&commands(), &downwards);
    let said = sandbox.run(STREAMS);
    assert!(said.contains("frame: positions are mirrored"), "{said}");
    assert_driven(&rows(&sandbox), 0.0, 1.0);
}

#[test]
fn without_a_robot_file_a_draft_asks_for_its_values() {
    let sandbox = sandbox(&commands(), &track());
    let call = "import streams command.csv track.csv --out logs";
    let said = sandbox.run(call);
    assert!(said.contains("fill in: robot.toml: track_cm = 15"), "{said}");
    assert!(sandbox.text("logs/robot.toml").contains("# [ultrasonic]"), "{}", sandbox.text("logs/robot.toml"));
    assert_driven(&rows(&sandbox), 0.0, 1.0);
    let output = sandbox.call("check logs").err;
    assert!(output.contains("2 more: still marked FILL IN"), "{output}");
    // What is there is the user's by now.
    let refusal = sandbox.refused(call);
    assert!(refusal.starts_with("logs: already contains") && refusal.contains("--force"), "{refusal}");
    sandbox.run(&format!("{call} --force"));
}

#[test]
fn bags_give_the_same_rows_from_different_topics() {
    let sandbox = sandbox(&commands(), &track());
    sandbox.write("robot.toml", format!("{ROBOT}{SENSOR}"));
    let drive = table("t_s,v_m_s,w_rad_s,x_m,y_m,qz,qw,range_m", |s| {
        let (sin, cos) = libm::sincos(s.pose.heading_rad / 2.0);
        let [v, w] = s.twist;
        format!("{:.3},{v},{w},{},{},{sin},{cos},{}", BEGIN_S + s.s, x_m(s), y_m(s), s.range_m)
    });
    sandbox.write("drive.csv", drive);
    ros_bags::write(&sandbox.path().join("drive.csv"), sandbox.path());
    let import = |bag: &str| {
        let said = sandbox.run(&format!("import bag {bag} --robot robot.toml --out logs --json report.json --force"));
        (said, rows(&sandbox))
    };
    let (said, tracked) = import("tracker.mcap");
    assert!(said.contains("/robot/pose") && said.contains("one clock"), "{said}");
    assert_driven(&tracked, 0.0, 1.0);
    // The latest reading, or the one before, depending on the last digits of the clock.
    assert!((tracked[10].echo_cm.expect("a reading") - (50.0 + 0.1 * 80.0)).abs() < 0.11, "{:?}", tracked[10]);
    let (said, by_odometry) = import("odometry.mcap");
    assert!(said.contains("may be the robot's own odometry"), "{said}");
    assert_alike(&by_odometry, &tracked);
    assert!(
        said.contains(" with rotation counters, ") && said.contains("/joint_states:camera_joint: not taken"),
        "{said}"
    );
    assert_measured(&by_odometry);
    let (said, by_transforms) = import("transforms.mcap");
    assert!(said.contains("/tf:map>base_link") && by_transforms[10].echo_cm.is_none(), "{said}");
    assert_eq!(by_transforms.len(), tracked.len());
    let (said, localised) = import("localised.mcap");
    assert!(
        said.contains(
            "/tf:map>base_link is composed of /tf:map>odom and /tf:odom>torso and /tf_static:torso>base_link"
        ),
        "{said}"
    );
    // After the last message of the localiser its frame stays in place.
    assert_driven(&localised, 0.0, 1.0);
    let (said, untracked) = import("untracked.mcap");
    assert!(said.contains("poses: no poses were found: ") && said.contains(" with a gyro"), "{said}");
    assert!(untracked.len() == tracked.len() && untracked.iter().all(|row| row.pose.is_none()), "{said}");
    assert_measured(&untracked);
    let (said, both) = import("tracker.mcap untracked.mcap");
    assert!(said.contains("no poses were found in 1 of 2 recordings") && said.contains("tracked"), "{said}");
    assert_eq!((both.len(), both.iter().filter(|row| row.pose.is_some()).count()), (2 * tracked.len(), tracked.len()));
    let refusal = sandbox.refused("import bag untracked.mcap --left-joint a --right-joint b --out other");
    assert!(refusal.contains("has no joint a"), "{refusal}");
    let refusal = sandbox.refused("import bag tracker.mcap --poses /nowhere --out other");
    assert!(refusal.starts_with("tracker.mcap: /nowhere is not a topic of poses"), "{refusal}");
    sandbox.run("check logs");
}
