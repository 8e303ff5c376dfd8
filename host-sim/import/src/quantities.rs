//! Recognises the quantity and unit of a column by its name.

use super::words::words;

/// A quantity that a column can hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// Time.
    Time,
    /// Position to the right.
    X,
    /// Position upwards on the map.
    Y,
    /// Height above the floor.
    Z,
    /// Heading, counter-clockwise from +x.
    Heading,
    /// X component of a quaternion.
    Qx,
    /// Y component of a quaternion.
    Qy,
    /// Z component of a quaternion.
    Qz,
    /// Real component of a quaternion.
    Qw,
    /// Commanded forward speed.
    Forward,
    /// Commanded speed to the left, which a differential drive cannot follow.
    Sideways,
    /// Commanded turn rate, to the left.
    Turn,
    /// Command of the left motor, or speed of its wheel.
    Left,
    /// Command of the right motor, or speed of its wheel.
    Right,
    /// Reading of a range sensor.
    Range,
    /// Rotation counter of the left wheel.
    CountLeft,
    /// Rotation counter of the right wheel.
    CountRight,
    /// Yaw rate measured on the robot.
    Gyro,
}

/// The dimension of a number, with its internal unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// Time, ms.
    Time,
    /// Length, cm.
    Length,
    /// Angle, rad.
    Angle,
    /// Speed, cm/s.
    Speed,
    /// Angular rate, rad/s.
    Rate,
    /// Motor command, -100 to 100.
    Command,
    /// Dimensionless component of a quaternion.
    Number,
}

/// A unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Dimension of the unit.
    pub dimension: Dimension,
    /// Size of the unit in the internal unit of its [`Dimension`].
    pub factor: f64,
}

const DEG: f64 = std::f64::consts::PI / 180.0;

/// Units by lower-case name, with `_` for everything other than letters and digits.
#[rustfmt::skip]
const UNITS: [(&[&str], Dimension, f64); 17] = [
    (&["s", "sec", "secs", "second", "seconds"], Dimension::Time, 1e3),
    (&["ms", "msec", "msecs", "millis", "millisecond", "milliseconds"], Dimension::Time, 1.0),
    (&["us", "usec", "usecs", "micros", "microsecond", "microseconds"], Dimension::Time, 1e-3),
    (&["ns", "nsec", "nsecs", "nanosec", "nanosecs", "nanos", "nanosecond", "nanoseconds"], Dimension::Time, 1e-6),
    (&["m", "meter", "metre", "meters", "metres"], Dimension::Length, 100.0),
    (&["cm", "centimeter", "centimetre", "centimeters", "centimetres"], Dimension::Length, 1.0),
    (&["mm", "millimeter", "millimetre", "millimeters", "millimetres"], Dimension::Length, 0.1),
    (&["inch", "inches"], Dimension::Length, 2.54),
    (&["rad", "radian", "radians"], Dimension::Angle, 1.0),
    (&["deg", "degree", "degrees"], Dimension::Angle, DEG),
    (&["m_s", "mps", "m_per_s", "m_s_1", "m_sec", "meters_per_second", "metres_per_second"], Dimension::Speed, 100.0),
    (&["cm_s", "cmps", "cm_per_s", "cm_s_1", "cm_sec"], Dimension::Speed, 1.0),
    (&["mm_s", "mmps", "mm_per_s", "mm_s_1", "mm_sec"], Dimension::Speed, 0.1),
    (&["rad_s", "rad_per_s", "radps", "rad_s_1", "rad_sec", "radians_per_second"], Dimension::Rate, 1.0),
    (&["deg_s", "deg_per_s", "degps", "dps", "deg_s_1", "deg_sec", "degrees_per_second"], Dimension::Rate, DEG),
    (&["rpm"], Dimension::Rate, 6.0 * DEG),
    (&["percent", "pct"], Dimension::Command, 1.0),
];

