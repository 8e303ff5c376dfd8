//! Drafts of `robot.toml` and `scene.toml`, in which unknown values are marked to be filled in.

use std::path::Path;

use mindgap_files as files;
use mindgap_foundations::error::Result;
use mindgap_logs::Robot;

/// A draft of `robot.toml`.
#[derive(Clone, Debug)]
pub struct RobotDraft {
    /// Diameter of the wheels, cm.
    pub wheel_diameter_cm: Measure,
    /// Distance between the wheels, cm.
    pub track_cm: Measure,
    /// Rim speed of a wheel at command 100, cm/s.
    pub full_speed_cm_s: Measure,
    /// Time between two rows, ms.
    pub step_ms: Measure,
    /// Whether the robot has a range sensor, if known.
    pub has_sensor: Option<bool>,
}

/// A number and its origin.
#[derive(Clone, Debug)]
pub struct Measure {
    /// The number.
    pub value: f64,
    /// Its origin, or what to measure.
    pub note: String,
    /// Whether it is a placeholder that must be filled in.
    pub is_placeholder: bool,
}

/// Marks values that must be filled in.
const FILL_IN: &str = "FILL IN";

impl Measure {
    /// Returns a known number.
    pub fn known(value: f64, note: impl Into<String>) -> Self {
        Measure { value, note: note.into(), is_placeholder: false }
    }

    /// Returns a placeholder for an unknown number.
    pub fn placeholder(value: f64, note: impl Into<String>) -> Self {
        Measure { value, note: note.into(), is_placeholder: true }
    }

    fn line(&self, name: &str) -> String {
        let mark = if self.is_placeholder { format!("{FILL_IN}: ") } else { String::new() };
        let value = (100.0 * self.value).round() / 100.0;
        format!("{:<27}# {mark}{}\n", format!("{name} = {value}"), self.note)
    }
}

impl RobotDraft {
    /// Returns a draft of an unknown robot.
    pub fn blank() -> Self {
        RobotDraft {
            wheel_diameter_cm: Measure::placeholder(6.0, "diameter of the driven wheels"),
            track_cm: Measure::placeholder(15.0, "between the centres of the two driven wheels"),
            full_speed_cm_s: Measure::placeholder(
                40.0,
                "rim speed of a wheel at command 100; for commands in cm/s, the maximum speed",
            ),
            step_ms: Measure::known(400.0, "time between two rows of the logs; recordings are resampled to it"),
            has_sensor: None,
        }
    }

    /// Returns the text of the file.
    pub fn text(&self) -> String {
        let body =
            Measure::placeholder(10.0, "a disc of this radius around the centre of the axle must not touch a wall");
        let mut text = "# The robot. Lengths are in centimetres, times in milliseconds.\n".to_owned();
        text += &self.wheel_diameter_cm.line("wheel_diameter_cm");
        text += &self.track_cm.line("track_cm");
        text += &body.line("body_radius_cm");
        text += &self.step_ms.line("step_ms");
        text += &self.full_speed_cm_s.line("full_speed_cm_s");
        let sensor = [
            "[ultrasonic]               # mounting and range of the sensor",
            "x_cm = 0                   # FILL IN: ahead of the centre of the axle",
            "y_cm = 0                   # FILL IN: to its left",
            "yaw_deg = 0                # direction of its axis, counter-clockwise from straight ahead",
            "min_cm = 4                 # FILL IN: smallest reading",
            "max_cm = 240               # FILL IN: largest reading",
        ];
        let before = match self.has_sensor {
            Some(true) => "",
            Some(false) => "# No range readings were imported. A robot with a range sensor has:\n",
            None => "# With a range sensor, uncomment these lines:\n",
        };
        let mark = if self.has_sensor == Some(true) { "" } else { "# " };
        text += &format!("\n{before}");
        sensor.iter().for_each(|line| text += &format!("{mark}{line}\n"));
        text
    }

    /// Parses the draft as a robot.
    ///
    /// # Errors
    /// When the draft is invalid.
    pub fn robot(&self) -> Result<Robot> {
        files::from_toml(Path::new("robot.toml"), &self.text())
    }
}

/// Draft of `scene.toml`: open ground.
pub const SCENE: &str = "\
# Where the robot drove: open ground without walls. Uncomment what applies. Lengths are in centimetres, in the frame of
# the poses (x to the right, y up). Every block except [arena] and [target] may be repeated.

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

/// Returns a warning if values in the `robot.toml` of a folder are still to be filled in.
///
/// # Errors
/// When the file cannot be read.
pub fn warning(folder: &Path) -> Result<Option<String>> {
    let robot = folder.join("robot.toml");
    let open = to_fill_in(&robot.display().to_string(), &files::read_text(&robot)?);
    let others = if open.len() > 1 { format!(" and {} more", open.len() - 1) } else { String::new() };
    let warning = |first| format!("{first}{others}: still marked {FILL_IN}: an error in it will show up as a gap");
    Ok(open.first().map(warning))
}

/// Returns the lines of a file's text that must be filled in.
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
    fn draft_is_valid_and_lists_placeholders() {
        let mut draft = RobotDraft::blank();
        draft.track_cm = Measure::known(23.504, "measured");
        draft.has_sensor = Some(true);
        let robot = draft.robot().expect("a robot");
        assert_eq!((robot.track_cm, robot.step_ms, robot.ultrasonic.map(|s| s.max_cm)), (23.5, 400.0, Some(240.0)));
        let open = to_fill_in("robot.toml", &draft.text());
        assert!(open.iter().any(|line| line.starts_with("robot.toml: body_radius_cm = 10")), "{open:?}");
        assert!(!open.iter().any(|line| line.contains("track_cm")), "{open:?}");
    }

    #[test]
    fn every_line_of_the_scene_draft_can_be_uncommented() {
        let uncommented: String =
            SCENE.lines().skip(2).map(|line| line.strip_prefix("# ").unwrap_or(line).to_owned() + "\n").collect();
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("scene.toml");
        files::write(&file, uncommented).expect("written");
        let scene = mindgap_logs::Scene::read(&file).expect("a scene");
        assert_eq!((scene.obstacles.len(), scene.walls.len(), scene.starts.len()), (1, 1, 1));
    }
}
