//! Scales that effects refer their losses to. Lengths and speeds are relative to the robot's track, so that a robot ten times as
//! large is the same robot; full speed will not do, since it depends on the unit of commands. The numbers are those of a LEGO
//! NXT, which drives at up to 41 cm/s on a track of 11.5 cm.

use mindgap_logs::Robot;

/// Speeds are shares of this many tracks a second.
const TRACKS_PER_S: f64 = 41.0 / 11.5;
/// About half of the reference speed, and of full speed: at which the loss by a force is stated.
pub const HALF_SPEED: f64 = 20.0 / 41.0;
/// Below this speed a force moves the robot or holds it back less and less: at rest it stays where it is.
pub const CREEPING: f64 = 3.75 / 41.0;
/// Width over which a wheel starts to move as its command passes a deadband: the likelihood needs a slope there.
pub const DEADBAND_EDGE: f64 = 0.8 / 41.0;
/// A speed that no command asks for.
pub const UNREACHED_SPEED: f64 = 8.0;
/// Change of wheel speed beyond the onset of slip at which half of the full loss is reached.
pub const HALF_SLIP: f64 = 16.0 / 41.0;

/// About half of the fastest turn on the spot: the rate at which the loss of turns is stated.
pub const HALF_TURN_RATE_RAD_S: f64 = 3.5;
/// Turns slower than this scrub the tyres less and less.
pub const CREEPING_RAD_S: f64 = 0.1;
/// A step that turns less than this does not load the tyres to their grip.
pub const GRIPPING_TURN_RAD: f64 = 0.04;
/// Time constant of the motors that simulators know.
pub const MOTOR_MS: f64 = 50.0;

/// Returns the reference speed, cm/s: speeds are shares of it.
pub fn reference_cm_s(robot: &Robot) -> f64 {
    TRACKS_PER_S * robot.track_cm
}

/// Returns the command that asks for a share of the reference speed.
pub fn command_for(share: f64, robot: &Robot) -> f64 {
    100.0 * share * reference_cm_s(robot) / robot.full_speed_cm_s
}

/// Returns the share of the reference speed that a command asks for.
pub fn share_of(command: f64, robot: &Robot) -> f64 {
    command / 100.0 * robot.full_speed_cm_s / reference_cm_s(robot)
}
