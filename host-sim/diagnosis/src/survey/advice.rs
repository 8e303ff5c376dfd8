//! What to drive more: what no row of the logs shows, in plain sentences.

use super::holdings::{Holdings, Range, commands, steps};
use mindgap_logs::{Logs, Ultrasonic};

/// Wheels whose commands differ by this much turn the robot clearly: a tenth of full speed is beyond what motors differ by.
const CLEAR: f64 = 10.0;
/// The friction of small motors keeps them from moving at commands below this.
const SMALL: f64 = 20.0;
/// A drive that saturates does so beyond this.
const LARGE: f64 = 80.0;
/// Brick, link and inertia take up to a second until a command acts in full, ms.
const SETTLED_MS: f64 = 1000.0;
/// Controllers hold commands for at least this many steps; what is a fraction of a degree in one step adds up there.
const LONG_HOLD: u32 = 10;
/// Echoes begin to fail in the last quarter of a sensor's range; within the first one a controller decides to stop.
const QUARTER: f64 = 0.25;
/// At this incidence, degrees, smooth walls no longer return an echo to most sensors.
const OBLIQUE_DEG: f64 = 45.0;
/// With a pose in fewer rows than this most steps lack one at an end.
const HALF: f64 = 0.5;

/// What is missing in logs, a sentence each.
pub fn advice(logs: &Logs, holds: &Holdings) -> Vec<String> {
    let mut missing = if commands(logs).flatten().any(|c| c.abs() >= 1.0) {
        of_commands(logs, holds)
    } else {
        vec!["No command drives the motors.".into()]
    };
    if holds.with_pose < HALF {
        let percent = 100.0 * holds.with_pose;
        missing.push(format!("The tracker sees the robot in {percent:.0} % of the rows only."));
    }
    if let (Some(sensor), Some(distance_cm), Some(alpha_deg)) =
        (&logs.robot.ultrasonic, holds.distance_cm, holds.alpha_deg)
    {
        missing.extend(of_sensor(sensor, distance_cm, alpha_deg));
    }
    missing
}

fn of_commands(logs: &Logs, holds: &Holdings) -> Vec<String> {
    let mut missing = Vec::new();
    let any = |is_meant: fn([f64; 2]) -> bool| commands(logs).any(is_meant);
    if !any(|[left, right]| right - left >= CLEAR) {
        missing.push("No run turns to the left.".into());
    }
    if !any(|[left, right]| left - right >= CLEAR) {
        missing.push("No run turns to the right.".into());
    }
    if !any(|[left, right]| (left - right).abs() < CLEAR && left.min(right) >= CLEAR) {
        missing.push("No run drives straight ahead.".into());
    }
    let magnitudes = || commands(logs).flatten().map(f64::abs).filter(|c| *c >= 1.0);
    let (least, most) = (magnitudes().fold(f64::INFINITY, f64::min), magnitudes().fold(0.0, f64::max));
    if least >= SMALL {
        missing.push(format!("No command is below {least:.0}, where friction would show."));
    }
    if most <= LARGE {
        missing.push(format!("No command is beyond {most:.0}, where the drive would show its limit."));
    }
    let (longest, step_ms) = (holds.longest_held_steps, logs.robot.step_ms);
    if f64::from(longest) * step_ms < SETTLED_MS {
        missing.push(format!(
            "No command is held for longer than {:.0} ms: hold some for a second.",
            f64::from(longest) * step_ms
        ));
    } else if longest < LONG_HOLD {
        missing.push(format!(
            "No command is held for longer than {longest} steps: controllers hold theirs for {LONG_HOLD} and more, so let some runs \
             do that too."
        ));
    }
    let never_changes = logs.runs.iter().all(|run| {
        let mut commands = steps(run).map(|row| row.command());
        let first = commands.next();
        commands.all(|command| Some(command) == first)
    });
    if never_changes {
        missing.push("No command changes within a run: how soon the drive follows does not show.".into());
    }
    missing
}

/// What is missing for a range sensor.
pub fn of_sensor(sensor: &Ultrasonic, distance_cm: Range, alpha_deg: Range) -> Vec<String> {
    let max_cm = sensor.max_cm;
    let mut missing = Vec::new();
    if distance_cm.high < (1.0 - QUARTER) * max_cm {
        missing.push(format!("No wall is seen beyond {:.0} cm; the sensor's range is {max_cm} cm.", distance_cm.high));
    }
    if distance_cm.low > QUARTER * max_cm {
        missing.push(format!("No wall is seen nearer than {:.0} cm.", distance_cm.low));
    }
    if alpha_deg.high < OBLIQUE_DEG {
        missing.push(format!("No wall is seen more obliquely than by {:.0} degrees.", alpha_deg.high));
    }
    missing
}
