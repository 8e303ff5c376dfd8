//! Behaviour of every onboard program beyond the controller: how long it waits for the ultrasonic sensor, when it considers
//! the sensor dead, and how it ends.

pub use mindgap_core::limits::FREE_FLASH_BYTES;

/// The sensor's code for "no echo". It does not count as a reading: the tuple is held.
pub const NO_ECHO_CM: u8 = 255;

/// Timeout of one exchange with the sensor. The firmware's own driver gives up after three polls 15 ms apart.
pub const SONAR_TIMEOUT_MS: u16 = 45;

/// How long a sensor that begins an answer and never ends it keeps its port busy in the firmware.
pub const SONAR_HANG_MS: u32 = 100;

/// Time between two polls for the sensor's answer.
pub const SONAR_POLL_MS: u16 = 3;

/// Steps in a row without an answer after which the sensor counts as dead and the robot is stopped. One missed answer
/// may be a disturbed wire, and holds the tuple as a missing echo does.
pub const FAILED_STEPS_TO_STOP: u8 = 2;

/// Time between switching the sensor on and the start of the run.
pub const SONAR_WARM_UP_MS: u16 = 250;

/// How long the motors brake before the program ends, after which they coast.
pub const BRAKE_MS: u16 = 250;

/// Frequency of the tone after a run whose sixth test held; it lasts while the motors brake.
pub const FINISHED_HZ: u16 = 880;

/// Frequency of the tone after a run that reached its step limit or lost its sensor.
pub const GAVE_UP_HZ: u16 = 220;

/// Volume of the tones, of 4.
pub const TONE_VOLUME: u8 = 4;
