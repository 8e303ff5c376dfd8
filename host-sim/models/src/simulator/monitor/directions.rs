//! The directions in which a monitor looks for a change of the robot.

use mindgap_core::monitor::{CHANNELS, Direction, MOST_FACTOR, Response, Whitening};

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
    /// What the travel of each wheel changes in proportion to.
    response: Response,
    /// Factors on the response of the left and the right wheel.
    wheels: [f64; 2],
    /// Whether it acts on the sum of both wheels, the way forward, and on their difference, the turn.
    acts_on: [bool; CHANNELS],
    grows: bool,
    is_opposite: bool,
}

const PLAIN: Named = Named {
    name: "",
    effects: &[],
    unit: "share",
    response: Response::Travel,
    wheels: [-1.0; 2],
    acts_on: [true; CHANNELS],
    grows: false,
    is_opposite: false,
};

/// All directions.
pub const DIRECTIONS: &[Named] = &[
    Named { name: "weaker left motor", effects: &["motor_asymmetry", "payload"], wheels: [-1.0, 0.0], ..PLAIN },
    Named { name: "weaker right motor", effects: &["motor_asymmetry", "payload"], wheels: [0.0, -1.0], ..PLAIN },
    Named { name: "slower", effects: &["drive_scale"], ..PLAIN },
    Named { name: "faster", effects: &["drive_scale"], is_opposite: true, ..PLAIN },
    Named { name: "turns less", effects: &["track_width"], acts_on: [false, true], ..PLAIN },
    Named { name: "turns more", effects: &["track_width"], is_opposite: true, ..PLAIN },
    Named { name: "later", effects: &["latency", "inertia"], unit: "steps", response: Response::Change, ..PLAIN },
    Named { name: "earlier", effects: &["latency", "inertia"], unit: "steps", is_opposite: true, ..PLAIN },
    Named { name: "more friction", effects: &["deadband"], response: Response::Sign, ..PLAIN },
    Named { name: "fading", effects: &["battery_sag"], unit: "share after 64 steps", grows: true, ..PLAIN },
];

/// Root mean square shift of innovations, in standard deviations, by the smallest alternative of a direction. Its gain is then
/// 0.18 nats per step, and that of the largest 2.9.
const SMALLEST_SHIFT: f64 = 0.6;
/// Steps since the run began at which a growing difference has that size.
const TYPICAL_RUN_STEPS: f64 = 40.0;

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

/// Returns the directions in fixed point, and the sizes of their smallest alternatives.
pub fn scaled(
    steps: &[Travel],
    whitening: &[Whitening; CHANNELS],
    units: [f64; CHANNELS],
    robot: &Robot,
) -> (Vec<Direction>, Vec<f64>) {
    let full = [0.5 * full_cm(robot), (full_cm(robot) / robot.track_cm).to_degrees()];
    let sensitivity = [0, 1].map(|i: usize| full[i] / units[i]);
    let mut sizes: Vec<f64> = Vec::new();
    let mut scaled = Vec::new();
    for named in DIRECTIONS {
        if named.is_opposite {
            sizes.push(sizes.last().copied().unwrap_or(0.0));
            let opposite = Direction { is_opposite: true, ..scaled.last().copied().unwrap_or(NONE) };
            scaled.push(opposite);
            continue;
        }
        let acting = [0, 1].map(|i: usize| if named.acts_on[i] { sensitivity[i] } else { 0.0 });
        let squares = steps.iter().map(|step| {
            let [left, right] = differences(named, step);
            let shifts = [(left + right) * acting[0], (right - left) * acting[1]];
            let shift = |i: usize| shifts[i] / whitening::deviation(&whitening[i].gains[1][0]);
            shift(0) * shift(0) + shift(1) * shift(1)
        });
        let mean_square = squares.sum::<f64>() / steps.len() as f64;
        let typical = if named.grows { TYPICAL_RUN_STEPS / 64.0 } else { 1.0 };
        let size = SMALLEST_SHIFT / mean_square.sqrt().max(1e-9) / typical;
        let factor = |x: f64| {
            libm::round(libm::ldexp(size * x, 12)).clamp(-f64::from(MOST_FACTOR), f64::from(MOST_FACTOR)) as i16
        };
        let [left, right] = named.wheels;
        let forward = [factor(acting[0] * left), factor(acting[0] * right)];
        let turn = [factor(-acting[1] * left), factor(acting[1] * right)];
        let Named { response, grows, .. } = *named;
        scaled.push(Direction { response, forward, turn, grows, is_opposite: false });
        sizes.push(size);
    }
    (scaled, sizes)
}

const NONE: Direction =
    Direction { response: Response::Travel, forward: [0; 2], turn: [0; 2], grows: false, is_opposite: false };

fn differences(named: &Named, [travel, before]: &Travel) -> [f64; 2] {
    [0, 1].map(|wheel: usize| {
        let sign = if travel[wheel].abs() < 1.0 / 64.0 { 0.0 } else { travel[wheel].signum() };
        let response = match named.response {
            Response::Travel => travel[wheel],
            Response::Change => travel[wheel] - before[wheel],
            Response::Sign => sign,
        };
        named.wheels[wheel] * response
    })
}
