use super::*;
use crate::chance::{Generator, normal};
use proptest::prelude::*;
use rand_core::{Rng, SeedableRng};

const NO_FUNCTIONS: [[i16; POINTS]; 6] = [[0; POINTS]; 6];
/// A wheel covers 16 cm in a step at full speed; the track is 12 cm.
const FULL_CM: f64 = 16.0;
const FULL_DEG: f64 = 76.4;
/// Standard deviations of forward and turn, cm and degrees.
const NOISE: [f64; 2] = [0.25, 1.0];

const fn direction(forward: [i16; 2], turn: [i16; 2]) -> Direction {
    Direction { response: Response::Travel, forward, turn, grows: false, is_opposite: false }
}

/// Half of 16 cm is 32 standard deviations, 76.4 degrees are 76; the unit is 1/64 of the travel.
static DIRECTIONS: [Direction; 4] = [
    direction([-2048, 0], [4864, 0]),
    direction([0, -2048], [0, -4864]),
    direction([-2048, -2048], [4864, -4864]),
    Direction { is_opposite: true, ..direction([0; 2], [0; 2]) },
];

/// A robot whose residuals are white, and whose simulator has no error.
fn law() -> Law<'static> {
    let gains = Gains { precision: 1 << 14, error: 0, tracker: 0, shift: 1 << 14 };
    // One over the noise, in 30 - 6 fractional bits after the shift from Q16.16 to 10 bits.
    let whitening = |noise: f64| Whitening {
        scale: ((1 << 26) as f64 / noise) as i32,
        shift: 0,
        gains: [[gains; HELD]; 2],
        by_travel: [1 << 14; TRAVELS],
    };
    let q28 = |x: f64| (x * (1 << 28) as f64) as i32;
    Law {
        share_of_command: ((1 << 30) as f64 / 100.0) as i32,
        travel: [q28(1.0 / FULL_CM), q28(0.5 / FULL_DEG)],
        straight_travel: 1 << 10,
        step_ms: 400,
        per_step_ms: (1 << 24) / 400,
        correction: [Correction { functions: &NO_FUNCTIONS, shift: 0 }; 2],
        whitening: NOISE.map(whitening),
        directions: &DIRECTIONS,
        most_paused_steps: 3,
        threshold: 17 << NAT_BITS,
    }
}

/// Drives at random; the left wheel covers `left` of what it should.
struct Robot {
    generator: Generator,
    left: f64,
    before: [I16F16; 2],
}

impl Robot {
    fn new(seed: u64) -> Self {
        Robot { generator: Generator::seed_from_u64(seed), left: 1.0, before: [I16F16::ZERO; 2] }
    }

    fn step(&mut self) -> Step {
        let mut command = || {
            I16F16::saturating_from_num(self.generator.next_u32() % 161).saturating_sub(I16F16::saturating_from_num(80))
        };
        let now = [command(), command()];
        let shares = now.map(|c| c.to_num::<f64>() / 100.0);
        let motion = |[l, r]: [f64; 2]| [0.5 * FULL_CM * (l + r), FULL_DEG * (r - l)];
        let (predicted, does) = (motion(shares), motion([self.left * shares[0], shares[1]]));
        let number = |x: f64| I16F16::saturating_from_num(x);
        let measured = [0, 1].map(|i: usize| normal(number(does[i]), number(NOISE[i]), &mut self.generator));
        let commands = [now[0], now[1], self.before[0], self.before[1]];
        self.before = now;
        Step { commands, predicted: predicted.map(number), measured: Some(measured), duration_ms: 400 }
    }
}

#[test]
fn unchanged_robot_raises_no_alarm_and_a_weaker_motor_is_named_with_its_beginning() {
    for seed in 0..10 {
        let (law, mut robot) = (law(), Robot::new(seed));
        let mut monitor = Monitor::new(&law);
        for _ in 0..10_000 {
            assert_eq!(monitor.step(&law, &robot.step()), Outcome::Quiet);
        }
        robot.left = 0.95;
        let steps = (1..).find(|_| monitor.step(&law, &robot.step()) != Outcome::Quiet).unwrap_or(0);
        let alarm = monitor.alarm().expect("an alarm");
        assert!(matches!(alarm.alternative, Alternative::Direction(0, _)), "{alarm:?}");
        assert!(steps < 60 && i32::from(alarm.after_steps).abs_diff(steps) <= 10, "{steps} {alarm:?}");
        assert!(monitor.evidence(alarm.alternative) >= law.threshold);
    }
}

#[test]
fn tracker_that_fails_or_jumps_for_a_second_pauses_the_evidence() {
    let (law, mut robot) = (law(), Robot::new(1));
    let mut monitor = Monitor::new(&law);
    for i in 0..5000 {
        let mut step = robot.step();
        let fails = i % 200 < 2;
        if fails && i % 400 < 200 {
            step.measured = None;
        } else if fails {
            let off = I16F16::saturating_from_num(if i % 2 == 0 { 50 } else { -50 });
            step.measured = step.measured.map(|measured| measured.map(|m| m.saturating_add(off)));
        }
        assert_eq!(monitor.step(&law, &step), if fails { Outcome::Paused } else { Outcome::Quiet }, "step {i}");
    }
}

#[test]
fn lasting_absurd_motion_is_an_alarm() {
    let (law, mut robot) = (law(), Robot::new(1));
    let mut monitor = Monitor::new(&law);
    robot.left = -1.0;
    let steps = (1..100).find(|_| matches!(monitor.step(&law, &robot.step()), Outcome::Changed(_)));
    assert!(steps.is_some_and(|steps| steps < 20), "{steps:?}");
}

#[test]
fn missing_evidence_of_an_alternative_that_does_not_exist_is_zero() {
    assert_eq!(Monitor::new(&law()).evidence(Alternative::Direction(200, 2)), 0);
}

prop_compose! {
    fn any_step()(
        commands: [i32; 4], predicted: [i32; 2], measured: Option<[i32; 2]>, duration_ms: u16,
    ) -> Step {
        let number = I16F16::from_bits;
        Step {
            commands: commands.map(number),
            predicted: predicted.map(number),
            measured: measured.map(|m| m.map(number)),
            duration_ms,
        }
    }
}

proptest! {
    /// Overflow would end a test.
    #[test]
    fn no_input_overflows(steps in prop::collection::vec(any_step(), 1..200), extreme: bool) {
        let most = Direction {
            response: Response::Change, forward: [-MOST_FACTOR, MOST_FACTOR], turn: [MOST_FACTOR; 2], grows: true,
            is_opposite: false,
        };
        let directions = [most, Direction { is_opposite: true, ..most }];
        let law = if extreme { Law { directions: &directions, ..law() } } else { law() };
        let mut monitor = Monitor::new(&law);
        for step in &steps {
            monitor.step(&law, &Step { duration_ms: step.duration_ms % 900, ..*step });
        }
    }
}