/// Words in column names that do not identify the quantity.
const NOISE: [&str; 35] = [
    "pose",
    "position",
    "pos",
    "translation",
    "transform",
    "robot",
    "base",
    "header",
    "msg",
    "data",
    "field",
    "tracked",
    "true",
    "ground",
    "truth",
    "gt",
    "mocap",
    "cmd",
    "command",
    "commanded",
    "twist",
    "set",
    "target",
    "desired",
    "ref",
    "motor",
    "wheel",
    "value",
    "reading",
    "sensor",
    "point",
    "in",
    "tracker",
    "camera",
    "rosbag",
];
/// Words that mark a column as commanded rather than measured.
const COMMANDED: [&str; 7] = ["cmd", "command", "commanded", "set", "target", "desired", "ref"];
/// Words that mark a column as measured by the robot itself.
const MEASURED: [&str; 13] = [
    "odom",
    "odometry",
    "measured",
    "meas",
    "actual",
    "estimated",
    "est",
    "imu",
    "gyro",
    "feedback",
    "encoder",
    "filtered",
    "state",
];
/// Words of fields in ROS messages.
const FIELDS: [&str; 25] = [
    "x",
    "y",
    "z",
    "w",
    "pose",
    "position",
    "orientation",
    "translation",
    "rotation",
    "transform",
    "twist",
    "linear",
    "angular",
    "velocity",
    "acceleration",
    "header",
    "stamp",
    "sec",
    "secs",
    "nsec",
    "nsecs",
    "nanosec",
    "range",
    "yaw",
    "theta",
];
const SIDES: [(Quantity, [&str; 4]); 2] =
    [(Quantity::Left, ["left", "l", "vl", "ul"]), (Quantity::Right, ["right", "r", "vr", "ur"])];
const MOTOR_WORDS: [&str; 11] =
    ["speed", "velocity", "vel", "v", "u", "pwm", "power", "duty", "throttle", "effort", "rate"];
const COUNTER_WORDS: [&str; 2] = ["rot", "rotation"];
/// Words of a gyro's column besides `gyro`.
const GYRO_WORDS: [&str; 8] = ["gyro", "z", "yaw", "rate", "angular", "velocity", "vel", "imu"];
/// Names by quantity, after removing noise words and the unit.
const NAMES: [(Quantity, &[&str]); 10] = [
    (
        Quantity::Time,
        &[
            "t",
            "time",
            "timestamp",
            "stamp",
            "time_stamp",
            "date",
            "datetime",
            "date_time",
            "utc",
            "unix",
            "unix_time",
            "epoch",
            "elapsed",
            "time_of_day",
            "clock",
        ],
    ),
    (Quantity::X, &["x", "px", "tx"]),
    (Quantity::Y, &["y", "py", "ty"]),
    (Quantity::Z, &["z", "pz", "tz"]),
    (Quantity::Heading, &["heading", "yaw", "theta", "th", "psi", "orientation"]),
    (Quantity::Qx, &["qx", "q_x", "quat_x", "quaternion_x", "orientation_x", "rotation_x"]),
    (Quantity::Qy, &["qy", "q_y", "quat_y", "quaternion_y", "orientation_y", "rotation_y"]),
    (Quantity::Qz, &["qz", "q_z", "quat_z", "quaternion_z", "orientation_z", "rotation_z"]),
    (Quantity::Qw, &["qw", "q_w", "quat_w", "quaternion_w", "orientation_w", "rotation_w"]),
    (
        Quantity::Turn,
        &["w", "wz", "omega", "omega_z", "yaw_rate", "yawrate", "turn", "turn_rate", "ang", "ang_vel", "ang_z"],
    ),
];
const FORWARD: [&str; 10] =
    ["v", "vx", "v_x", "speed", "velocity", "vel", "forward", "forward_speed", "lin", "lin_vel"];
const RANGE: [&str; 8] = ["range", "distance", "dist", "echo", "sonar", "ultrasonic", "ultrasound", "front"];

