//! Scales of one small robot: a LEGO NXT on wheels of 5.6 cm, 11.5 cm apart. Effects refer their losses to them.

/// Full speed of its wheels.
pub const FULL_SPEED_CM_S: f64 = 41.0;
/// Half of that: the speed at which the loss by a force is stated.
pub const HALF_SPEED_CM_S: f64 = 20.0;
/// Half of its fastest turn on the spot: the rate at which the loss of turns is stated.
pub const HALF_TURN_RATE_RAD_S: f64 = 3.5;
/// Below this speed a force moves the robot or holds it back less and less: at rest it stays where it is.
pub const CREEPING_CM_S: f64 = 3.75;
/// Turns slower than this scrub the tyres less and less.
pub const CREEPING_RAD_S: f64 = 0.1;
/// Time constant of its motors.
pub const MOTOR_MS: f64 = 50.0;
/// Width over which a wheel starts to move as its command passes a deadband: the likelihood needs a slope there.
pub const DEADBAND_EDGE_CM_S: f64 = 0.8;
/// A speed that no wheel of an indoor robot reaches.
pub const UNREACHED_SPEED_CM_S: f64 = 100.0;
/// Change of wheel speed beyond the onset of slip at which half of the full loss is reached.
pub const HALF_SLIP_CM_S: f64 = 16.0;
/// A step that turns less than this does not load the tyres to their grip.
pub const GRIPPING_TURN_RAD: f64 = 0.04;
