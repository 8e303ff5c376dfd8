//! What a column holds, by its name: a quantity and the unit that the name states.

/// What a column can hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// Time.
    Time,
    /// Position to the right.
    X,
    /// Position upwards.
    Y,
    /// Heading, counter-clockwise from +x.
    Heading,
    /// The parts of a quaternion.
    Qx,
    /// Its y.
    Qy,
    /// Its z.
    Qz,
    /// Its real part.
    Qw,
    /// Commanded speed ahead.
    Forward,
    /// Commanded turn rate, to the left.
    Turn,
    /// Command of the left motor, or speed of its wheel.
    Left,
    /// The same of the right one.
    Right,
    /// Reading of the range sensor.
    Range,
}

/// What a number measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// In ms.
    Time,
    /// In cm.
    Length,
    /// In rad.
    Angle,
    /// In cm/s.
    Speed,
    /// In rad/s.
    Rate,
    /// Of a motor, -100 to 100.
    Command,
    /// A part of a quaternion.
    Number,
}

/// A unit: what it measures, and how much one of it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// What it measures.
    pub dimension: Dimension,
    /// One of it, in the unit that [`Dimension`] states.
    pub one: f64,
}

const DEG: f64 = std::f64::consts::PI / 180.0;

/// Units by their names in lower case with `_` for everything between letters and digits.
#[rustfmt::skip]
const UNITS: [(&str, Dimension, f64); 40] = [
    ("s", Dimension::Time, 1e3), ("sec", Dimension::Time, 1e3), ("secs", Dimension::Time, 1e3), ("seconds", Dimension::Time, 1e3),
    ("ms", Dimension::Time, 1.0), ("msec", Dimension::Time, 1.0), ("us", Dimension::Time, 1e-3), ("usec", Dimension::Time, 1e-3),
    ("ns", Dimension::Time, 1e-6), ("nsec", Dimension::Time, 1e-6), ("nanosec", Dimension::Time, 1e-6), ("nsecs", Dimension::Time, 1e-6),
    ("m", Dimension::Length, 100.0), ("meters", Dimension::Length, 100.0), ("metres", Dimension::Length, 100.0),
    ("cm", Dimension::Length, 1.0), ("mm", Dimension::Length, 0.1),
    ("rad", Dimension::Angle, 1.0), ("radians", Dimension::Angle, 1.0), ("deg", Dimension::Angle, DEG), ("degrees", Dimension::Angle, DEG),
    ("m_s", Dimension::Speed, 100.0), ("mps", Dimension::Speed, 100.0), ("m_per_s", Dimension::Speed, 100.0), ("m_s_1", Dimension::Speed, 100.0),
    ("cm_s", Dimension::Speed, 1.0), ("cmps", Dimension::Speed, 1.0), ("cm_per_s", Dimension::Speed, 1.0),
    ("mm_s", Dimension::Speed, 0.1), ("mmps", Dimension::Speed, 0.1), ("mm_per_s", Dimension::Speed, 0.1),
    ("rad_s", Dimension::Rate, 1.0), ("rad_per_s", Dimension::Rate, 1.0), ("radps", Dimension::Rate, 1.0),
    ("deg_s", Dimension::Rate, DEG), ("deg_per_s", Dimension::Rate, DEG), ("degps", Dimension::Rate, DEG),
    ("rpm", Dimension::Rate, 6.0 * DEG),
    ("percent", Dimension::Command, 1.0), ("pct", Dimension::Command, 1.0),
];

/// Words that say nothing about what a column holds.
const NOISE: [&str; 34] = [
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
];
/// Words that say that a column holds what was asked for rather than what was measured.
const COMMANDED: [&str; 7] = ["cmd", "command", "commanded", "set", "target", "desired", "ref"];
const SIDES: [(Quantity, [&str; 4]); 2] =
    [(Quantity::Left, ["left", "l", "vl", "ul"]), (Quantity::Right, ["right", "r", "vr", "ur"])];
const OF_MOTORS: [&str; 11] =
    ["speed", "velocity", "vel", "v", "u", "pwm", "power", "duty", "throttle", "effort", "rate"];
/// Names by quantity, once noise and unit are gone.
const NAMES: [(Quantity, &[&str]); 9] = [
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
        ],
    ),
    (Quantity::X, &["x", "px"]),
    (Quantity::Y, &["y", "py"]),
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

/// What a name says.
#[derive(Clone, Debug, PartialEq)]
pub struct Meaning {
    /// What the column holds, if the name is plain.
    pub quantity: Option<Quantity>,
    /// The unit, if the name states one.
    pub unit: Option<Unit>,
    /// Whether the name says that it was asked for.
    pub is_commanded: bool,
}

impl Quantity {
    /// Its name in a mapping file.
    pub fn name(self) -> &'static str {
        QUANTITIES.iter().find(|(quantity, ..)| *quantity == self).map_or("", |(_, name, _)| name)
    }

    /// The quantity of a name in a mapping file.
    pub fn of_name(name: &str) -> Option<Self> {
        QUANTITIES.iter().find(|(_, n, _)| *n == name).map(|(quantity, ..)| *quantity)
    }

    /// What it measures; the command of a motor may be a speed as well.
    pub fn dimensions(self) -> &'static [Dimension] {
        QUANTITIES.iter().find(|(quantity, ..)| *quantity == self).map_or(&[], |(.., dimensions)| dimensions)
    }
}