/// What the name of a column means.
#[derive(Clone, Debug, PartialEq)]
pub struct Meaning {
    /// The quantity, if the name is recognised.
    pub quantity: Option<Quantity>,
    /// The unit, if the name states one.
    pub unit: Option<Unit>,
    /// Whether the name marks the column as commanded.
    pub is_commanded: bool,
    /// Whether the name marks the column as measured by the robot itself.
    pub is_measured: bool,
    /// Whether it is part of a twist, which is a command alone and a measurement next to a pose of the same message.
    pub is_twist: bool,
    /// Whether it is a stamp in a message, as opposed to the time at which the message was received.
    pub is_stamp: bool,
    /// Its words without those of the unit.
    pub stem: String,
    /// Whether it is the field of a ROS message, whose unit is in metres, radians and seconds.
    pub is_field: bool,
    /// The topic or message before the fields, as in `/odom` for `/odom/pose/pose/position/x`; empty if there is none.
    pub topic: String,
}

impl Quantity {
    /// Returns its name in a mapping file.
    pub fn name(self) -> &'static str {
        QUANTITIES.iter().find(|(quantity, ..)| *quantity == self).map_or("", |(_, name, _)| name)
    }

    /// Returns the quantity with a name in a mapping file.
    pub fn from_name(name: &str) -> Option<Self> {
        QUANTITIES.iter().find(|(_, n, _)| *n == name).map(|(quantity, ..)| *quantity)
    }

    /// Returns the possible dimensions; the command of a motor may also be a speed.
    pub fn dimensions(self) -> &'static [Dimension] {
        QUANTITIES.iter().find(|(quantity, ..)| *quantity == self).map_or(&[], |(.., dimensions)| dimensions)
    }
}

const WHEEL_DIMENSIONS: &[Dimension] = &[Dimension::Command, Dimension::Speed, Dimension::Rate];
/// All quantities with their names in a mapping file and their dimensions.
pub const QUANTITIES: [(Quantity, &str, &[Dimension]); 18] = [
    (Quantity::Time, "time", &[Dimension::Time]),
    (Quantity::X, "x", &[Dimension::Length]),
    (Quantity::Y, "y", &[Dimension::Length]),
    (Quantity::Z, "z", &[Dimension::Length]),
    (Quantity::Heading, "heading", &[Dimension::Angle]),
    (Quantity::Qx, "qx", &[Dimension::Number]),
    (Quantity::Qy, "qy", &[Dimension::Number]),
    (Quantity::Qz, "qz", &[Dimension::Number]),
    (Quantity::Qw, "qw", &[Dimension::Number]),
    (Quantity::Forward, "forward", &[Dimension::Speed]),
    (Quantity::Sideways, "sideways", &[Dimension::Speed]),
    (Quantity::Turn, "turn", &[Dimension::Rate]),
    (Quantity::Left, "left", WHEEL_DIMENSIONS),
    (Quantity::Right, "right", WHEEL_DIMENSIONS),
    (Quantity::Range, "range", &[Dimension::Length, Dimension::Time]),
    (Quantity::CountLeft, "rot_left", &[Dimension::Angle]),
    (Quantity::CountRight, "rot_right", &[Dimension::Angle]),
    (Quantity::Gyro, "gyro", &[Dimension::Rate]),
];

impl Unit {
    /// Returns a unit by name, such as `m/s`; a number is the value of full command, such as 1 or 255.
    pub fn from_name(name: &str) -> Option<Self> {
        if let Some(full) = name.trim().parse::<f64>().ok().filter(|full| *full > 0.0 && full.is_finite()) {
            return Some(Unit { dimension: Dimension::Command, factor: 100.0 / full });
        }
        let spelled = name.trim().replace('°', "deg").replace(['µ', 'μ'], "u").replace('%', "percent");
        let normalised = words(&spelled).join("_");
        UNITS
            .iter()
            .find(|(names, ..)| names.contains(&normalised.as_str()))
            .map(|(_, dimension, factor)| Unit { dimension: *dimension, factor: *factor })
    }
}

