use super::*;
use crate::chance::{Generator, normal};
use proptest::prelude::*;
use rand_core::{Rng, SeedableRng};

const NO_FUNCTIONS: [[[i16; CHANNELS]; POINTS]; FUNCTIONS] = [[[0; CHANNELS]; POINTS]; FUNCTIONS];
/// A wheel covers 16 cm in a step at full speed; the track is 12 cm.
const FULL_CM: f64 = 16.0;
const FULL_DEG: f64 = 76.4;
/// Standard deviations of forward and turn, cm and degrees.
const NOISE: [f64; 2] = [0.25, 1.0];

/// A robot whose residuals are white, and whose simulator has no error.
fn law() -> Law<'static> {
    let gains = Gains { precision: 1 << 14, error: 0, tracker: 0, shift: 1 << 14 };
    let factor = |factor: f64, shift: u8, most: i32| Factor {
        factor: (factor * (1 << FACTOR_BITS) as f64) as i16,
        shift,
        most: (f64::from(most) / factor) as i16,
    };
    // One over the noise is 4 and 1, and a residual has 4 bits more than an innovation.
    let whitening = |shift: u8| Whitening {
        scale: factor(1.0, shift, 31 << INNOVATION_BITS),
        gains: [[gains; HELD]; 2],
        by_travel: [1 << 14; TRAVELS],
    };
    Law {
        share_of_command: factor(128.0 / 100.0, 9, (1 << SHARE_BITS) - 1),
        travel: [factor(16.0 / FULL_CM, 8, 1 << TRAVEL_BITS), factor(0.5 * 128.0 / FULL_DEG, 11, 1 << TRAVEL_BITS)],
        straight_travel: 1 << 10,
        step_ms: 400,
        per_step_ms: ((1 << 19) / 400) as i16,
        correction: Correction { functions: &NO_FUNCTIONS, shifts: [0; 2] },
        whitening: [2, 4].map(whitening),
        // Half of 16 cm is 32 standard deviations, 76.4 degrees are 76; the unit is 1/64 of the travel.
        factors: [[2048; RESPONSES], [4864; RESPONSES]],
        sign: 1 << TRAVEL_BITS,
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
    let monitor = Monitor::new(&law());
    for alternative in
        [Alternative::Direction(DIRECTIONS as u8, 0), Alternative::Direction(200, 2), Alternative::Wider(2)]
    {
        assert_eq!(monitor.evidence(alternative), 0);
    }
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
        let law = law();
        let most = Law { factors: [[MOST_FACTOR; RESPONSES]; CHANNELS], sign: MOST_SIGN, ..law };
        let law = if extreme { most } else { law };
        let mut monitor = Monitor::new(&law);
        for step in &steps {
            monitor.step(&law, &Step { duration_ms: step.duration_ms % 900, ..*step });
        }
    }
}
