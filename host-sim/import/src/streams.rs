//! Joins tables of commands, poses and readings to the recordings of drives.

use std::path::PathBuf;

use super::batch::{Batch, Drive};
use super::choice;
use super::file_streams::{BodyTrack, FileStreams};
use super::left_out::LeftOut;
use super::own_motion::{OwnMotion, Series};
use super::recording::{Commands, Kind, Readings, Recording};
use super::statements::Statements;
use mindgap_foundations::error::Result;

/// Recordings, and files that belong to none.
#[derive(Debug)]
pub struct Recordings {
    /// The recordings.
    pub recordings: Vec<Recording>,
    /// Files that were left out.
    pub left_out: Vec<LeftOut>,
}

/// Reads files and joins them into recordings. A file with commands and poses is a recording by itself; otherwise the first file
/// with commands is joined with the first with poses and the first with readings, and so on. A file that cannot be used is left
/// out with its drive, and so is a second file with the same content. `watch` receives the number of files read so far and their
/// total.
///
/// # Errors
/// When no file can be used, or when the numbers of files of each kind differ.
pub fn recordings(files: &[PathBuf], stated: &Statements, watch: impl Fn(usize, usize)) -> Result<Recordings> {
    stated.mapping.check(files)?;
    let (mut batch, mut left_out, mut error) = (Batch::default(), Vec::new(), None);
    for (file, before) in files.iter().zip(0..) {
        watch(before, files.len());
        if files[..before].contains(file) {
            left_out.push(LeftOut::file(file, "is given twice"));
            continue;
        }
        match FileStreams::read(file, stated) {
            Ok(parts) => batch.add(before, parts),
            Err(e) => {
                left_out.push(LeftOut::failed(file, &e));
                error = error.or(Some(e));
                batch.failed.push(before);
            }
        }
    }
    if batch.is_empty()
        && let Some(error) = error
    {
        return Err(error);
    }
    let drives = batch.drives(&mut left_out).map_err(|e| error.take().unwrap_or(e))?;
    let mut recordings = Vec::new();
    for drive in drives {
        let file = drive.last().map(|streams| streams.file.clone());
        match joined(drive, stated.body.as_deref()) {
            Ok(recording) => recordings.push(recording),
            Err(e) => {
                left_out.extend(file.map(|file| LeftOut::failed(&file, &e)));
                error = error.or(Some(e));
            }
        }
    }
    match error {
        Some(error) if recordings.is_empty() => Err(error),
        _ => Ok(Recordings { recordings, left_out }),
    }
}

