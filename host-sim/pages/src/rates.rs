//! Speeds of a step, as commanded and as driven.

use mindgap_foundations::geometry::Pose;
use mindgap_foundations::motion::Motion;
use mindgap_logs::Robot;

/// Forward speed in cm/s and turn rate in degrees/s.
pub type Rates = [f64; 2];

/// Returns the speeds that a command asks for, by the textbook's differential drive.
pub fn commanded(robot: &Robot, command: [f64; 2]) -> Rates {
    of_wheels(robot, command.map(|wheel| wheel / 100.0 * robot.full_speed_cm_s))
}

/// Returns the speeds of a robot whose left and right rims move so fast, cm/s.
pub fn of_wheels(robot: &Robot, [left, right]: [f64; 2]) -> Rates {
    [0.5 * (left + right), ((right - left) / robot.track_cm).to_degrees()]
}

/// Returns the speeds between two poses, of which the second is this much later.
pub fn driven(from: &Pose, to: &Pose, duration_s: f64) -> Rates {
    let motion = Motion::between(from, to).turn_in_degrees();
    [motion.forward, motion.turn].map(|change| change / duration_s)
}
