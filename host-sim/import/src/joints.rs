//! Finds the joints of driven wheels by their names.

use super::words::words;

/// The names of joints: those of left and of right wheels.
pub type Wheels = [Vec<String>; 2];

/// Words for a side; with two letters, the other one is for front, middle, rear or back.
const SIDES: [&[&str]; 2] = [
    &["left", "l", "fl", "lf", "ml", "lm", "rl", "lr", "bl", "lb"],
    &["right", "r", "fr", "rf", "mr", "rm", "rr", "br", "rb"],
];
/// Words for a driven wheel.
const WHEEL: [&str; 9] = ["wheel", "wheels", "whl", "drivewhl", "drive", "motor", "sprocket", "tyre", "tire"];
/// Words that may be next to the side in the name of a joint that is nothing but a wheel.
const PLAIN: [&str; 5] = ["joint", "front", "rear", "back", "middle"];
/// Words for joints that roll or turn along without driving.
const OTHER: [&str; 16] = [
    "caster",
    "castor",
    "steer",
    "steering",
    "knuckle",
    "suspension",
    "swivel",
    "arm",
    "gripper",
    "finger",
    "hand",
    "flipper",
    "leg",
    "hip",
    "knee",
    "passive",
];

/// Returns the joints of driven wheels among these, if both sides have the same number of them.
pub fn wheels<'a>(names: impl Iterator<Item = &'a str> + Clone) -> Option<Wheels> {
    let of = |side: usize, is_wheel: fn(&[String]) -> bool| {
        let names = names.clone().filter(|name| {
            let words = split(name);
            side_of(&words) == Some(side) && is_wheel(&words)
        });
        names.map(str::to_owned).collect::<Vec<String>>()
    };
    let found = |is_wheel| [of(0, is_wheel), of(1, is_wheel)];
    let is_pair = |[left, right]: &Wheels| !left.is_empty() && left.len() == right.len();
    Some(found(is_driven)).filter(is_pair).or_else(|| Some(found(is_plain)).filter(is_pair))
}

/// Splits a name into words, also where `wheel` is not separated.
fn split(name: &str) -> Vec<String> {
    words(name).iter().flat_map(|word| words(&word.replace("wheel", " wheel "))).collect()
}

/// Returns the side, 0 for left, if there is exactly one.
fn side_of(words: &[String]) -> Option<usize> {
    let has = |side: usize| words.iter().any(|word| SIDES[side].contains(&word.as_str()));
    match [has(0), has(1)] {
        [true, false] => Some(0),
        [false, true] => Some(1),
        _ => None,
    }
}

fn is_driven(words: &[String]) -> bool {
    let has = |known: &[&str]| words.iter().any(|word| known.contains(&word.as_str()));
    has(&WHEEL) && !has(&OTHER)
}

fn is_plain(words: &[String]) -> bool {
    let is_known = |word: &str| SIDES.iter().any(|side| side.contains(&word)) || PLAIN.contains(&word);
    words.iter().all(|word| is_known(word))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(names: &str) -> Option<String> {
        wheels(names.split_whitespace()).map(|[left, right]| format!("{} | {}", left.join(" "), right.join(" ")))
    }

    #[test]
    fn driven_wheels_are_found_by_the_names_that_robots_use() {
        for (names, expected) in [
            ("wheel_left_joint wheel_right_joint", "wheel_left_joint | wheel_right_joint"),
            ("drivewhl_r_joint drivewhl_l_joint caster_joint", "drivewhl_l_joint | drivewhl_r_joint"),
            (
                "front_left_wheel front_right_wheel rear_left_wheel rear_right_wheel",
                "front_left_wheel rear_left_wheel | front_right_wheel rear_right_wheel",
            ),
            ("fl_wheel rl_wheel fr_wheel rr_wheel", "fl_wheel rl_wheel | fr_wheel rr_wheel"),
            ("LeftWheel RightWheel left_arm_joint", "LeftWheel | RightWheel"),
            ("leftwheel rightwheel left_caster_wheel right_caster_wheel", "leftwheel | rightwheel"),
            ("motorL motorR", "motorL | motorR"),
            ("left_joint right_joint", "left_joint | right_joint"),
        ] {
            assert_eq!(found(names).as_deref(), Some(expected), "{names}");
        }
    }

    #[test]
    fn other_joints_are_no_wheels() {
        for names in [
            "",
            "joint_a joint_b",
            "left_gripper_finger right_gripper_finger",
            "left_wheel",
            "fl_wheel rl_wheel r_wheel",
            "left_steering_wheel right_steering_wheel",
            "left_right_wheel wheel",
        ] {
            assert_eq!(found(names), None, "{names}");
        }
    }
}
