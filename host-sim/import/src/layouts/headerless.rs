//! Rows without a header that are recognised by their number of cells: TUM trajectories, and `ros2 topic echo --csv`.

use super::{Layout, cm, ms, plain};
use crate::body::{Body, Rotation};
use crate::column::Column;
use crate::columns::{Columns, CommandColumns, TimeColumns};
use crate::joints::wheels;
use crate::left_out::LeftOut;
use crate::quantities::{Dimension, Unit};
use crate::table::{Header, cells, lines};
use std::result::Result;

/// First characters of comments.
const COMMENT: char = '#';
/// Largest deviation of a quaternion's length from one.
const UNIT_TOLERANCE: f64 = 0.02;

/// What a row without a header holds.
struct Rows {
    /// Number of cells.
    cells: usize,
    /// Indices of the cells that are text.
    text: &'static [usize],
    /// Index of x; y, z and the quaternion follow.
    pose: Option<usize>,
    /// Indices of forward speed and turn rate.
    twist: Option<[usize; 2]>,
    /// Index of the yaw rate that an IMU measures.
    gyro: Option<usize>,
    what: &'static str,
}

/// Rows of `ros2 topic echo --csv`: seconds, nanoseconds and frame, then the message.
const ROS: [Rows; 5] = [
    Rows {
        cells: 10,
        text: &[2],
        pose: Some(3),
        twist: None,
        gyro: None,
        what: "PoseStamped of ros2 topic echo --csv",
    },
    Rows {
        cells: 46,
        text: &[2],
        pose: Some(3),
        twist: None,
        gyro: None,
        what: "PoseWithCovarianceStamped of ros2 topic echo --csv",
    },
    Rows {
        cells: 89,
        text: &[2, 3],
        pose: Some(4),
        twist: None,
        gyro: None,
        what: "Odometry of ros2 topic echo --csv",
    },
    Rows {
        cells: 9,
        text: &[2],
        pose: None,
        twist: Some([3, 8]),
        gyro: None,
        what: "TwistStamped of ros2 topic echo --csv",
    },
    Rows { cells: 40, text: &[2], pose: None, twist: None, gyro: Some(18), what: "Imu of ros2 topic echo --csv" },
];

/// Recognises such rows.
pub fn layout(text: &str) -> Option<Result<Layout, (u64, String)>> {
    let lines = lines(text);
    // A comment right above the rows may be their header, unless it is that of a TUM trajectory.
    let first = lines.iter().position(|line| !line.text.starts_with(COMMENT))?;
    let separator = if lines[first].text.contains(',') { b',' } else { b' ' };
    let row = cells(lines[first].text, separator);
    let header = |count: usize| {
        let names = (1..=count).map(|cell| format!("cell {cell}")).collect();
        Header::given(names, separator, lines[first].start..text.len(), lines[first].number - 1)
    };
    if is_tum(&row) {
        let pose = body(1, cm(100.0));
        let times =
            vec![TimeColumns { columns: vec![Column::of(0, "cell 1", ms(1000.0))], is_stamp: false, is_shared: true }];
        let guessed = vec!["a TUM trajectory: time in s, x y z in m, qx qy qz qw".to_owned()];
        return Some(Ok((header(8), Columns { times, bodies: vec![pose], guessed, ..Columns::default() })));
    }
    let is_number = |cell: &String| cell.parse::<f64>().is_ok();
    if separator == b',' && row.len() == 6 && row.iter().all(is_number) {
        let what = "has six numbers and no time, as `ros2 topic echo --csv` writes a Twist: record a bag with `ros2 bag record`";
        return Some(Err((lines[first].number, what.into())));
    }
    let fits = |rows: &&Rows| {
        let is_text = |index: usize| rows.text.contains(&index);
        rows.cells == row.len() && row.iter().enumerate().all(|(index, cell)| is_text(index) != is_number(cell))
    };
    let stamp = vec![Column::of(0, "sec", ms(1000.0)), Column::of(1, "nanosec", ms(1e-6))];
    let times = vec![TimeColumns { columns: stamp, is_stamp: true, is_shared: true }];
    if let Some(columns) = joints(&row, times.clone()).filter(|_| separator == b',') {
        return Some(Ok((header(row.len()), columns)));
    }
    let rows = ROS.iter().find(fits).filter(|_| separator == b',')?;
    let rate = Some(Unit { dimension: Dimension::Rate, factor: 1.0 });
    let gyro = rows.gyro.map(|index| Column::of(index, "angular_velocity.z", rate));
    let commands = rows.twist.map(|[forward, turn]| {
        let unit = |dimension, factor| Some(Unit { dimension, factor });
        let speed = Column::of(forward, "linear.x", unit(Dimension::Speed, 100.0));
        CommandColumns { is_twist: true, columns: [speed, Column::of(turn, "angular.z", unit(Dimension::Rate, 1.0))] }
    });
    let bodies = rows.pose.map(|at| body(at, cm(100.0))).into_iter().collect();
    let guessed = vec![format!("rows without a header: {}", rows.what)];
    Some(Ok((header(rows.cells), Columns { times, commands, bodies, gyro, guessed, ..Columns::default() })))
}

