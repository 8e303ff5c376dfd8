//! A robot that the monitor watches, from a fixed seed: unchanged at first, then with a weaker left motor.

use mindgap_core::chance::{Generator, normal};
use mindgap_core::fixed::types::I16F16;
use mindgap_core::monitor::{CHANNELS, Monitor, Outcome, Step};
use mindgap_core::rand_core::{Rng, SeedableRng};

use crate::monitor::LAW;
use crate::networks::{FORWARD, TURN};

/// The robot changes after this many steps.
const UNCHANGED_STEPS: u32 = 99_900;
const STEPS: u32 = 100_000;
const SEED: u64 = 5;
/// Standard deviations of forward (cm) and turn (degrees): a fourth, and one.
const NOISE: [I16F16; CHANNELS] = [I16F16::from_bits(1 << 14), I16F16::ONE];

/// Runs a life, and calls `each` with the number of the step, what the monitor made of it, and the monitor.
pub fn live(mut each: impl FnMut(u32, Outcome, &Monitor)) {
    let mut robot = Watched::new();
    for i in 0..STEPS {
        let step = robot.drive();
        let outcome = robot.monitor.step(&LAW, &step);
        each(i, outcome, &robot.monitor);
    }
}

/// The robot and its monitor.
struct Watched {
    generator: Generator,
    commands: [I16F16; 2],
    monitor: Monitor,
    steps: u32,
}

impl Watched {
    /// Returns the robot at the beginning of its life.
    fn new() -> Self {
        let generator = Generator::seed_from_u64(SEED);
        Watched { generator, commands: [I16F16::ZERO; 2], monitor: Monitor::new(&LAW), steps: 0 }
    }

    /// Drives for one step.
    fn drive(&mut self) -> Step {
        let before = self.commands;
        if self.generator.next_u32() >> 31 == 0 {
            let mut command = || I16F16::from_bits((self.generator.next_u32() >> 9) as i32).saturating_sub(I16F16::saturating_from_num(64));
            self.commands = [command(), command()];
        }
        let [left, right] = self.commands;
        let at = |left: I16F16| {
            let commands = [left, right, before[0], before[1]];
            [FORWARD.evaluate(commands).value, TURN.evaluate(commands).value]
        };
        let predicted = at(left);
        let does = if self.steps < UNCHANGED_STEPS { predicted } else { at(left.saturating_sub(left / 8)) };
        self.steps += 1;
        let mut measured = [I16F16::ZERO; CHANNELS];
        for (measured, (does, noise)) in measured.iter_mut().zip(does.into_iter().zip(NOISE)) {
            *measured = normal(does, noise, &mut self.generator);
        }
        let is_lost = self.generator.next_u32() >> 25 == 0;
        let duration_ms = 395 + (self.generator.next_u32() >> 28) as u16;
        let measured = (!is_lost).then_some(measured);
        Step { commands: [left, right, before[0], before[1]], predicted, measured, duration_ms }
    }
}
