//! Streams as CSV: commands, poses and readings of one drive, in one file or several.

use std::path::{Path, PathBuf};

use super::columns::Columns;
use super::frame::Frame;
use super::mapping::Mapping;
use super::quantities::Quantity;
use super::recording::{Commands, Kind, Readings, Recording};
use super::report::Source;
use super::table::Table;
use super::timestamps::in_order;
use super::units::Units;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::Pose;

/// The streams that one file holds.
struct FileStreams {
    file: PathBuf,
    commands: Option<Commands>,
    poses: Option<Vec<Option<Frame>>>,
    readings: Option<Vec<(f64, Option<f64>)>>,
    source: Source,
    /// Columns that were taken as nothing.
    left_over: Vec<String>,
}

/// Reads files and joins them into recordings: a file that holds commands and poses is one by itself; of others the first
/// with commands goes with the first with poses and the first with readings, and so on. `watch` is told how
/// many of the files are read.
///
/// # Errors
/// When a file cannot be read or understood, or when there are not as many of one kind as of the other.
pub fn recordings(
    files: &[PathBuf],
    mapping: &Mapping,
    units: &Units,
    watch: impl Fn(usize, usize),
) -> Result<Vec<Recording>> {
    mapping.check(files)?;
    let mut whole = Vec::new();
    let [mut commands, mut poses, mut readings] = [const { Vec::<FileStreams>::new() }; 3];
    for (file, before) in files.iter().zip(0..) {
        watch(before, files.len());
        let streams = FileStreams::read(file, mapping, units)?;
        match (&streams.commands, &streams.poses) {
            (Some(_), Some(_)) => whole.push(streams),
            (Some(_), None) => commands.push(streams),
            (None, Some(_)) => poses.push(streams),
            (None, None) => readings.push(streams),
        }
    }
    // Readings beside one file that holds the rest.
    if whole.len() == 1 && readings.len() == 1 && commands.is_empty() && poses.is_empty() {
        return Ok(vec![joined([whole.pop(), None, readings.pop()])]);
    }
    let is_matched = commands.len() == poses.len() && (readings.is_empty() || readings.len() == commands.len());
    if !is_matched || (whole.is_empty() && commands.is_empty()) {
        let mut files = [&whole, &commands, &poses, &readings].into_iter().flatten();
        let not_understood =
            files.find(|streams| !streams.left_over.is_empty()).map(|FileStreams { file, left_over, .. }| {
                format!(
                    "; of {} nothing was made of {}: say in a --map what they are",
                    file.display(),
                    left_over.join(", ")
                )
            });
        return Err(Error::new(format!(
            "of the files {} hold commands and poses, {} commands, {} poses, {} readings: give one of each a drive, in the same \
             order{}",
            whole.len(),
            commands.len(),
            poses.len(),
            readings.len(),
            not_understood.unwrap_or_default()
        )));
    }
    let mut readings = readings.into_iter();
    let parted =
        commands.into_iter().zip(poses).map(|(commands, poses)| [Some(commands), Some(poses), readings.next()]);
    let whole = whole.into_iter().map(|streams| [Some(streams), None, None]);
    Ok(whole.chain(parted).map(joined).collect())
}

/// One recording of files, of which each holds what those before it do not.
fn joined(files: [Option<FileStreams>; 3]) -> Recording {
    let has_one_clock = files.iter().flatten().count() == 1;
    let mut recording = Recording {
        commands: Commands { kind: Kind::Motors, samples: Vec::new() },
        poses: Vec::new(),
        track: PathBuf::new(),
        readings: None,
        has_one_clock,
        sources: Vec::new(),
    };
    for FileStreams { file, commands, poses, readings, source, .. } in files.into_iter().flatten() {
        // A file of its own with readings alone was written by the robot, as its commands were.
        let on_clock_of_poses = commands.is_none() && poses.is_some();
        if let Some(samples) = readings.filter(|_| recording.readings.is_none()) {
            recording.readings = Some(Readings { samples, on_clock_of_poses });
        }
        recording.commands = commands.unwrap_or(recording.commands);
        if let Some(poses) = poses {
            (recording.poses, recording.track) = (poses, file);
        }
        recording.sources.push(source);
    }
    recording
}

