//! The directions in which a monitor looks for a change of the robot.

use mindgap_core::monitor::{
    CHANNELS, DIRECTIONS, HAS_OPPOSITE, MOST_FACTOR, MOST_SIGN, RESPONSES, SIGNALS, TRAVEL_BITS, Whitening,
};

use super::{full_cm, whitening};
use crate::simulator::motion::MotionNetworks;
use mindgap_logs::Robot;

/// A direction and what it is called.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Named {
    /// What it is, for people.
    pub name: &'static str,
    /// Effects of the catalogue that it stands for.
    pub effects: &'static [&'static str],
    /// What its size is: a share, or steps.
    pub unit: &'static str,
}

const fn share(name: &'static str, effects: &'static [&'static str]) -> Named {
    Named { name, effects, unit: "share" }
}

/// All directions, in the order of the monitor.
pub const NAMED: [Named; DIRECTIONS] = [
    share("weaker left motor", &["motor_asymmetry", "payload"]),
    share("weaker right motor", &["motor_asymmetry", "payload"]),
    share("slower", &["drive_scale"]),
    share("faster", &["drive_scale"]),
    share("turns less", &["track_width"]),
    share("turns more", &["track_width"]),
    Named { unit: "steps", ..share("later", &["latency", "inertia"]) },
    Named { unit: "steps", ..share("earlier", &["latency", "inertia"]) },
    share("more friction", &["deadband"]),
    Named { unit: "share after 32 steps", ..share("fading", &["battery_sag"]) },
];

/// Number of the response that each signal depends on: travel, its change, or its sign.
const RESPONSE: [usize; SIGNALS] = [0, 0, 0, 0, 1, 2, 0];

/// Root mean square shift of innovations, in standard deviations, by the smaller alternative where both wheels respond. Its gain is
/// then 0.21 nats per step, and that of the larger 1.9.
const SMALLER_SHIFT: f64 = 0.65;

/// Travel of both wheels in a step and the one before, as shares of that at full speed.
pub type Travel = [[f64; 2]; 2];

/// Returns the travel in the steps of commands in turn, each held for two steps.
pub fn typical_steps(commands: &[[f64; 2]], networks: &MotionNetworks, robot: &Robot) -> Vec<Travel> {
    let travel = |[l, r]: [f64; 2], [before_l, before_r]: [f64; 2]| {
        let motion = networks.evaluate([l, r, before_l, before_r].map(|c| c as f32));
        let (along, across) = (f64::from(motion.forward), 0.5 * robot.track_cm * f64::from(motion.turn));
        [along - across, along + across].map(|cm| cm / full_cm(robot))
    };
    // Neighbouring entries of the evidence are similar commands.
    let apart = commands.len() / 2 + 1;
    let of = |i: usize| commands[i * apart % commands.len()];
    let mut steps = Vec::new();
    let mut before = [0.0; 2];
    for i in 0..commands.len() {
        let [last, now] = [of(i), of(i + 1)];
        let [first, held] = [travel(now, last), travel(now, now)];
        steps.extend([[first, before], [held, first]]);
        before = held;
    }
    steps
}

/// Directions of a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Scaled {
    /// See [`mindgap_core::monitor::Law::factors`].
    pub factors: [[i16; RESPONSES]; CHANNELS],
    /// See [`mindgap_core::monitor::Law::sign`].
    pub sign: i16,
    /// Size of each direction's smaller alternative, in its unit.
    pub sizes: Vec<f64>,
}

impl Scaled {
    /// Of a robot with these steps.
    pub fn of(steps: &[Travel], whitening: &[Whitening; CHANNELS], units: [f64; CHANNELS], robot: &Robot) -> Self {
        let full = [0.5 * full_cm(robot), (full_cm(robot) / robot.track_cm).to_degrees()];
        let sensitivity = [0, 1].map(|i: usize| full[i] / units[i]);
        let deviation = [0, 1].map(|i: usize| whitening::deviation(&whitening[i].gains[1][0]));
        let by_response: [f64; 3] = std::array::from_fn(|i| {
            let squares = steps.iter().map(|step| {
                let [left, right] = responses(step)[i];
                let shifts = [left + right, right - left];
                let shift = |i: usize| shifts[i] * sensitivity[i] / deviation[i];
                shift(0) * shift(0) + shift(1) * shift(1)
            });
            let mean_square = squares.sum::<f64>() / steps.len() as f64;
            SMALLER_SHIFT / mean_square.sqrt().max(1e-9)
        });
        let factor = |x: f64| libm::round(libm::ldexp(x, TRAVEL_BITS as i32)).min(f64::from(MOST_FACTOR)) as i16;
        let factors =
            sensitivity.map(|sensitivity| [by_response[0], by_response[1]].map(|size| factor(size * sensitivity)));
        let sign = libm::ldexp(by_response[2] / by_response[0], TRAVEL_BITS as i32);
        let sizes = RESPONSE.into_iter().zip(HAS_OPPOSITE).flat_map(|(response, has_opposite)| {
            std::iter::repeat_n(by_response[response], 1 + usize::from(has_opposite))
        });
        Scaled { factors, sign: libm::round(sign).min(f64::from(MOST_SIGN)) as i16, sizes: sizes.collect() }
    }
}

/// Returns each response of both wheels.
fn responses([travel, before]: &Travel) -> [[f64; 2]; 3] {
    let sign = travel.map(|travel| (64.0 * travel).clamp(-1.0, 1.0));
    [*travel, [0, 1].map(|wheel: usize| travel[wheel] - before[wheel]), sign]
}
