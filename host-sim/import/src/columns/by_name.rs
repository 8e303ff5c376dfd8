//! Columns whose names are recognised.

use super::joints;
use super::{Body, Columns, CommandColumns, Rotation, TimeColumns, unit_of};
use crate::column::Column;
use crate::left_out::LeftOut;
use crate::quantities::{Meaning, Quantity, meaning};
use crate::range_sensors::named as named_sensor;
use crate::table::Table;
use crate::units::Units;
use crate::words::{contains, words};
use mindgap_logs::range_sensor::RangeSensor;

/// A column with a recognised quantity.
struct Named<'a> {
    index: usize,
    name: &'a str,
    quantity: Quantity,
    meaning: Meaning,
}

const TWIST: [Quantity; 2] = [Quantity::Forward, Quantity::Turn];
const WHEELS: [Quantity; 2] = [Quantity::Left, Quantity::Right];
const PLACE: [Quantity; 3] = [Quantity::X, Quantity::Y, Quantity::Z];
const ROTATION: [Quantity; 5] = [Quantity::Heading, Quantity::Qx, Quantity::Qy, Quantity::Qz, Quantity::Qw];
/// The column that odometry messages have and commands have not.
const ODOMETRY: &str = "child_frame_id";
/// Why speeds are not taken for commands.
pub const MEASURED: &str = "a speed that the robot measured, as in odometry, and not a command";

/// Finds the columns whose names are recognised.
///
/// # Errors
/// When a required column or unit is missing, or columns are ambiguous.
pub fn columns(table: &Table, units: &Units, sensors: &[RangeSensor]) -> Result<Columns, String> {
    let joints = joints::find(table);
    let names = table.names().iter().enumerate().filter(|(index, _)| !joints.indices.contains(index));
    let recognised = names.filter_map(|(index, name)| {
        let meaning = if is_of_imu(table, name) { of_gyro(name) } else { with_sensor(name, sensors) };
        Some(Named { index, name, quantity: meaning.quantity?, meaning })
    });
    let (mut named, mut left_out): (Vec<Named>, Vec<LeftOut>) = (recognised.collect(), joints.left_out);
    without_measured_speeds(table, &mut named, &mut left_out);
    let quantities: Vec<(Quantity, &str)> = named.iter().map(|n| (n.quantity, n.name)).collect();
    let is_about_motion =
        |(quantity, _): &(Quantity, &str)| !matches!(quantity, Quantity::Time | Quantity::Z | Quantity::Sideways);
    if !quantities.iter().any(is_about_motion) && joints.counters[0].is_empty() {
        return Err(match left_out.first() {
            Some(LeftOut { name, reason, .. }) => format!("contains no command, pose or reading: {name} is {reason}"),
            None => {
                let names = table.names().join(", ");
                format!("contains no command, pose or reading: its columns are {names}; assign them in a --map file")
            }
        });
    }
    complete(table, &quantities)?;
    let mut found = Columns { left_out, ..Columns::default() };
    let mut conventional = Vec::new();
    let mut column = |named: &Named| -> Result<Column, String> {
        let Named { index, name, quantity, meaning } = named;
        let stated = meaning.unit.or(table.unit(*index).filter(|unit| quantity.dimensions().contains(&unit.dimension)));
        let (unit, is_conventional) = unit_of(*quantity, name, stated, units, meaning.is_field)?;
        if is_conventional {
            conventional.push((*name).to_owned());
        }
        Ok(Column { index: *index, name: (*name).into(), unit, sign: 1.0 })
    };
    let pairs = [(TWIST, true), (WHEELS, false)];
    for (pair, is_twist) in pairs {
        if let Some([a, b]) = chosen_pair(&named, pair, &mut found.left_out)? {
            if let Some(other) = &found.commands {
                let names = other.columns.each_ref().map(|column| column.name.as_str()).join(" ");
                let what = format!("both speeds ({names}) and wheels ({} {}) could be the commands", a.name, b.name);
                return Err(what + ": choose in a --map file");
            }
            found.commands = Some(CommandColumns::of(is_twist, [column(a)?, column(b)?])?);
        }
    }
    if found.commands.as_ref().is_some_and(|commands| commands.is_twist)
        && let Some(sideways) = single(&named, Quantity::Sideways)?
    {
        found.sideways = Some(column(sideways)?);
    }
    for (sensor, range) in ranges(table, &named, sensors, &mut found.left_out)? {
        found.ranges.push((sensor, column(range)?));
    }
    // What the robot measures of its own motion is not needed, so a fault in it does not stop the import.
    let optional = |quantity: Quantity| match single(&named, quantity).and_then(|one| one.map(&mut column).transpose())
    {
        Ok(found) => found,
        Err(why) => {
            let of_quantity = named.iter().filter(|n| n.quantity == quantity);
            found.left_out.extend(of_quantity.map(|n| LeftOut::column(n.name, format!("not used: {why}"))));
            None
        }
    };
    let [gyro, left, right] = [Quantity::Gyro, Quantity::CountLeft, Quantity::CountRight].map(optional);
    found.gyro = gyro;
    if let (Some(one), None) | (None, Some(one)) = (&left, &right) {
        found.left_out.push(LeftOut::column(&one.name, "the rotation counter of one wheel alone"));
    }
    found.counters = left.zip(right).map_or(joints.counters, |(left, right)| [vec![left], vec![right]]);
    for topic in topics_of_poses(&named) {
        let of_topic: Vec<&Named> =
            named.iter().filter(|n| topic.as_ref().is_none_or(|t| n.meaning.topic == *t)).collect();
        let mut columns = Vec::new();
        for quantity in PLACE.into_iter().chain(ROTATION) {
            if let Some(one) = single(of_topic.iter().copied(), quantity)? {
                // A height without a unit has that of the position.
                let has_unit = one.meaning.unit.is_some() || one.meaning.is_field || units.length.is_some();
                if quantity != Quantity::Z || has_unit {
                    columns.push((quantity, column(one)?));
                }
            }
        }
        let of = |quantity| columns.iter().find(|(q, _)| *q == quantity).map(|(_, column)| column.clone());
        found.bodies.extend(pose_columns(topic.unwrap_or_default(), of));
    }
    found.times = clocks(&named, &mut column)?;
    if !conventional.is_empty() {
        let what = format!("metres, radians and seconds, as in ROS messages, for {}", conventional.join(", "));
        found.guessed.push(what);
    }
    Ok(found)
}

