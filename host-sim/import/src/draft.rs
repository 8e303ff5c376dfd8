//! Drafts of `robot.toml` and `scene.toml`: what is known stands there, and what is not is marked to be filled in.

use std::path::Path;

use mindgap_files as files;
use mindgap_foundations::error::Result;
use mindgap_logs::Robot;

/// A draft of `robot.toml`.
#[derive(Clone, Debug)]
pub struct RobotDraft {
    /// What is known of the wheels' diameter, cm.
    pub wheel_diameter_cm: Measure,
    /// Of the distance between the wheels, cm.
    pub track_cm: Measure,
    /// Of the speed of a wheel's rim at command 100, cm/s.
    pub full_speed_cm_s: Measure,
    /// Of the time between two rows, ms.
    pub step_ms: Measure,
    /// Whether the robot is known to have a range sensor.
    pub has_sensor: Option<bool>,
}

/// A number and how it came about.
#[derive(Clone, Debug)]
pub struct Measure {
    /// The number.
    pub value: f64,
    /// How it came about, or what to measure.
    pub how: String,
    /// Whether it stands in for one that has to be filled in.
    pub is_open: bool,
}

/// What stands before whatever has to be filled in.
const FILL_IN: &str = "FILL IN";

impl Measure {
    /// A number that is known.
    pub fn known(value: f64, how: impl Into<String>) -> Self {
        Measure { value, how: how.into(), is_open: false }
    }

    /// A stand-in for one that is not.
    pub fn open(value: f64, how: impl Into<String>) -> Self {
        Measure { value, how: how.into(), is_open: true }
    }

    fn line(&self, name: &str) -> String {
        let mark = if self.is_open { format!("{FILL_IN}: ") } else { String::new() };
        let value = (100.0 * self.value).round() / 100.0;
        format!("{:<27}# {mark}{}\n", format!("{name} = {value}"), self.how)
    }
}

impl RobotDraft {
    /// A draft of a robot that nothing is known of.
    pub fn blank() -> Self {
        RobotDraft {
            wheel_diameter_cm: Measure::open(6.0, "diameter of the driven wheels"),
            track_cm: Measure::open(15.0, "between the middles of the two driven wheels"),
            full_speed_cm_s: Measure::open(
                40.0,
                "speed of a wheel's rim at command 100; for commands in cm/s the fastest that it can do",
            ),
            step_ms: Measure::known(400.0, "time between two rows of the logs; recordings are resampled to it"),
            has_sensor: None,
        }
    }

    /// The text of the file.
    pub fn text(&self) -> String {
        let body = Measure::open(10.0, "a disc of this radius round the axle's middle must not touch a wall");
        let mut text = "# The robot. Lengths are in centimetres, times in milliseconds.\n".to_owned();
        text += &self.wheel_diameter_cm.line("wheel_diameter_cm");
        text += &self.track_cm.line("track_cm");
        text += &body.line("body_radius_cm");
        text += &self.step_ms.line("step_ms");
        text += &self.full_speed_cm_s.line("full_speed_cm_s");
        let sensor = [
            "[ultrasonic]               # mounting and range of the sensor",
            "x_cm = 0                   # FILL IN: ahead of the middle of the axle",
            "y_cm = 0                   # FILL IN: to its left",
            "yaw_deg = 0                # direction of its axis, counter-clockwise from straight ahead",
            "min_cm = 4                 # FILL IN: least reading",
            "max_cm = 240               # FILL IN: largest reading",
        ];
        let before = match self.has_sensor {
            Some(true) => "",
            Some(false) => "# No range readings were imported. A robot with a range sensor has:\n",
            None => "# With a range sensor, take the marks before these lines away:\n",
        };
        let mark = if self.has_sensor == Some(true) { "" } else { "# " };
        text += &format!("\n{before}");
        sensor.iter().for_each(|line| text += &format!("{mark}{line}\n"));
        text
    }

    /// The robot as the file has it.
    ///
    /// # Errors
    /// When it would be refused.
    pub fn robot(&self) -> Result<Robot> {
        files::from_toml(Path::new("robot.toml"), &self.text())
    }
}

/// A draft of `scene.toml`: open ground.
pub const SCENE: &str = "\
# Where the robot drove: open ground without walls. With walls, take the marks before what there is away; lengths are in
# centimetres, in the frame of the poses (x to the right, y up), and every block can be there more than once but the first.

# [arena]                  # a rectangle from (0, 0) with a wall on each side
# width_cm = 300
# height_cm = 220

# [[obstacle]]             # a rectangle by its lower-left corner
# x_cm = 70
# y_cm = 60
# width_cm = 40
# height_cm = 25

# [[wall]]                 # a bare wall
# x0_cm = 0
# y0_cm = 0
# x1_cm = 0
# y1_cm = 168

# [target]                 # where an evolved controller has to stop
# x_cm = 265
# y_cm = 115

# [[start]]                # where it starts
# x_cm = 30
# y_cm = 30
# heading_deg = 0
";

/// The lines of a file's text that have to be filled in.
pub fn to_fill_in(file: &str, text: &str) -> Vec<String> {
    let open = text.lines().filter_map(|line| {
        let (setting, what) = line.split_once('#').filter(|(setting, _)| !setting.is_empty())?;
        let what = what.trim().strip_prefix(FILL_IN)?.trim_start_matches(':').trim();
        Some(format!("{file}: {} ({what})", setting.trim()))
    });
    open.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_draft_is_read_and_says_what_is_open() {
        let mut draft = RobotDraft::blank();
        draft.track_cm = Measure::known(23.504, "measured");
        draft.has_sensor = Some(true);
        let robot = draft.robot().expect("a robot");
        assert_eq!((robot.track_cm, robot.step_ms, robot.ultrasonic.max_cm), (23.5, 400.0, 240.0));
        let open = to_fill_in("robot.toml", &draft.text());
        assert!(open.iter().any(|line| line.starts_with("robot.toml: body_radius_cm = 10")), "{open:?}");
        assert!(!open.iter().any(|line| line.contains("track_cm")), "{open:?}");
    }

    #[test]
    fn every_line_of_the_scene_is_ready_to_be_used() {
        let uncommented: String =
            SCENE.lines().skip(2).map(|line| line.strip_prefix("# ").unwrap_or(line).to_owned() + "\n").collect();
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("scene.toml");
        files::write(&file, uncommented).expect("written");
        let scene = mindgap_logs::Scene::read(&file).expect("a scene");
        assert_eq!((scene.obstacles.len(), scene.walls.len(), scene.starts.len()), (1, 1, 1));
    }
}
