//! Scales that effects refer their losses to: shares of the robot's own full speed, fastest turn and track, so that a robot ten
//! times as large is the same robot. The shares are those of a LEGO NXT, 41 cm/s fast on a track of 11.5 cm.

use mindgap_logs::Robot;

/// About half of full speed: the speed at which the loss by a force is stated.
pub const HALF_SPEED: f64 = 20.0 / 41.0;
/// About half of the fastest turn on the spot: the rate at which the loss of turns is stated.
pub const HALF_TURN_RATE: f64 = 3.5 / NXT_RAD_S;
/// Below this speed a force moves the robot or holds it back less and less: at rest it stays where it is.
pub const CREEPING: f64 = 3.75 / 41.0;
/// Turns slower than this share of the fastest scrub the tyres less and less.
pub const CREEPING_TURN: f64 = 0.1 / NXT_RAD_S;
/// Time constant of the motors that simulators know.
pub const MOTOR_MS: f64 = 50.0;
/// Width over which a wheel starts to move as its command passes a deadband: the likelihood needs a slope there.
pub const DEADBAND_EDGE: f64 = 0.8 / 41.0;
/// A speed that no command asks for.
pub const UNREACHED_SPEED: f64 = 100.0 / 41.0;
/// Change of wheel speed beyond the onset of slip at which half of the full loss is reached.
pub const HALF_SLIP: f64 = 16.0 / 41.0;
/// A step that turns less than this does not load the tyres to their grip.
pub const GRIPPING_TURN_RAD: f64 = 0.04;

/// The fastest turn on the spot of an NXT.
const NXT_RAD_S: f64 = 2.0 * 41.0 / 11.5;

/// Returns the fastest turn on the spot, rad/s.
pub fn full_turn_rad_s(robot: &Robot) -> f64 {
    2.0 * robot.full_speed_cm_s / robot.track_cm
}