/// Returns whether a column is the turn rate in a message of an IMU, which has an acceleration too.
fn is_of_imu(table: &Table, name: &str) -> bool {
    let Meaning { quantity, topic, .. } = meaning(name);
    let is_acceleration = |other: &&String| contains(other, "linear acceleration") && meaning(other).topic == topic;
    quantity == Some(Quantity::Turn) && table.names().iter().any(|other| is_acceleration(&other))
}

/// Returns the meaning of the turn rate of an IMU.
fn of_gyro(name: &str) -> Meaning {
    Meaning { quantity: Some(Quantity::Gyro), ..meaning(name) }
}

/// Returns the meaning of a name, which is that of a reading if nothing but the name of a range sensor hides it.
fn with_sensor(name: &str, sensors: &[RangeSensor]) -> Meaning {
    let plain = meaning(name);
    let Some(sensor) = named_sensor(sensors, name).filter(|_| plain.quantity.is_none()) else { return plain };
    let of_sensor = words(&sensors[sensor].name);
    let rest: Vec<String> = words(name).into_iter().filter(|word| !of_sensor.contains(word)).collect();
    let without = meaning(&rest.join("_"));
    if without.quantity == Some(Quantity::Range) { Meaning { topic: plain.topic, ..without } } else { plain }
}

/// Returns the columns of readings with their sensors: those whose names, or else the file's, name a sensor, and the only other one
/// for the first sensor.
fn ranges<'a>(
    table: &Table,
    named: &'a [Named<'a>],
    sensors: &[RangeSensor],
    left_out: &mut Vec<LeftOut>,
) -> Result<Vec<(usize, &'a Named<'a>)>, String> {
    let [_, _, ..] = sensors else {
        return Ok(single(named, Quantity::Range)?.map(|range| (0, range)).into_iter().collect());
    };
    let of_file = table.file.file_stem().and_then(|stem| named_sensor(sensors, &stem.to_string_lossy()));
    let all = || named.iter().filter(|n| n.quantity == Quantity::Range);
    let sensor_of = |range: &Named| named_sensor(sensors, range.name);
    let unnamed = all().filter(|range| sensor_of(range).is_none()).count();
    let mut found: Vec<(usize, &Named)> = Vec::new();
    for range in all() {
        let sensor = sensor_of(range).or_else(|| Some(of_file.unwrap_or(0)).filter(|_| unnamed == 1));
        match sensor {
            Some(sensor) if found.iter().any(|(other, _)| *other == sensor) => {
                let name = &sensors[sensor].name;
                return Err(format!(
                    "more than one column for range sensor {name}: choose one as range_{name} in a --map file"
                ));
            }
            Some(sensor) => found.push((sensor, range)),
            None => left_out.push(LeftOut::column(
                range.name,
                "names no range sensor of robot.toml: assign it in a --map file, as in range_NAME",
            )),
        }
    }
    Ok(found)
}

