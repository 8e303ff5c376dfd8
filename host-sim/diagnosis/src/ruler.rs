//! What a ruler, a scale or a stopwatch would show of an effect.

use serde_json::{Map, Value};

use mindgap_foundations::statistics::rounding::three_digits;
use mindgap_logs::Robot;

/// Decimals beyond these say nothing about a robot.
const MOST_DECIMALS: i32 = 6;
/// The half width of an interval has at least this many units of the last decimal.
const FINEST: f64 = 2.5;

/// Returns what a ruler, a scale or a stopwatch would show of an effect, where one would.
pub fn by_ruler(
    id: &str,
    parameters: &Map<String, Value>,
    intervals: &Map<String, Value>,
    robot: &Robot,
) -> Option<String> {
    let shown = |name: &str, convert: &dyn Fn(f64) -> f64| {
        let number = convert(parameters.get(name)?.as_f64()?);
        let ends = ends_of(intervals, name).map(|ends| ends.map(convert));
        Some(ends.map_or_else(|| [three_digits(number).to_string(), String::new()], |ends| written(number, ends)))
    };
    match id {
        "motor_asymmetry" => {
            let side = parameters.get("side")?.as_str()?;
            let [percent, ends] = shown("factor", &|factor| 100.0 * (1.0 - factor))?;
            Some(format!("{side} wheel {percent} % slower{ends}"))
        }
        "drive_scale" => {
            let diameter_cm = robot.wheel_diameter_cm;
            let [wheels_cm, ends] = shown("factor", &|factor| factor * diameter_cm)?;
            Some(format!("wheels like those of {wheels_cm} cm{ends}, robot.toml says {diameter_cm}"))
        }
        "track_width" => {
            let track_cm = robot.track_cm;
            let [effective_cm, ends] = shown("factor", &|factor| track_cm / factor)?;
            Some(format!("effective track {effective_cm} cm{ends}, robot.toml says {track_cm}"))
        }
        "battery_sag" => {
            let [percent, ends] = shown("loss_per_min", &|loss| 100.0 * loss)?;
            Some(format!("{percent} % slower after a minute{ends}"))
        }
        "saturation" => {
            let [cm_s, ends] = shown("command", &|command| command / 100.0 * robot.full_speed_cm_s)?;
            Some(format!("no faster than {cm_s} cm/s{ends}"))
        }
        "tracker_scale" => {
            let [tracked_cm, ends] = shown("factor", &|factor| 100.0 * factor)?;
            Some(format!("100 cm are tracked as {tracked_cm} cm{ends}"))
        }
        "sonar_scale" => {
            let [read_cm, ends] = shown("factor", &|factor| 100.0 * factor)?;
            Some(format!("100 cm are read as {read_cm} cm{ends}"))
        }
        _ => None,
    }
}

/// Writes a number, and its interval in brackets, with the decimals that the interval's width justifies, so that none has width
/// zero.
pub fn written(number: f64, [a, b]: [f64; 2]) -> [String; 2] {
    let half_width = 0.5 * (b - a).abs();
    let magnitude =
        if half_width > 0.0 { libm::floor(libm::log10(half_width / FINEST)) as i32 } else { -MOST_DECIMALS };
    let decimals = (-magnitude).clamp(0, MOST_DECIMALS) as usize;
    // Adding zero turns -0 into 0.
    let written = |x: f64| format!("{:.decimals$}", x + 0.0);
    [written(number), format!(" ({} to {})", written(a.min(b)), written(a.max(b)))]
}

/// Returns the ends of a parameter's interval, if it has one.
pub fn ends_of(intervals: &Map<String, Value>, name: &str) -> Option<[f64; 2]> {
    let ends = intervals.get(name)?.as_array()?;
    Some([ends.first()?.as_f64()?, ends.get(1)?.as_f64()?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::robot;
    use serde_json::json;

    fn map(value: Value) -> Map<String, Value> {
        value.as_object().expect("an object").clone()
    }

    #[test]
    fn decimals_follow_the_width_of_the_interval() {
        assert_eq!(written(0.863_21, [0.855, 0.871_4]).concat(), "0.863 (0.855 to 0.871)");
        assert_eq!(written(111.7, [108.2, 115.1]).concat(), "112 (108 to 115)");
        assert_eq!(written(1.080_02, [1.079_98, 1.080_06]).concat(), "1.08002 (1.07998 to 1.08006)");
    }

    #[test]
    fn rulers_show_lengths_and_speeds() {
        let ruler = |id: &str, parameters: Value, intervals: Value| {
            by_ruler(id, &map(parameters), &map(intervals), &robot()).unwrap_or_default()
        };
        let weak = ruler("motor_asymmetry", json!({"side": "left", "factor": 0.86}), json!({"factor": [0.848, 0.871]}));
        assert_eq!(weak, "left wheel 14.0 % slower (12.9 to 15.2)");
        let wide = ruler("track_width", json!({"factor": 0.5}), json!({"factor": [0.4, 0.625]}));
        assert_eq!(wide, "effective track 20 cm (16 to 25), robot.toml says 10");
        assert_eq!(ruler("saturation", json!({"command": 50.0}), json!({"command": null})), "no faster than 20 cm/s");
        assert_eq!(ruler("slope", json!({"loss": 0.1}), json!({})), "");
    }
}
