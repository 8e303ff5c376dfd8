//! Causes that no model file can express, and why.

/// Returns why a cause is in no model file of any format, or `None` if some format may have a tag for it.
pub fn of_any_format(effect: &str) -> Option<&'static str> {
    Some(match effect {
        "scatter" => "the robot scatters more than its simulator: add noise in the driver",
        "battery_sag" => "no model file has a battery that weakens a drive: lower the driver's gain during the run",
        "turn_loss" => "no tag costs way while turning: lower the driver's forward speed by the turn rate",
        "turn_lag" => "no tag lets the body turn later than its wheels: filter the turn rate in the driver",
        "carpet_nap" => "friction has no direction on a floor: it belongs to the world, not to the robot",
        "slope" => {
            "the floor is tilted: turn gravity or the floor in the world file; the diagnosis reports a loss of speed, not an angle"
        }
        "sonar_ghost" | "sonar_dropout" | "sonar_crosstalk" | "sonar_absorption" | "sonar_multipath" => {
            "no range sensor of a model file does this: add it in the driver, after the reading"
        }
        "sonar_pitch" => "the diagnosis reports where the beam meets the floor: measure the mount's pitch",
        "marker_offset" | "heading_lag" | "lens_distortion" | "compass_disturbance" => OF_TRACKER,
        tracker if tracker.starts_with("tracker_") => OF_TRACKER,
        _ => return None,
    })
}

/// Why faults of the tracker are not written.
const OF_TRACKER: &str = "it is a fault of what tracks the robot, not of the robot: correct the tracker or its poses";

/// Returns the reason for a cause that one format has no tag for.
pub fn no_tag(format: &str) -> String {
    format!("{format} has no tag for it")
}

/// Returns why slip is not written: which tags there are, and how the engine reads them.
pub fn slip(tags: &str, combined: Option<&str>) -> String {
    let combined = combined.map(|how| format!(" ({how})")).unwrap_or_default();
    format!(
        "the diagnosis reports the change of command at which tyres slide, not a friction coefficient: lower {tags}{combined}, \
         record the simulator again and compare"
    )
}

/// Returns why a load is not written without its mass.
pub const LOAD_WITHOUT_MASS: &str = "the diagnosis reports a loss of speed, not a mass: weigh the robot, write its mass and centre of mass, and compare again";
