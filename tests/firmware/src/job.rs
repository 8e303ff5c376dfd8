//! The job that every processor does, from a fixed seed.

use crc::{CRC_32_ISO_HDLC, Crc, Digest};
use mindgap_core::chance::{Generator, happens, normal};
use mindgap_core::controller::{Machine, Motors, Status};
use mindgap_core::fixed::types::I16F16;
use mindgap_core::fixed_network::Output;
use mindgap_core::fixed_point::cos_pi;
use mindgap_core::monitor::{Alternative, DIRECTIONS, SIZES};
use mindgap_core::rand_core::{Rng, SeedableRng};

use crate::controller::CONTROLLER;
use crate::monitored;
use crate::networks::{ECHO_PROBABILITY, ECHO_VALUE, FORWARD, LATERAL, TURN};
use crate::report;

const SEED: u64 = 1;
const SAMPLES: u32 = 3000;
const RUNS: u32 = 40;
/// One half.
pub const HALF: I16F16 = I16F16::from_bits(1 << 15);
static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// The outputs of the simulator for one step.
pub struct Outputs {
    /// Turn in degrees.
    pub turn: Output,
    /// Forward motion in cm.
    pub forward: Output,
    /// Motion to the left in cm.
    pub lateral: Output,
    /// Probability of an echo.
    pub echo_probability: Output,
    /// Mean reading in cm.
    pub echo_value: Output,
}

/// The inputs of all networks for one step.
#[derive(Clone, Copy)]
pub struct Sample {
    /// Left and right command, and those of the previous step.
    pub commands: [I16F16; 4],
    /// Distance in cm and incidence angle in degrees.
    pub sonar: [I16F16; 2],
}

/// Evaluates all five networks. Those of the motion share their scaled inputs, and so do those of the sonar.
pub fn evaluate(sample: &Sample) -> Outputs {
    let motion = TURN.scale(sample.commands);
    let sonar = ECHO_PROBABILITY.scale(sample.sonar);
    Outputs {
        turn: TURN.evaluate_scaled(&motion),
        forward: FORWARD.evaluate_scaled(&motion),
        lateral: LATERAL.evaluate_scaled(&motion),
        echo_probability: ECHO_PROBABILITY.evaluate_scaled(&sonar),
        echo_value: ECHO_VALUE.evaluate_scaled(&sonar),
    }
}

/// Draws a reading in cm, if there is an echo.
pub fn reading_cm(outputs: &Outputs, generator: &mut Generator) -> Option<I16F16> {
    happens(outputs.echo_probability.value, generator).then(|| normal(outputs.echo_value.value, HALF, generator))
}

/// Draws a sample from the trained ranges and slightly beyond.
pub fn sample(generator: &mut Generator) -> Sample {
    let mut between = |from: i32, to: i32| {
        let uniform = I16F16::from_bits((generator.next_u32() >> 16) as i32);
        I16F16::saturating_from_num(from).saturating_add(uniform.saturating_mul(I16F16::saturating_from_num(to - from)))
    };
    Sample { commands: core::array::from_fn(|_| between(-102, 102)), sonar: [between(-2, 260), between(-1, 92)] }
}

/// Does the whole job and reports it, with a checksum over every bit at the end.
pub fn run() {
    let mut checksum = CRC.digest();
    inferences(&mut checksum);
    controller_runs(&mut checksum);
    monitored_life(&mut checksum);
    report!("checksum {}", checksum.finalize());
}

/// Evaluates the networks at many samples.
fn inferences(checksum: &mut Digest<u32>) {
    let mut generator = Generator::seed_from_u64(SEED);
    for i in 0..SAMPLES {
        let a = evaluate(&sample(&mut generator));
        let outputs = [a.turn, a.forward, a.lateral, a.echo_probability, a.echo_value];
        for output in outputs {
            checksum.update(&output.value.to_bits().to_le_bytes());
            checksum.update(&[u8::from(output.clamped)]);
        }
        if i % 300 == 0 {
            let [turn, forward, lateral, probability, value] = outputs.map(|output| output.value.to_bits());
            report!("sample {}: {} {} {} {} {}", i, turn, forward, lateral, probability, value);
        }
    }
}

/// Watches a robot for its life.
fn monitored_life(checksum: &mut Digest<u32>) {
    monitored::live(|i, outcome, monitor| {
        for direction in 0..DIRECTIONS as u8 {
            for size in 0..SIZES as u8 {
                checksum.update(&monitor.evidence(Alternative::Direction(direction, size)).to_le_bytes());
            }
        }
        if i % 9_999 == 0 {
            report!("watched {}: {:?}", i, outcome);
        }
    });
}

/// Runs the controller in front of a wall, with the networks as the robot.
fn controller_runs(checksum: &mut Digest<u32>) {
    let mut generator = Generator::seed_from_u64(SEED + 1);
    for run in 0..RUNS {
        let mut robot = Robot::at(I16F16::saturating_from_num(100 + run * 3));
        let mut machine = Machine::start(&CONTROLLER);
        while machine.status() == Status::Running {
            let reading_cm = robot.step(machine.motors(), &mut generator);
            machine.step(reading_cm);
            checksum.update(&robot.distance_cm.to_bits().to_le_bytes());
            checksum.update(&robot.heading_deg.to_bits().to_le_bytes());
            checksum.update(&[machine.tuple() as u8]);
        }
        let (distance, heading) = (robot.distance_cm.to_bits(), robot.heading_deg.to_bits());
        let (status, steps) = (machine.status(), machine.steps());
        report!("run {}: {:?} after {} steps at {} {}", run, status, steps, distance, heading);
    }
}

/// A robot in front of an infinite wall.
struct Robot {
    distance_cm: I16F16,
    /// Heading relative to the normal of the wall.
    heading_deg: I16F16,
    previous: Motors,
}

impl Robot {
    fn at(distance_cm: I16F16) -> Self {
        Robot { distance_cm, heading_deg: I16F16::ZERO, previous: Motors { left: 0, right: 0 } }
    }

    /// Drives for one step and reads the sensor.
    fn step(&mut self, motors: Motors, generator: &mut Generator) -> Option<I16F16> {
        let commands = [motors.left, motors.right, self.previous.left, self.previous.right].map(I16F16::from);
        let outputs = evaluate(&Sample { commands, sonar: [self.distance_cm, self.heading_deg.saturating_abs()] });
        self.previous = motors;
        let ahead = cos_pi(self.heading_deg / 180);
        self.distance_cm = self.distance_cm.saturating_sub(outputs.forward.value.saturating_mul(ahead));
        self.heading_deg = self.heading_deg.saturating_add(outputs.turn.value);
        reading_cm(&outputs, generator)
    }
}