impl FileStreams {
    fn read(file: &Path, mapping: &Mapping, units: &Units) -> Result<Self> {
        let table = Table::read(file)?;
        let columns = Columns::find(&table, mapping.of(file), units)?;
        let (mut stamps, mut commands, mut poses, mut readings) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut lines = Vec::new();
        for line in table.lines() {
            let line = line?;
            stamps.push(columns.stamp(&line)?);
            lines.push(line.number);
            let value = |quantity| columns.value(quantity, &line);
            if let Some((a, b)) = columns.of_commands() {
                commands.push(value(a)?.zip(value(b)?).map(|(a, b)| [a, b]));
            }
            if columns.has_poses() {
                let heading = if columns.has(Quantity::Heading) {
                    value(Quantity::Heading)?
                } else {
                    let part = |quantity| Ok(if columns.has(quantity) { value(quantity)? } else { Some(0.0) });
                    let parts = [part(Quantity::Qx)?, part(Quantity::Qy)?, part(Quantity::Qz)?, part(Quantity::Qw)?];
                    if let [Some(x), Some(y), Some(z), Some(w)] = parts { heading_rad(x, y, z, w) } else { None }
                };
                let pose = (value(Quantity::X)?, value(Quantity::Y)?, heading);
                poses.push(match pose {
                    (Some(x), Some(y), Some(h)) if [x, y, h].iter().all(|v| v.is_finite()) => Some(Pose::new(x, y, h)),
                    _ => None,
                });
            }
            if columns.has(Quantity::Range) {
                readings.push(value(Quantity::Range)?.filter(|cm| cm.is_finite() && *cm > 0.0));
            }
        }
        let (stamps_ms, unit) = columns.ms(&table, &stamps)?;
        let kept = in_order(&stamps_ms).map_err(|(at, what)| Error::at_line(file, lines[at], what))?;
        let disordered = kept.iter().filter(|kept| !**kept).count();
        if stamps_ms.len() < 2 || stamps_ms.len() == disordered + 1 {
            return Err(Error::in_file(
                file,
                format!("has {} row(s) at times of their own", stamps_ms.len() - disordered),
            ));
        }
        let times =
            || stamps_ms.iter().zip(&kept).enumerate().filter(|(_, (_, kept))| **kept).map(|(i, (ms, _))| (i, *ms));
        let of_commands = columns.kind(&table, commands.iter().flatten())?;
        let lost = poses.iter().filter(|pose| pose.is_none()).count();
        let source = Source::of_file(file, &times().map(|(_, ms)| ms).collect::<Vec<_>>())
            .taken(columns.taken())
            .guessed(unit.into_iter().chain(of_commands.guessed().map(str::to_owned)))
            .left_out(disordered, "with a time that does not come after the one before")
            .left_out(lost, "without a pose");
        let commands = (!commands.is_empty()).then(|| Commands {
            kind: of_commands.kind,
            samples: times().filter_map(|(i, ms)| Some((ms, commands[i]?.map(|v| v * of_commands.factor)))).collect(),
        });
        if let Some(commands) = &commands
            && commands.samples.iter().any(|(_, pair)| pair.iter().any(|v| !v.is_finite() || v.abs() > 1e6))
        {
            return Err(Error::in_file(file, "has a command that no robot could follow"));
        }
        let poses =
            (!poses.is_empty()).then(|| times().map(|(i, t_ms)| poses[i].map(|pose| Frame { t_ms, pose })).collect());
        let readings = (!readings.is_empty()).then(|| times().map(|(i, ms)| (ms, readings[i])).collect());
        Ok(FileStreams { file: file.into(), commands, poses, readings, source, left_over: columns.left_over(&table) })
    }
}

