//! C headers are compiled by a real compiler, and their machine is compared with the core's.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use mindgap_controller_export::{Origin, c};
use mindgap_core::controller::{Controller, Machine, Status, Tuple, When};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};

const CONTROLLERS: usize = 12;
const RUNS_OF_EACH: usize = 200;

/// Reads readings separated by spaces, with `-` for no reading and `/` between runs, and prints the machine after each.
const MAIN: &str = r#"
#include <stdio.h>
#include <stdlib.h>
#include "controller.h"

static void print_state(const controller_machine *machine) {
  controller_motors motors = controller_motors_now(machine);
  printf("%d,%d,%d,%d,%d ", machine->tuple, machine->steps, (int)machine->status, motors.left, motors.right);
}

int main(void) {
  controller_machine machine = {0};
  char word[16];
  print_state(&machine);
  while (scanf("%15s", word) == 1) {
    if (word[0] == '/') {
      machine = (controller_machine){0};
      print_state(&machine);
    } else {
      controller_step(&machine, word[0] != '-', (int16_t)atoi(word));
      print_state(&machine);
    }
  }
  return CONTROLLER_STEP_MS > 0 ? 0 : 1;
}
"#;

fn tuples() -> impl Strategy<Value = Tuple> {
    let when = prop_oneof![Just(When::Larger), Just(When::Smaller)];
    (-100..=100i8, -100..=100i8, when, 0..=20i16).prop_map(|(left, right, when, threshold_cm)| Tuple {
        left,
        right,
        when,
        threshold_cm,
    })
}

fn controllers() -> impl Strategy<Value = Controller> {
    (1..1000u16, 1..40u16, prop::array::uniform6(tuples())).prop_map(|(step_ms, max_steps, tuples)| Controller {
        step_ms,
        max_steps,
        tuples,
    })
}

fn compile(header: &str, folder: &Path) -> PathBuf {
    std::fs::write(folder.join("controller.h"), header).unwrap();
    std::fs::write(folder.join("main.c"), MAIN).unwrap();
    let output = Command::new("cc")
        .args(["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-o", "run", "main.c"])
        .current_dir(folder)
        .output()
        .expect("a C compiler is missing: apt-get install gcc");
    assert!(output.status.success(), "{}\n{header}", String::from_utf8_lossy(&output.stderr));
    folder.join("run")
}

fn state(machine: &Machine) -> String {
    let motors = machine.motors();
    let status = match machine.status() {
        Status::Running => 0,
        Status::Finished => 1,
        Status::TimedOut => 2,
    };
    format!("{},{},{status},{},{} ", machine.tuple(), machine.steps(), motors.left, motors.right)
}

#[test]
fn header_compiles_without_warnings_and_behaves_like_the_core() {
    let mut runner =
        TestRunner::new_with_rng(ProptestConfig::default(), TestRng::deterministic_rng(RngAlgorithm::XorShift));
    for _ in 0..CONTROLLERS {
        let controller = controllers().new_tree(&mut runner).unwrap().current();
        let (mut input, mut expected) = (String::new(), String::new());
        for run in 0..RUNS_OF_EACH {
            let mut machine = Machine::start(&controller);
            if run > 0 {
                input += "/ ";
            }
            expected += &state(&machine);
            let readings = prop::collection::vec(prop::option::weighted(0.8, 0..=20i16), 45);
            for reading_cm in readings.new_tree(&mut runner).unwrap().current() {
                input += &reading_cm.map_or("- ".to_owned(), |reading_cm| format!("{reading_cm} "));
                machine.step(reading_cm);
                expected += &state(&machine);
            }
        }
        let folder = tempfile::tempdir().unwrap();
        let run = compile(&c::header(&controller, &Origin::default()).unwrap(), folder.path());
        let mut child = Command::new(run).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let mut stdin = child.stdin.take().unwrap();
        let feeder = std::thread::spawn(move || stdin.write_all(input.as_bytes()));
        let output = child.wait_with_output().unwrap();
        feeder.join().unwrap().unwrap();
        assert!(output.status.success());
        assert!(String::from_utf8(output.stdout).unwrap() == expected, "differs from the core: {controller:?}");
    }
}

#[test]
fn origin_cannot_end_its_comment() {
    let origin = Origin { simulator: Some("*/ int main(void); \\".to_owned()), seed: Some(7), ..Origin::default() };
    let tuple = Tuple { left: -100, right: 100, when: When::Larger, threshold_cm: 255 };
    let controller = Controller { step_ms: 400, max_steps: u16::MAX, tuples: [tuple; 6] };
    let folder = tempfile::tempdir().unwrap();
    compile(&c::header(&controller, &origin).unwrap(), folder.path());
}