/// Interprets the name of a column.
pub fn meaning(name: &str) -> Meaning {
    let all = words(name);
    let has = |marks: &[&str]| all.iter().any(|word| marks.contains(&word.as_str()));
    let parts = path_parts(name);
    // Where no field follows, the name is not a path.
    let topic_parts =
        parts.iter().rposition(|part| !is_field_part(part)).map_or(0, |last| last + 1) % parts.len().max(1);
    let direct = quantity_and_unit(name);
    // A topic's name before the fields is not part of the quantity's name.
    let (quantity, unit) = match direct {
        (None, _) if topic_parts > 0 => quantity_and_unit(&parts[topic_parts..].join("/")),
        direct => direct,
    };
    let is_unit_alone = Unit::from_name(name).is_some();
    Meaning {
        quantity,
        unit,
        is_commanded: has(&COMMANDED),
        is_measured: has(&MEASURED) && !has(&COMMANDED),
        is_twist: has(&["twist"]),
        is_stamp: has(&["stamp"]),
        stem: if is_unit_alone { String::new() } else { split_unit(name).0.join("_") },
        is_field: parts.len() > 1 && parts.last().is_some_and(|part| is_field_part(part)) && !name.contains(['(', '[']),
        topic: parts[..topic_parts].join("/"),
    }
}

/// Returns the parts of a path of topic and fields. What stands in brackets is a unit, whose slash divides nothing.
fn path_parts(name: &str) -> Vec<&str> {
    let path = name.find(['[', '(']).map_or(name, |unit| &name[..unit]);
    path.split(['/', '.']).map(str::trim).filter(|part| !part.is_empty()).collect()
}

fn quantity_and_unit(name: &str) -> (Option<Quantity>, Option<Unit>) {
    let (bare, unit) = split_unit(name);
    let informative: Vec<&str> = bare.iter().map(String::as_str).filter(|word| !NOISE.contains(word)).collect();
    // In names like `stamp.sec`, the unit constrains the quantity.
    let fits = |quantity: &Quantity| unit.is_none_or(|u| quantity.dimensions().contains(&u.dimension));
    match quantity(&informative).filter(fits) {
        // A name that is nothing but a unit of time.
        None if unit.is_none() => match Unit::from_name(name) {
            Some(unit) if unit.dimension == Dimension::Time => (Some(Quantity::Time), Some(unit)),
            _ => (None, None),
        },
        found => (found, unit),
    }
}

/// Returns whether a part of a path is a field of a message rather than the name of a topic.
fn is_field_part(part: &str) -> bool {
    let words = words(part);
    words.iter().all(|word| FIELDS.contains(&word.as_str())) || Unit::from_name(part).is_some()
}

fn quantity(words: &[&str]) -> Option<Quantity> {
    let only = |known: &[&str]| !words.is_empty() && words.iter().all(|word| known.contains(word));
    for (quantity, side) in SIDES {
        let side_words = words.iter().filter(|word| side.contains(word)).count();
        let others = |known: &[&str]| words.iter().all(|word| side.contains(word) || known.contains(word));
        if side_words == 1 && others(&MOTOR_WORDS) {
            return Some(quantity);
        }
        if side_words == 1 && others(&COUNTER_WORDS) {
            return Some(if quantity == Quantity::Left { Quantity::CountLeft } else { Quantity::CountRight });
        }
    }
    if words.contains(&"gyro") {
        return only(&GYRO_WORDS).then_some(Quantity::Gyro);
    }
    if words.contains(&"linear") {
        let along = |axis| only(&["linear", axis, "vel", "velocity", "speed"]);
        return if along("x") { Some(Quantity::Forward) } else { along("y").then_some(Quantity::Sideways) };
    }
    if words.contains(&"angular") {
        return only(&["angular", "z", "vel", "velocity", "speed"]).then_some(Quantity::Turn);
    }
    let joined = words.join("_");
    if FORWARD.contains(&joined.as_str()) {
        return Some(Quantity::Forward);
    }
    if only(&RANGE) {
        return Some(Quantity::Range);
    }
    NAMES.iter().find(|(_, names)| names.contains(&joined.as_str())).map(|(quantity, _)| *quantity)
}