/// Joins files with complementary streams into one recording.
fn joined(files: Drive, body: Option<&str>) -> Result<Recording> {
    let is_tracked = files.iter().any(|streams| !streams.bodies.is_empty());
    let mut recording = Recording {
        commands: Commands { kind: Kind::Motors, samples: Vec::new() },
        poses: Vec::new(),
        file: PathBuf::new(),
        readings: Vec::new(),
        own_motion: OwnMotion::default(),
        has_one_clock: files.len() == 1,
        sources: Vec::new(),
    };
    let mut bodies: Option<(PathBuf, Vec<BodyTrack>)> = None;
    for FileStreams { file, commands, bodies: of_file, readings, counters, gyro, mut source } in files {
        // A separate file of what the robot measured was written by the robot, like its commands. Without poses it stands in for
        // them, and the motion shows whether its clock is that of the commands.
        let on_clock_of_poses = commands.is_none() && !of_file.is_empty();
        let own_on_clock_of_poses = commands.is_none() && (!of_file.is_empty() || !is_tracked);
        for (sensor, samples) in readings {
            if recording.readings.iter().all(|readings| readings.sensor != sensor) {
                recording.readings.push(Readings { sensor, samples, on_clock_of_poses });
            }
        }
        let OwnMotion { wheels, gyro: known } = &mut recording.own_motion;
        for (wheels, of_file) in wheels.iter_mut().zip(counters).filter(|(wheels, _)| wheels.is_empty()) {
            for samples in of_file {
                let (wheel, dropped) = Series::of_wheel(samples, own_on_clock_of_poses);
                wheels.push(wheel);
                source.unused.extend(dropped.map(|dropped| dropped.of(&file)));
            }
        }
        if let (None, Some(samples)) = (&known, gyro) {
            let (gyro, dropped) = Series::of_gyro(samples, own_on_clock_of_poses);
            *known = Some(gyro);
            source.unused.extend(dropped.map(|dropped| dropped.of(&file)));
        }
        if let Some(commands) = commands {
            (recording.commands, recording.file) = (commands, file.clone());
        }
        if !of_file.is_empty() {
            bodies = Some((file, of_file));
        }
        recording.sources.push(source);
    }
    recording.readings.sort_by_key(|readings| readings.sensor);
    if let Some((file, bodies)) = bodies {
        let (chosen, others) = choice::robot(&file, bodies, &recording.commands, body)?;
        if let Some(source) = recording.sources.iter_mut().find(|source| source.is_of(&file)) {
            source.guessed.extend((!chosen.name.is_empty()).then(|| format!("the robot is {}", chosen.name)));
            source.unused.extend(others.into_iter().map(|other| other.of(&file)));
        }
        (recording.poses, recording.file) = (chosen.frames.into_iter().flatten().collect(), file);
    }
    if !recording.is_tracked() {
        recording.has_one_clock |= !recording.own_motion.is_on_clock_of_poses();
    }
    Ok(recording)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::Mapping;
    use mindgap_files as files;
    use mindgap_logs::range_sensor::RangeSensor;

    fn read_all(texts: &[(&str, &str)]) -> Result<Recordings> {
        let folder = tempfile::tempdir().expect("a folder");
        let files: Vec<PathBuf> = texts.iter().map(|(name, _)| folder.path().join(name)).collect();
        files.iter().zip(texts).for_each(|(file, (_, text))| files::write(file, text).expect("written"));
        recordings(&files, &Statements::default(), |_, _| ())
    }

    fn read(texts: &[(&str, &str)]) -> Result<Vec<Recording>> {
        read_all(texts).map(|found| found.recordings)
    }

    #[test]
    fn single_file_is_a_recording() {
        let text = "t_ms,cmd_left,cmd_right,x_m,y_m,qz,qw,range_mm\n0,1,-1,0.5,0.25,1,0,730\n20,0.5,0.5,,,,,inf\n10,0,0,,,,,\n";
        let recording = read(&[("all.csv", text)]).expect("a recording").remove(0);
        assert_eq!(recording.commands.kind, Kind::Motors);
        assert_eq!(recording.commands.samples, [(0.0, [100.0, -100.0]), (20.0, [50.0, 50.0])]);
        let frame = recording.poses[0];
        assert_eq!((frame.pose.position_cm.x, frame.pose.heading_rad), (50.0, std::f64::consts::PI));
        assert_eq!(recording.poses.len(), 1);
        assert_eq!(recording.readings[0].samples, [(0.0, Some(73.0)), (20.0, None)]);
        assert!(recording.has_one_clock);
    }

    #[test]
    fn files_are_joined_in_order() {
        let command = "time,v_m_s,w_rad_s\n2024-06-01T12:00:00Z,0.1,0\n2024-06-01T12:00:01Z,0.2,1\n";
        let track = "t;x_cm;y_cm;yaw_deg\n1717243200,0;1;2;90\n1717243200,1;1;3;90\n";
        let recording = read(&[("c.csv", command), ("p.csv", track)]).expect("a recording").remove(0);
        assert_eq!((recording.commands.kind, recording.commands.samples[1].1), (Kind::Twist, [20.0, 1.0]));
        let frame = recording.poses[1];
        assert!((frame.t_ms - 1_717_243_200_100.0).abs() < 1e-3 && frame.pose.position_cm.y == 3.0, "{frame:?}");
    }

    #[test]
    fn unclear_columns_are_rejected_with_a_remedy() {
        let track = "t_s,x_m,y_m,th_rad\n0,0,0,0\n1,0,0,0\n";
        for (name, text, what) in [
            ("a.csv", "t_s,u,w2\n0,1,1\n1,1,1\n", "contains no command, pose or reading: its columns are t_s, u, w2"),
            ("a.csv", "v_m_s,w_rad_s\n0,1\n1,1\n", ":1: no column for the time"),
            ("a.csv", "t_s,v,w_rad_s\n0,1,1\n1,1,1\n", ":1: column v has no unit"),
            ("a.csv", "t,v_m_s,w_rad_s\n0,1,1\n1,1,1\n", ":1: the unit of t cannot be determined"),
            ("a.csv", "t_s,v_m_s,v2_m_s,linear_x_m_s,w_rad_s\n0,1,1,1,1\n", ":1: more than one column for forward"),
            ("a.csv", "t_s,left_pwm,right_pwm\n0,200,1\n1,1,1\n", "exceed 100: give the value of full command"),
            ("a.csv", "t_s,v_m_s,w_rad_s\n0,1,1\n9,1,1\n1,1,1\n", ":4: the clock goes back from 9.000 s to 1.000 s"),
            ("a.csv", "t_s,x_m,y_m\n0,1,1\n1,1,1\n", ":1: no column for the heading"),
            ("a.csv", "t_s,x_m,y_m,cap\n0,1,1,0\n1,1,1,0\n", "assign one of cap in a --map file, as in heading = "),
            (
                "a.csv",
                track,
                "0 file(s) contain commands and poses, 0 only commands, 2 only poses, 0 only readings, rotation counters or a gyro",
            ),
            ("a.csv", "t_s,x_m,y_m,th_rad,u1,u2\n0,0,0,0,1,1\n1,0,0,0,1,1\n", "; unused columns: u1 of "),
        ] {
            let error = read(&[(name, text), ("p.csv", track)]).expect_err(text).to_string();
            assert!(error.contains(what), "{text:?} gave {error}");
        }
    }

    const COMMANDS: &str = "t_s,v_m_s,w_rad_s\n0,0.1,0\n1,0.2,1\n";
    const POSES: &str = "t_s,x_m,y_m,th_rad\n0,0,0,0\n1,0.1,0,0\n";

    #[test]
    fn a_bad_file_leaves_the_batch_with_its_partner() {
        let found = read_all(&[("c1.csv", "t_s\n"), ("c2.csv", COMMANDS), ("p1.csv", POSES), ("p2.csv", POSES)]);
        let Recordings { recordings, left_out } = found.expect("one drive");
        assert!(recordings.len() == 1 && recordings[0].file.ends_with("p2.csv"), "{recordings:?}");
        let lines: Vec<String> = left_out.iter().map(LeftOut::line).collect();
        assert!(
            lines[0].contains("c1.csv: line 1") && lines[1].contains("p1.csv: the other file of its drive"),
            "{lines:?}"
        );
        let found = read_all(&[("c.csv", COMMANDS), ("p.csv", POSES), ("c.csv", COMMANDS)]).expect("one drive");
        assert_eq!((found.recordings.len(), found.left_out[0].reason.as_str()), (1, "is given twice"));
    }

    #[test]
    fn speeds_of_odometry_are_not_commands() {
        let odometry = "t_s,pose.position.x,pose.position.y,orientation.z,orientation.w,twist.linear.x,twist.angular.z\n\
                        0,0,0,0,1,9,9\n1,0.1,0,0,1,9,9\n";
        let error = read(&[("o.csv", odometry)]).expect_err("no commands").to_string();
        assert!(error.contains("twist.linear.x of ") && error.contains("measured"), "{error}");
        for speeds in [odometry.to_owned(), odometry.replace("twist.linear.x,twist.angular.z", "v_m_s,w_rad_s")] {
            let found = read(&[("c.csv", COMMANDS), ("o.csv", &speeds)]).expect("one drive");
            assert_eq!(found[0].commands.samples, [(0.0, [10.0, 0.0]), (1000.0, [20.0, 1.0])]);
        }
        let plotjuggler = "__time,/cmd_vel/linear/x,/cmd_vel/angular/z,/odom/pose/pose/position/x,/odom/pose/pose/position/y,\
                           /odom/pose/pose/orientation/z,/odom/pose/pose/orientation/w,/odom/twist/twist/linear/x,\
                           /odom/twist/twist/angular/z,/odom/header/stamp,/imu/orientation/x\n\
                           0.5,0.1,0.2,,,,,,,,\n0.51,,,0.3,0,0,1,9,9,17,1\n0.6,0.1,0.2,,,,,,,,\n";
        let found = read(&[("p.csv", plotjuggler)]).expect("one drive").remove(0);
        assert_eq!(found.commands.samples, [(500.0, [10.0, 0.2]), (600.0, [10.0, 0.2])]);
        assert_eq!(found.poses.iter().map(|frame| frame.pose.position_cm.x).collect::<Vec<_>>(), [30.0]);
        let unused: Vec<&str> = found.sources[0].unused.iter().map(|unused| unused.name.as_str()).collect();
        assert!(unused.contains(&"/imu/orientation/x") && unused.contains(&"/odom/twist/twist/linear/x"), "{unused:?}");
    }

    #[test]
    fn speeds_to_the_side_are_reported_with_their_share() {
        let commands = "t_s,linear.x,linear.y,angular.z\n0,0.3,0.1,0\n1,0.3,-0.1,0\n";
        let found = read(&[("c.csv", commands), ("p.csv", POSES)]).expect("one drive");
        let unused = &found[0].sources[0].unused[0];
        assert!(unused.name == "linear.y" && unused.reason.contains("25 % of the commanded travel"), "{unused:?}");
    }

    #[test]
    fn a_restart_within_a_file_gives_two_recordings() {
        let text = "t_s,left,right,x_m,y_m,th_rad\n0,1,1,0,0,0\n1,1,1,0,0,0\n2,1\nt_s,left,right,x_m,y_m,th_rad\n0,1,1,0,0,0\n1,1,1,0,0,0\n";
        let found = read(&[("r.csv", text)]).expect("two drives");
        assert_eq!(found.len(), 2);
        assert!(found[0].sources[0].unused[0].reason.contains("line 5 has the header again"), "{:?}", found[0].sources);
    }

    /// Returns the sensors that were read, and left and right angle and the yaw rate at 2 s.
    fn measured(recording: &Recording) -> (Vec<usize>, [Option<f64>; 3]) {
        let (own, times_ms) = (&recording.own_motion, [2000.0; 2]);
        let own = [own.angle_rad(0, times_ms), own.angle_rad(1, times_ms), own.yaw_rad_s(times_ms)];
        (recording.readings.iter().map(|readings| readings.sensor).collect(), own)
    }

    #[test]
    fn joints_and_imus_are_read_in_every_form_of_export() {
        let plotjuggler = "__time,/js/arm/position,/js/arm/velocity,/js/wheel_left/position,/js/wheel_left/velocity,\
                           /js/wheel_right/position,/js/wheel_right/velocity,/imu/angular_velocity/z,/imu/linear_acceleration/z\n\
                           1,0,0,5,9,5,9,4,9.8\n2,0,0,7,9,8,9,4,9.8\n";
        let bagpy = "Time,header.stamp.secs,header.stamp.nsecs,name_0,name_1,position_0,position_1,velocity_0,velocity_1\n\
                     1.0,1,0,wheel_right,wheel_left,0,0,9,9\n2.0,2,0,wheel_right,wheel_left,3,2,9,9\n";
        let rostopic = "t_s,field.name0,field.name1,field.position0,field.position1\n\
                        1,left_wheel,right_wheel,0,0\n2,left_wheel,right_wheel,2,3\n";
        let echo = "1,0,,left_wheel,right_wheel,-2.0,-3.0,9.0,9.0\n2,0,,left_wheel,right_wheel,0.0,0.0,9.0,9.0\n";
        let imu = format!("base,{}{}0,0,4,{}0,0,9.8{}", "0,0,0,1,", "0,".repeat(9), "0,".repeat(9), ",0".repeat(9));
        let imu = format!("1,0,{imu}\n2,0,{imu}\n");
        let own = "t_s,rot_left_deg,rot_right_rad,gyro_rad_s\n1,0,0,4\n2,114.591559,3,4\n";
        let wheels = [Some(2.0), Some(3.0), None];
        for (text, expected) in [
            (plotjuggler, [Some(2.0), Some(3.0), Some(4.0)]),
            (bagpy, wheels),
            (rostopic, wheels),
            (echo, wheels),
            (&imu, [None, None, Some(4.0)]),
            (own, [Some(2.0), Some(3.0), Some(4.0)]),
        ] {
            let commands = "t_s,v_m_s,w_rad_s\n1,0.1,0\n2,0.2,1\n";
            let found = read(&[("c.csv", commands), ("p.csv", POSES), ("m.csv", text)]).expect(text).remove(0);
            let (_, found) = measured(&found);
            let is_near = |(a, b): (&Option<f64>, &Option<f64>)| match (a, b) {
                (Some(a), Some(b)) => (a - b).abs() < 1e-6,
                (a, b) => a == b,
            };
            assert!(found.iter().zip(&expected).all(is_near), "{text}: {found:?}");
        }
    }

    #[test]
    fn measurements_that_cannot_be_used_are_left_out_with_their_reason() {
        for (columns, cells, name, words) in [
            ("js/a/position,js/b/position", "1,2", "js/a/position", "joint a is not taken for a driven wheel"),
            ("gyro_z", "1", "gyro_z", "has no unit"),
            ("gyro_deg_s,gyro_z_rad_s", "1,1", "gyro_deg_s", "more than one column for gyro"),
            (
                "js/left_wheel/position,js/right_wheel/position,js/arm/position",
                "1,2,3",
                "js/arm/position",
                "joint arm is not",
            ),
        ] {
            let text = format!("t_s,v_m_s,w_rad_s,{columns}\n1,0.1,0,{cells}\n2,0.2,1,{cells}\n")
                .replace("js/", "joint_states/");
            let found = read(&[("c.csv", &text), ("p.csv", POSES)]).expect(&text).remove(0);
            let name = name.replace("js/", "joint_states/");
            let unused = found.sources[0].unused.iter().find(|unused| unused.name == name);
            assert!(
                unused.is_some_and(|unused| unused.reason.contains(words)),
                "{text}: {:?}",
                found.sources[0].unused
            );
        }
    }

    #[test]
    fn readings_are_matched_to_the_sensors_that_columns_and_files_name() {
        let mount = mindgap_logs::Ultrasonic { x_cm: 0.0, y_cm: 0.0, yaw_deg: 0.0, min_cm: 4.0, max_cm: 250.0 };
        let sensors = ["ultrasonic", "left", "right"].map(|name| RangeSensor::new(name.into(), mount)).to_vec();
        let folder = tempfile::tempdir().expect("a folder");
        let read = |texts: &[(&str, &str)], map: &str| {
            let files: Vec<PathBuf> = texts.iter().map(|(name, _)| folder.path().join(name)).collect();
            files.iter().zip(texts).for_each(|(file, (_, text))| files::write(file, text).expect("written"));
            let path = folder.path().join("map.toml");
            files::write(&path, map).expect("written");
            let stated =
                Statements { sensors: sensors.clone(), mapping: Mapping::read(&path)?, ..Statements::default() };
            recordings(&files, &stated, |_, _| ()).map(|mut found| found.recordings.remove(0))
        };
        let of = |columns: &str| format!("t_s,v_m_s,w_rad_s,{columns}\n1,0.1,0,11,22,33\n2,0.1,0,11,22,33\n");
        let first = |recording: &Recording| {
            recording.readings.iter().map(|of| (of.sensor, of.samples[0].1.unwrap_or(0.0))).collect::<Vec<_>>()
        };
        for columns in ["right_range_cm,echo_cm,echo_left_cm", "/sonar_right/range_cm,range_cm,SonarLeft [cm]"] {
            let found = read(&[("c.csv", &of(columns)), ("p.csv", POSES)], "").expect(columns);
            assert_eq!(first(&found), [(0, 22.0), (1, 33.0), (2, 11.0)], "{columns}");
        }
        let [left, right] = [7, 8].map(|cm| format!("t_s,range_cm\n1,{cm}\n2,{cm}\n"));
        let files = [("c.csv", COMMANDS), ("right.csv", right.as_str()), ("p.csv", POSES), ("left.csv", left.as_str())];
        assert_eq!(first(&read(&files, "").expect("a drive")), [(1, 7.0), (2, 8.0)]);
        let map = "[\"c.csv\"]\ntime = \"t_s\"\nforward = \"v_m_s\"\nturn = \"w_rad_s\"\nrange_right = { column = \"a\", unit = \"cm\" }\n";
        let found = read(&[("c.csv", &of("a,b,c")), ("p.csv", POSES)], map).expect("a drive");
        assert_eq!(first(&found), [(2, 11.0)]);
        let error = |columns: &str, map: &str| {
            read(&[("c.csv", &of(columns)), ("p.csv", POSES)], map).expect_err(columns).to_string()
        };
        assert!(
            error("a,b,c", &map.replace("range_right", "range_rear"))
                .contains("robot.toml has no range sensor \"rear\"")
        );
        let twice = error("left_range_cm,range_left_cm,b", "");
        assert!(twice.contains("more than one column for range sensor left: choose one as range_left"), "{twice}");
        let unclear = read(&[("c.csv", &of("a_range_cm,range_cm,sonar_cm")), ("p.csv", POSES)], "").expect("a drive");
        assert!(
            unclear.readings.is_empty()
                && unclear.sources[0].unused.iter().any(|unused| unused.reason.contains("range_NAME"))
        );
    }
}
