//! The ultrasonic sensor: when the first echo triggers it, and what its electronics report.

mod beam;

use rand::RngExt;

use super::hardware::Sonar;
use super::noise::{happens, normal};
use mindgap_foundations::chance::Generator;
use mindgap_foundations::geometry::{Pose, Wall};

/// Standard deviation of the distance at which the transducer's own ringing, or a fixed object, triggers the sensor.
const TRIGGER_SPREAD_CM: f64 = 0.8;
/// Mean duration of a loss of contact at the plug.
const LOOSE_FOR_MS: f64 = 1600.0;
/// Excess distance of an echo that just reaches the threshold, which triggers the sensor late.
const FAINT_CM: f64 = 1.5;

/// What a reading depends on beside the sensor and the walls.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ping {
    /// Pose of the robot when the ping was sent.
    pub from: Pose,
    /// Time into the run.
    pub t_ms: f64,
    /// Mean speed of the wheels relative to full speed.
    pub wheel_speed: f64,
}

/// State of the sensor between readings.
#[derive(Clone, Debug, Default)]
pub(super) struct Receiver {
    /// Whether the plug had no contact at the last reading, and when that was.
    loose: bool,
    last_ms: f64,
}

impl Receiver {
    /// One reading: whole centimetres, or `None`.
    pub fn read(&mut self, sonar: &Sonar, sides: &[Wall], ping: &Ping, rng: &mut Generator) -> Option<f64> {
        let echo_cm = beam::first_echo(sonar, sides, ping, rng).map(|echo| {
            let late_cm = FAINT_CM * libm::pow(10.0, -echo.level_db / 20.0);
            echo.distance_cm + late_cm + (sonar.scatter_cm + sonar.grazing_cm * echo.grazing) * normal(rng)
        });
        let heard_cm = earlier(echo_cm, trigger(sonar.ringing, sonar.ringing_cm, rng));
        let heard_cm = earlier(heard_cm, trigger(sonar.ghost, sonar.ghost_cm, rng));
        let heard_cm = if happens(sonar.crosstalk, rng) { foreign(sonar, heard_cm, rng) } else { heard_cm };
        let warmed = 1.0 + sonar.warming_per_min * ping.t_ms / 60_000.0;
        let loose = self.loses_contact(sonar, ping.t_ms, rng);
        let reading_cm = ((heard_cm? + sonar.delay_cm) * sonar.timer * warmed).round();
        (!loose && (sonar.min_cm..=sonar.max_cm).contains(&reading_cm)).then_some(reading_cm)
    }

    /// Whether the plug has no contact: a two-state Markov process, sampled at the times of the readings.
    fn loses_contact(&mut self, sonar: &Sonar, t_ms: f64, rng: &mut Generator) -> bool {
        if sonar.loose > 0.0 {
            let memory = libm::exp(-(t_ms - self.last_ms) / (LOOSE_FOR_MS * (1.0 - sonar.loose)));
            let before = if self.loose { 1.0 } else { 0.0 };
            self.loose = happens(sonar.loose + (before - sonar.loose) * memory, rng);
            self.last_ms = t_ms;
        }
        self.loose
    }
}

/// The distance at which something other than a wall triggers the sensor, with this probability.
fn trigger(probability: f64, distance_cm: f64, rng: &mut Generator) -> Option<f64> {
    happens(probability, rng).then(|| distance_cm + TRIGGER_SPREAD_CM * normal(rng))
}

/// A ping of another sensor arrives at a uniform time before the own echo, or within half of the listening time.
fn foreign(sonar: &Sonar, echo_cm: Option<f64>, rng: &mut Generator) -> Option<f64> {
    let latest_cm = echo_cm.unwrap_or(f64::INFINITY).min(sonar.max_cm / 2.0).max(sonar.min_cm);
    Some(rng.random_range(sonar.min_cm..=latest_cm))
}

/// The nearer of two possible distances.
fn earlier(a_cm: Option<f64>, b_cm: Option<f64>) -> Option<f64> {
    match (a_cm, b_cm) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}
