//! The monitor in C, compiled by a real compiler, gathers the core's evidence to the bit.

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;

use mindgap_controller_export::c_monitor::c_monitor;
use mindgap_controller_export::c_networks::c_networks;
use mindgap_controller_export::tabulated::Tabulated;
use mindgap_core::chance::{Generator, normal};
use mindgap_core::fixed::types::{I6F26, I16F16, I38F26};
use mindgap_core::fixed_network::{FixedNetwork, FixedScaling};
use mindgap_core::folded::PowerSum;
use mindgap_core::heapless::Vec as FixedVec;
use mindgap_core::monitor::{
    Alternative, CHANNELS, Correction, FUNCTIONS, Factor, Gains, HELD, Law, Monitor, NAT_BITS, Outcome, POINTS, Step,
    TRAVELS, Whitening,
};
use mindgap_core::network::Activation;
use mindgap_core::rand_core::{Rng, SeedableRng};

const STEPS: u32 = 20_000;

/// Reads steps, and prints the evidence of all alternatives after each.
const MAIN: &str = r#"
#include <stdio.h>
#include "robot.h"

int main(void) {
  static monitor_t monitor;
  long c[4], forward, turn, duration;
  int begins, measured;
  monitor_start(&monitor);
  while (scanf("%d %ld %ld %ld %ld %d %ld %ld %ld", &begins, c, c + 1, c + 2, c + 3, &measured, &forward, &turn, &duration) == 9) {
    int32_t commands[4] = {(int32_t)c[0], (int32_t)c[1], (int32_t)c[2], (int32_t)c[3]};
    if (begins == 1) {
      monitor_start_run(&monitor);
    }
    int outcome = monitor_step(&monitor, commands, measured == 1, (int32_t)forward, (int32_t)turn, (uint16_t)duration);
    for (int i = 0; i < MONITOR_ALTERNATIVES; i++) {
      printf("%d ", monitor.evidence[i]);
    }
    printf("%d %d %d\n", outcome, monitor.alarm, monitor.after_steps);
  }
  return sizeof(monitor_t) <= 256 ? 0 : 1;
}
"#;