/// Splits a name into its words and the unit at its end.
fn split_unit(name: &str) -> (Vec<String>, Option<Unit>) {
    if let Some((bare, unit)) = name.trim().trim_end_matches([')', ']']).split_once(['(', '[']) {
        return (words(bare), Unit::from_name(unit));
    }
    let all = words(name);
    let last_words_as_unit = |n: usize| {
        let (bare, unit) = all.split_at(all.len().checked_sub(n).filter(|rest| *rest > 0)?);
        let unit = Unit::from_name(&unit.join("_"))
            .filter(|unit| unit.dimension != Dimension::Command || unit.factor == 1.0)?;
        // A number at the end, as in `range_1`, is not a unit.
        Some((bare.to_vec(), Some(unit))).filter(|_| !all[all.len() - 1].starts_with(|c: char| c.is_ascii_digit()))
    };
    last_words_as_unit(3)
        .or_else(|| last_words_as_unit(2))
        .or_else(|| last_words_as_unit(1))
        .unwrap_or((all.clone(), None))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_names_are_recognised() {
        for (name, quantity, factor) in [
            ("t_s", Quantity::Time, Some(1e3)),
            ("header.stamp.nanosec", Quantity::Time, Some(1e-6)),
            ("Timestamp", Quantity::Time, None),
            ("x_m", Quantity::X, Some(100.0)),
            ("pose.position.x", Quantity::X, None),
            ("Y [mm]", Quantity::Y, Some(0.1)),
            ("th_rad", Quantity::Heading, Some(1.0)),
            ("orientation.w", Quantity::Qw, None),
            ("v_m_s", Quantity::Forward, Some(100.0)),
            ("cmd_vel.linear.x", Quantity::Forward, None),
            ("w_rad_s", Quantity::Turn, Some(1.0)),
            ("angular.z (deg/s)", Quantity::Turn, Some(DEG)),
            ("LeftSpeed_cm_s", Quantity::Left, Some(1.0)),
            ("pwm_r", Quantity::Right, None),
            ("vr_m_s", Quantity::Right, Some(100.0)),
            ("sonar_front_cm", Quantity::Range, Some(1.0)),
            ("echo_us", Quantity::Range, Some(1e-3)),
            ("Motor, left", Quantity::Left, None),
            ("heading [°]", Quantity::Heading, Some(DEG)),
            ("omega (°/s)", Quantity::Turn, Some(DEG)),
            ("x / mm", Quantity::X, Some(0.1)),
            ("__time", Quantity::Time, None),
            ("millis", Quantity::Time, Some(1.0)),
            ("header.stamp.nsecs", Quantity::Time, Some(1e-6)),
            ("field.header.stamp", Quantity::Time, None),
            ("/robot_7/cmd_vel/linear/x", Quantity::Forward, None),
            ("/odom/pose/pose/position/x", Quantity::X, None),
            ("TX", Quantity::X, None),
            ("z_m", Quantity::Z, Some(100.0)),
            ("rot_left_deg", Quantity::CountLeft, Some(DEG)),
            ("wheel rotation R [rad]", Quantity::CountRight, Some(1.0)),
            ("gyro_z_deg_s", Quantity::Gyro, Some(DEG)),
        ] {
            let found = meaning(name);
            assert_eq!((found.quantity, found.unit.map(|unit| unit.factor)), (Some(quantity), factor), "{name}");
        }
        for name in
            ["battery", "left_encoder", "linear.z", "angular.x", "range_1", "odom_v", "x_s", "frame", "gyro_x", ""]
        {
            assert_eq!(meaning(name).quantity, None, "{name}");
        }
        assert!(meaning("cmd_v").is_commanded && !meaning("v").is_commanded);
        let odometry = meaning("/odom/twist/twist/linear/x");
        assert!(
            odometry.is_twist && odometry.is_measured && odometry.is_field && odometry.topic == "odom",
            "{odometry:?}"
        );
        assert_eq!(
            ["pose.position.x", "field.pose.position.x", "x [m]"].map(|name| meaning(name).topic),
            ["", "field", ""]
        );
    }

    #[test]
    fn number_as_unit_is_the_value_of_full_command() {
        assert_eq!(Unit::from_name("255"), Some(Unit { dimension: Dimension::Command, factor: 100.0 / 255.0 }));
        assert_eq!(Unit::from_name("m/s"), Some(Unit { dimension: Dimension::Speed, factor: 100.0 }));
        assert_eq!([Unit::from_name("0"), Unit::from_name("furlong")], [None, None]);
    }
}