/// Returns the columns of a JointState: after the frame come names, then as many positions, speeds and efforts, each if it has any.
fn joints(row: &[String], times: Vec<TimeColumns>) -> Option<Columns> {
    const FIRST: usize = 3;
    let is_number = |cell: &String| cell.parse::<f64>().is_ok();
    let after = row.get(FIRST..)?;
    let names = &after[..after.iter().position(is_number)?];
    let numbers = &after[names.len()..];
    let is_like = !names.is_empty() && numbers.len() % names.len() == 0 && numbers.len() <= 3 * names.len();
    if !is_like || !row[..2].iter().all(is_number) || !numbers.iter().all(is_number) {
        return None;
    }
    let found = wheels(names.iter().map(String::as_str)).unwrap_or_default();
    let angle = Some(Unit { dimension: Dimension::Angle, factor: 1.0 });
    let place = |name: &String| names.iter().position(|other| other == name);
    let column = |name: &String| Some(Column::of(FIRST + names.len() + place(name)?, name.as_str(), angle));
    let others = names.iter().filter(|name| !found.iter().any(|side| side.contains(*name)));
    let left_out = others.map(|name| LeftOut::column(name, "not taken for a driven wheel by its name")).collect();
    let counters = found.each_ref().map(|side| side.iter().filter_map(column).collect());
    let guessed = vec!["rows without a header: JointState of ros2 topic echo --csv".to_owned()];
    Some(Columns { times, counters, guessed, left_out, ..Columns::default() })
}

/// Returns whether a row is time, position and a quaternion of length one.
fn is_tum(row: &[String]) -> bool {
    let numbers: Vec<f64> = row.iter().filter_map(|cell| cell.parse().ok()).collect();
    let [_, _, _, _, quaternion @ ..] = numbers.as_slice() else { return false };
    let length2: f64 = quaternion.iter().map(|part| part * part).sum();
    row.len() == 8 && quaternion.len() == 4 && (length2 - 1.0).abs() < 2.0 * UNIT_TOLERANCE
}

/// Returns the body whose x is in this column.
fn body(at: usize, length: Option<Unit>) -> Body {
    let place = |i: usize| Some(Column::of(at + i, ["x", "y", "z"][i], length));
    let part = |i: usize| plain(at + 3 + i, ["qx", "qy", "qz", "qw"][i]);
    let rotation = Rotation::Quaternion([part(0), part(1), part(2), part(3)]);
    Body {
        name: String::new(),
        position: [place(0), place(1), place(2)],
        rotation,
        residual: None,
        is_lost_at_origin: false,
    }
}