/// Returns the body with columns for these quantities, if it has a position and a rotation.
pub fn pose_columns(name: String, of: impl Fn(Quantity) -> Option<Column>) -> Option<Body> {
    let position = [Some(of(Quantity::X)?), Some(of(Quantity::Y)?), of(Quantity::Z)];
    let quaternion = [of(Quantity::Qx), of(Quantity::Qy), of(Quantity::Qz), of(Quantity::Qw)];
    let is_quaternion = quaternion[2].is_some() && quaternion[3].is_some();
    let rotation = match of(Quantity::Heading) {
        Some(heading) if !is_quaternion => Rotation::Heading(heading),
        _ if is_quaternion => Rotation::Quaternion(quaternion),
        _ => return None,
    };
    Some(Body { name, position, rotation, residual: None, is_lost_at_origin: false })
}

/// Checks that no quantity lacks the others that it needs.
///
/// # Errors
/// When one is missing.
pub fn complete(table: &Table, found: &[(Quantity, &str)]) -> Result<(), String> {
    let has = |quantity: Quantity| found.iter().any(|(q, _)| *q == quantity);
    let missing = |quantity: Quantity, the: &str, names: &str| {
        let is_found = |name: &&String| found.iter().any(|(_, found)| found == name);
        let others: Vec<&str> = table.names().iter().filter(|name| !is_found(name)).map(String::as_str).collect();
        let which = if others.is_empty() { String::new() } else { format!(" of {}", others.join(", ")) };
        let what = quantity.name();
        let map = format!("or assign one{which} in a --map file, as in {what} = \"its name\"");
        Err(format!("no column for {the}{what}: name it {names}, {map}"))
    };
    if !has(Quantity::Time) {
        return missing(Quantity::Time, "the ", "t_s, time_ms, timestamp or the like");
    }
    for [a, b] in [TWIST, WHEELS, [Quantity::X, Quantity::Y]] {
        if has(a) != has(b) {
            return missing(if has(a) { b } else { a }, "", "as in docs/how-to/bring-your-own-robot.md");
        }
    }
    if has(Quantity::X) && !has(Quantity::Heading) && !(has(Quantity::Qz) && has(Quantity::Qw)) {
        return missing(Quantity::Heading, "the ", "heading_deg, yaw_rad, or qx, qy, qz, qw of a quaternion");
    }
    Ok(())
}

/// Removes speeds that the robot measured: those of odometry, which has a pose and a twist in one message, and those whose names
/// say so.
fn without_measured_speeds(table: &Table, named: &mut Vec<Named>, left_out: &mut Vec<LeftOut>) {
    let is_odometry = table.names().iter().any(|name| name.ends_with(ODOMETRY));
    let pose_topics: Vec<String> =
        named.iter().filter(|n| n.quantity == Quantity::X).map(|n| n.meaning.topic.clone()).collect();
    named.retain(|Named { name, quantity, meaning, .. }| {
        let is_speed =
            [Quantity::Forward, Quantity::Sideways, Quantity::Turn, Quantity::Left, Quantity::Right].contains(quantity);
        let is_beside_pose = meaning.is_twist && pose_topics.contains(&meaning.topic);
        let is_measured = is_speed
            && !meaning.is_commanded
            && (meaning.is_measured || is_beside_pose || is_odometry && !WHEELS.contains(quantity));
        if is_measured {
            left_out.push(LeftOut::column(name, MEASURED));
        }
        !is_measured
    });
}