#[test]
fn monitor_in_c_equals_the_core_to_the_bit() {
    let functions = functions();
    let law = law(&functions);
    let networks = networks();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("c_monitor");
    fs::create_dir_all(&folder).expect("a folder");
    compile(&folder, &law, &networks);

    let (input, expected) = life(&law, &networks);
    let has_alarm = |line: &str| line.rsplit(' ').nth(2) == Some("2");
    assert!(expected.lines().any(has_alarm), "there is an alarm");
    let mut child = Command::new(folder.join("run"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut stdin = child.stdin.take().expect("a pipe");
    let writer = thread::spawn(move || std::io::Write::write_all(&mut stdin, input.as_bytes()));
    let output = child.wait_with_output().expect("the program ends");
    writer.join().expect("a thread").expect("a pipe");
    assert!(output.status.success(), "the state has at most 256 bytes");
    let printed = String::from_utf8(output.stdout).expect("text");
    for (step, (printed, expected)) in printed.lines().zip(expected.lines()).enumerate() {
        assert_eq!(printed, expected, "step {step}");
    }
    assert_eq!(printed.lines().count(), expected.lines().count());
}

fn compile(folder: &Path, law: &Law, [forward, turn]: &[FixedNetwork<4>; 2]) {
    let inputs = ["left", "right", "previous_left", "previous_right"];
    let tabulated =
        [Tabulated::new("forward", "Cm.", inputs, forward), Tabulated::new("turn", "Degrees.", inputs, turn)];
    let names = ["a", "b", "c", "d", "e", "f", "g", "h", "i", "j"];
    fs::write(folder.join("robot.h"), c_networks(&tabulated, &c_monitor(law, &names))).expect("a file");
    fs::write(folder.join("main.c"), MAIN).expect("a file");
    let flags = ["-std=c99", "-O1", "-pedantic", "-Wall", "-Wextra", "-Werror", "-fsanitize=undefined"];
    let output = Command::new("cc")
        .args(flags)
        .args(["-fno-sanitize-recover", "-o", "run", "main.c"])
        .current_dir(folder)
        .output()
        .expect("a C compiler is missing: apt-get install gcc");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Returns the steps of a robot that is lost, jumps and changes, and what the core makes of them.
fn life(law: &Law, [forward, turn]: &[FixedNetwork<4>; 2]) -> (String, String) {
    let (mut input, mut expected) = (String::new(), String::new());
    let mut generator = Generator::seed_from_u64(1);
    let mut monitor = Monitor::new(law);
    let mut commands = [I16F16::ZERO; 4];
    for i in 0..STEPS {
        let begins = i % 100 == 0;
        if begins {
            monitor.start_run();
            commands = [I16F16::ZERO; 4];
        }
        let [left, right, ..] = commands;
        commands = [left, right, left, right];
        if generator.next_u32() % 3 == 0 {
            let mut command = || I16F16::from_num(generator.next_u32() % 241) - I16F16::from_num(120);
            (commands[0], commands[1]) = (command(), command());
        }
        let predicted = [forward, turn].map(|network| network.evaluate(commands).value);
        let wide = I16F16::from_num(if i % 4000 > 3900 { 400 } else { 1 });
        let weaker = I16F16::from_num(if i > STEPS / 2 { 0.9 } else { 1.0 });
        let measured = predicted.map(|p| normal(p.saturating_mul(weaker), wide, &mut generator));
        let measured = (generator.next_u32() % 50 > 0).then_some(measured);
        let duration_ms = if generator.next_u32() % 90 == 0 { 900 } else { 390 + (generator.next_u32() % 20) as u16 };
        let step = Step { commands, predicted, measured, duration_ms };
        let [forward_bits, turn_bits] = measured.unwrap_or_default().map(I16F16::to_bits);
        let words = commands.map(|c| c.to_bits().to_string()).join(" ");
        let (begins, is_measured) = (u8::from(begins), u8::from(measured.is_some()));
        let _ = writeln!(input, "{begins} {words} {is_measured} {forward_bits} {turn_bits} {duration_ms}");

        let outcome = match monitor.step(law, &step) {
            Outcome::Quiet => 0,
            Outcome::Paused => 1,
            Outcome::Changed(_) => 2,
        };
        for alternative in Alternative::all() {
            let _ = write!(expected, "{} ", monitor.evidence(alternative));
        }
        let alarm = monitor.alarm();
        let index = alarm
            .and_then(|alarm| Alternative::all().position(|alternative| alternative == alarm.alternative))
            .map_or(-1, |index| index as i32);
        let _ = writeln!(expected, "{outcome} {index} {}", alarm.map_or(0, |alarm| alarm.after_steps));
    }
    (input, expected)
}

/// Returns linear networks of forward, 16 cm at full speed, and turn, 153 degrees on the spot.
fn networks() -> [FixedNetwork<4>; 2] {
    let (low, high) = (I6F26::ONE, 2 * I6F26::ONE);
    let scaling = FixedScaling { gain: 1_374_389_535, shift: 28, offset: I38F26::from_num(1.5), low, high };
    let network = |slopes: [f64; 4], bias: f64, output_shift: u8| FixedNetwork {
        inputs: [scaling; 4],
        sum: PowerSum { bias: I6F26::from_num(bias), slopes: slopes.map(I6F26::from_num), powers: FixedVec::new() },
        output_shift,
        activation: Activation::Linear,
    };
    [network([0.9, 0.9, 0.1, 0.1], -3.0, 4), network([-2.2, 2.2, -0.2, 0.2], 0.0, 6)]
}

fn functions() -> [[[i16; CHANNELS]; POINTS]; FUNCTIONS] {
    let value = |f: usize, p: usize, seed: usize| ((f * 101 + p * seed) % 400) as i16 - 200;
    std::array::from_fn(|f| std::array::from_fn(|p| [3, 11].map(|seed| value(f, p, seed))))
}

fn law(functions: &[[[i16; CHANNELS]; POINTS]; FUNCTIONS]) -> Law<'_> {
    let gains = |n: usize| Gains {
        precision: 16_000 + 300 * n as i16,
        error: 4000 - 400 * n as i16,
        tracker: 7000 + 100 * n as i16,
        shift: 16_384 - 1200 * n as i16,
    };
    let gains = [std::array::from_fn::<_, HELD, _>(gains), std::array::from_fn(|n| gains(HELD - 1 - n))];
    let whitening = |shift: u8| Whitening {
        scale: Factor { factor: 24_414, shift, most: 21_303 },
        gains,
        by_travel: std::array::from_fn::<_, TRAVELS, _>(|t| 17_000 - 700 * t as i16),
    };
    Law {
        share_of_command: Factor { factor: 20_972, shift: 9, most: 12_798 },
        travel: [Factor { factor: 16_384, shift: 8, most: 4096 }, Factor { factor: 27_444, shift: 12, most: 2445 }],
        straight_travel: 752,
        step_ms: 400,
        per_step_ms: 1311,
        correction: Correction { functions, shifts: [1, 2] },
        whitening: [whitening(3), whitening(5)],
        factors: [[2200, 1700], [5300, 900]],
        sign: 1500,
        most_paused_steps: 3,
        threshold: 17 << NAT_BITS,
    }
}