/// The heading of a quaternion; `None` of one without length.
pub fn heading_rad(x: f64, y: f64, z: f64, w: f64) -> Option<f64> {
    let length2 = x * x + y * y + z * z + w * w;
    (length2.is_finite() && length2 > 1e-6).then(|| libm::atan2(2.0 * (w * z + x * y), length2 - 2.0 * (y * y + z * z)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_files as files;

    fn read(texts: &[(&str, &str)]) -> Result<Vec<Recording>> {
        let folder = tempfile::tempdir().expect("a folder");
        let files: Vec<PathBuf> = texts.iter().map(|(name, _)| folder.path().join(name)).collect();
        files.iter().zip(texts).for_each(|(file, (_, text))| files::write(file, text).expect("written"));
        recordings(&files, &Mapping::default(), &Units::default(), |_, _| ())
    }

    #[test]
    fn one_file_with_everything_is_a_recording() {
        let text = "t_ms,cmd_left,cmd_right,x_m,y_m,qz,qw,range_mm\n0,1,-1,0.5,0.25,1,0,730\n20,0.5,0.5,,,,,inf\n10,0,0,,,,,\n";
        let recording = read(&[("all.csv", text)]).expect("a recording").remove(0);
        assert_eq!(recording.commands.kind, Kind::Motors);
        assert_eq!(recording.commands.samples, [(0.0, [100.0, -100.0]), (20.0, [50.0, 50.0])]);
        let frame = recording.poses[0].expect("seen");
        assert_eq!((frame.pose.position_cm.x, frame.pose.heading_rad), (50.0, std::f64::consts::PI));
        assert_eq!(recording.poses.len(), 2);
        assert_eq!(recording.readings.expect("readings").samples, [(0.0, Some(73.0)), (20.0, None)]);
        assert!(recording.has_one_clock);
    }

    #[test]
    fn files_go_together_in_their_order() {
        let command = "time,v_m_s,w_rad_s\n2024-06-01T12:00:00Z,0.1,0\n2024-06-01T12:00:01Z,0.2,1\n";
        let track = "t;x_cm;y_cm;yaw_deg\n1717243200,0;1;2;90\n1717243200,1;1;3;90\n";
        let recording = read(&[("c.csv", command), ("p.csv", track)]).expect("a recording").remove(0);
        assert_eq!((recording.commands.kind, recording.commands.samples[1].1), (Kind::Twist, [20.0, 1.0]));
        let frame = recording.poses[1].expect("seen");
        assert!((frame.t_ms - 1_717_243_200_100.0).abs() < 1e-3 && frame.pose.position_cm.y == 3.0, "{frame:?}");
    }

    #[test]
    fn what_is_not_plain_is_refused_with_what_to_write() {
        let track = "t_s,x_m,y_m,th_rad\n0,0,0,0\n1,0,0,0\n";
        for (name, text, what) in [
            ("a.csv", "t_s,u,w2\n0,1,1\n1,1,1\n", "holds no command, pose or reading: its columns are t_s, u, w2"),
            ("a.csv", "v_m_s,w_rad_s\n0,1\n1,1\n", ":1: no column for the time"),
            ("a.csv", "t_s,v,w_rad_s\n0,1,1\n1,1,1\n", ":1: column v has no unit"),
            ("a.csv", "t,v_m_s,w_rad_s\n0,1,1\n1,1,1\n", ":1: the unit of t cannot be told"),
            ("a.csv", "t_s,v_m_s,v2_m_s,linear_x_m_s,w_rad_s\n0,1,1,1,1\n", ":1: more than one column for forward"),
            ("a.csv", "t_s,left_pwm,right_pwm\n0,200,1\n1,1,1\n", "exceed 100: say what motors get at full command"),
            ("a.csv", "t_s,v_m_s,w_rad_s\n0,1,1\n9,1,1\n1,1,1\n", ":4: the clock goes back from 9.000 s to 1.000 s"),
            ("a.csv", "t_s,x_m,y_m\n0,1,1\n1,1,1\n", ":1: no column for the heading"),
            ("a.csv", "t_s,x_m,y_m,cap\n0,1,1,0\n1,1,1,0\n", "which one of cap it is, as heading = "),
            ("a.csv", track, "of the files 0 hold commands and poses, 0 commands, 2 poses, 0 readings"),
            (
                "a.csv",
                "t_s,x_m,y_m,th_rad,u1,u2\n0,0,0,0,1,1\n1,0,0,0,1,1\n",
                "a.csv nothing was made of u1, u2: say in a",
            ),
        ] {
            let error = read(&[(name, text), ("p.csv", track)]).expect_err(text).to_string();
            assert!(error.contains(what), "{text:?} gave {error}");
        }
    }

    #[test]
    fn a_quaternion_that_is_tilted_keeps_its_heading() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        assert!((heading_rad(0.0, 0.0, half, half).expect("one") - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert_eq!(heading_rad(0.0, 0.0, 0.0, 0.0), None);
    }
}