/// Returns the columns of a pair of commands, which are of one topic, if there are any.
fn chosen_pair<'a>(
    named: &'a [Named<'a>],
    pair: [Quantity; 2],
    left_out: &mut Vec<LeftOut>,
) -> Result<Option<[&'a Named<'a>; 2]>, String> {
    let mut topics: Vec<&str> =
        named.iter().filter(|n| n.quantity == pair[0]).map(|n| n.meaning.topic.as_str()).collect();
    topics.sort_unstable();
    topics.dedup();
    let commanded: Vec<&str> =
        topics.iter().copied().filter(|topic| meaning(topic).is_commanded || topic.contains("cmd")).collect();
    let topic = match (topics.as_slice(), commanded.as_slice()) {
        ([], _) => return Ok(None),
        ([topic], _) | (_, [topic]) => *topic,
        _ => return single(named, pair[0]).map(|_| None),
    };
    for other in named.iter().filter(|n| pair.contains(&n.quantity) && n.meaning.topic != topic) {
        left_out.push(LeftOut::column(other.name, format!("not used: the commands are those of {topic}")));
    }
    let of_topic = || named.iter().filter(|n| n.meaning.topic == topic);
    Ok(single(of_topic(), pair[0])?.zip(single(of_topic(), pair[1])?).map(|(a, b)| [a, b]))
}

/// Returns the only column of a quantity, or the only one that is marked as commanded.
fn single<'a>(
    named: impl IntoIterator<Item = &'a Named<'a>>,
    quantity: Quantity,
) -> Result<Option<&'a Named<'a>>, String> {
    let all: Vec<&Named> = named.into_iter().filter(|n| n.quantity == quantity).collect();
    let commanded: Vec<&Named> = all.iter().copied().filter(|n| n.meaning.is_commanded).collect();
    match (all.as_slice(), commanded.as_slice()) {
        ([], _) => Ok(None),
        ([one], _) | (_, [one]) => Ok(Some(one)),
        _ => {
            let names: Vec<&str> = all.iter().map(|n| n.name).collect();
            let names = names.join(", ");
            Err(format!("more than one column for {}: {names}; choose one in a --map file", quantity.name()))
        }
    }
}

/// Returns the topics that have a whole pose; `None` stands for all columns together.
fn topics_of_poses(named: &[Named]) -> Vec<Option<String>> {
    let has = |topic: &str, quantity| named.iter().any(|n| n.meaning.topic == topic && n.quantity == quantity);
    let mut topics: Vec<&str> =
        named.iter().filter(|n| n.quantity == Quantity::X).map(|n| n.meaning.topic.as_str()).collect();
    topics.dedup();
    topics.retain(|topic| {
        has(topic, Quantity::Y)
            && (has(topic, Quantity::Heading) || has(topic, Quantity::Qz) && has(topic, Quantity::Qw))
    });
    match topics.as_slice() {
        [] => vec![None],
        topics => topics.iter().map(|topic| Some((*topic).to_owned())).collect(),
    }
}

/// Returns every clock that the columns of times may form: seconds and a fraction of a second may belong together.
fn clocks(
    named: &[Named],
    column: &mut impl FnMut(&Named) -> Result<Column, String>,
) -> Result<Vec<TimeColumns>, String> {
    let topics: Vec<&str> =
        named.iter().filter(|n| n.quantity != Quantity::Time).map(|n| n.meaning.topic.as_str()).collect();
    let times: Vec<&Named> = named.iter().filter(|n| n.quantity == Quantity::Time).collect();
    let factor = |n: &Named| n.meaning.unit.map_or(0.0, |unit| unit.factor);
    let is_same = |a: &Named, b: &Named| a.meaning.topic == b.meaning.topic && a.meaning.stem == b.meaning.stem;
    let fraction_of =
        |whole: &Named| times.iter().find(|n| is_same(n, whole) && factor(n) < factor(whole) && factor(n) > 0.0);
    let mut clocks = Vec::new();
    for time in &times {
        let Meaning { is_stamp, topic, .. } = &time.meaning;
        let is_shared = topics.iter().all(|other| other == topic);
        let mut clock = |columns| clocks.push(TimeColumns { columns, is_stamp: *is_stamp, is_shared });
        // Whether the finer column is a fraction shows in its numbers.
        if let Some(fraction) = fraction_of(time) {
            clock(vec![column(time)?, column(fraction)?]);
        }
        clock(vec![column(time)?]);
    }
    Ok(clocks)
}