const OF_WHEELS: &[Dimension] = &[Dimension::Command, Dimension::Speed, Dimension::Rate];
/// All quantities with their names in a mapping file and what they measure.
pub const QUANTITIES: [(Quantity, &str, &[Dimension]); 13] = [
    (Quantity::Time, "time", &[Dimension::Time]),
    (Quantity::X, "x", &[Dimension::Length]),
    (Quantity::Y, "y", &[Dimension::Length]),
    (Quantity::Heading, "heading", &[Dimension::Angle]),
    (Quantity::Qx, "qx", &[Dimension::Number]),
    (Quantity::Qy, "qy", &[Dimension::Number]),
    (Quantity::Qz, "qz", &[Dimension::Number]),
    (Quantity::Qw, "qw", &[Dimension::Number]),
    (Quantity::Forward, "forward", &[Dimension::Speed]),
    (Quantity::Turn, "turn", &[Dimension::Rate]),
    (Quantity::Left, "left", OF_WHEELS),
    (Quantity::Right, "right", OF_WHEELS),
    (Quantity::Range, "range", &[Dimension::Length]),
];

impl Unit {
    /// A unit by its name, such as `m/s`; a number is what a motor gets at full command, as 1 or 255.
    pub fn of_name(name: &str) -> Option<Self> {
        if let Some(full) = name.trim().parse::<f64>().ok().filter(|full| *full > 0.0 && full.is_finite()) {
            return Some(Unit { dimension: Dimension::Command, one: 100.0 / full });
        }
        let plain = if name.trim() == "%" { "percent".into() } else { words(name).join("_") };
        UNITS
            .iter()
            .find(|(unit, ..)| *unit == plain)
            .map(|(_, dimension, one)| Unit { dimension: *dimension, one: *one })
    }
}

/// What a column's name says.
pub fn meaning(name: &str) -> Meaning {
    let (bare, unit) = without_unit(name);
    let is_commanded = bare.iter().any(|word| COMMANDED.contains(&word.as_str()));
    let told: Vec<&str> = bare.iter().map(String::as_str).filter(|word| !NOISE.contains(word)).collect();
    // `stamp.sec` and the like: what is left may be nothing but the unit.
    let quantity = quantity(&told).filter(|quantity| unit.is_none_or(|u| quantity.dimensions().contains(&u.dimension)));
    Meaning { quantity, unit, is_commanded }
}

fn quantity(words: &[&str]) -> Option<Quantity> {
    let only = |known: &[&str]| !words.is_empty() && words.iter().all(|word| known.contains(word));
    for (quantity, side) in SIDES {
        let of_side = words.iter().filter(|word| side.contains(word)).count();
        if of_side == 1 && words.iter().all(|word| side.contains(word) || OF_MOTORS.contains(word)) {
            return Some(quantity);
        }
    }
    if words.contains(&"linear") {
        return only(&["linear", "x", "vel", "velocity", "speed"]).then_some(Quantity::Forward);
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

/// The words of a name without the unit at its end, and the unit.
fn without_unit(name: &str) -> (Vec<String>, Option<Unit>) {
    if let Some((bare, unit)) = name.trim().trim_end_matches([')', ']']).split_once(['(', '[']) {
        return (words(bare), Unit::of_name(unit));
    }
    let all = words(name);
    let of_last = |n: usize| {
        let (bare, unit) = all.split_at(all.len().checked_sub(n).filter(|left| *left > 0)?);
        let unit =
            Unit::of_name(&unit.join("_")).filter(|unit| unit.dimension != Dimension::Command || unit.one == 1.0)?;
        // A number at the end, as in `range_1`, is no unit.
        Some((bare.to_vec(), Some(unit))).filter(|_| !all[all.len() - 1].starts_with(|c: char| c.is_ascii_digit()))
    };
    of_last(3).or_else(|| of_last(2)).or_else(|| of_last(1)).unwrap_or((all.clone(), None))
}

/// The words of a name in lower case: what stands between other signs than letters and digits, and between a small and
/// a capital letter.
fn words(name: &str) -> Vec<String> {
    let mut parted = String::new();
    let mut before = ' ';
    for c in name.chars() {
        if before.is_lowercase() && c.is_uppercase() {
            parted.push(' ');
        }
        parted.extend(if c.is_alphanumeric() { c.to_lowercase().collect::<Vec<_>>() } else { vec![' '] });
        before = c;
    }
    parted.split_whitespace().map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_names_say_quantity_and_unit() {
        for (name, quantity, one) in [
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
        ] {
            let found = meaning(name);
            assert_eq!((found.quantity, found.unit.map(|unit| unit.one)), (Some(quantity), one), "{name}");
        }
        for name in ["battery", "left_encoder", "linear.y", "angular.x", "range_1", "odom_v", "z_m", "x_s", ""] {
            assert_eq!(meaning(name).quantity, None, "{name}");
        }
        assert!(meaning("cmd_v").is_commanded && !meaning("v").is_commanded);
    }

    #[test]
    fn a_number_is_what_full_command_is_called() {
        assert_eq!(Unit::of_name("255"), Some(Unit { dimension: Dimension::Command, one: 100.0 / 255.0 }));
        assert_eq!(Unit::of_name("m/s"), Some(Unit { dimension: Dimension::Speed, one: 100.0 }));
        assert_eq!([Unit::of_name("0"), Unit::of_name("furlong")], [None, None]);
    }
}
