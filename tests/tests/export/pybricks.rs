//! Programs for pybricks hubs in a real MicroPython do what the core's machine does.

use std::process::Command;

use mindgap_controller_export::onboard::FAILED_STEPS_TO_STOP;
use mindgap_controller_export::{Origin, pybricks};
use mindgap_core::controller::{Controller, Machine, Status, Tuple, When};
use mindgap_host_sim::chance::{Generator, generator};
use mindgap_tests::command::workspace;
use rand::RngExt;
use serde_json::{Value, json};

const CONTROLLERS: u64 = 2_000;

/// What the sensor answers.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Answer {
    Mm(u16),
    NoEcho,
    Dead,
}

fn controller(rng: &mut Generator) -> Controller {
    let mut tuple = || Tuple {
        left: rng.random_range(-100..=100),
        right: rng.random_range(-100..=100),
        when: if rng.random() { When::Larger } else { When::Smaller },
        threshold_cm: rng.random_range(0..=255),
    };
    let tuples = std::array::from_fn(|_| tuple());
    Controller { step_ms: rng.random_range(1..1_000), max_steps: rng.random_range(1..40), tuples }
}

fn answers(controller: &Controller, rng: &mut Generator) -> Vec<Answer> {
    let mut answer = || match rng.random_range(0..20) {
        0 => Answer::Dead,
        1..4 => Answer::NoEcho,
        4..8 => Answer::Mm(10 * controller.tuples[rng.random_range(0..6)].threshold_cm as u16),
        _ => Answer::Mm(rng.random_range(0..2_000)),
    };
    (0..40).map(|_| answer()).collect()
}

/// The ending and all motor commands with their times, as the core's machine has them.
fn expected(controller: &Controller, answers: &[Answer]) -> Value {
    if answers[0] == Answer::Dead {
        return json!(["no sonar", []]);
    }
    let mut machine = Machine::start();
    let motors = |machine: &Machine| machine.motors(controller);
    let mut events = vec![json!([0, motors(&machine).left, motors(&machine).right])];
    let mut failed_steps = 0;
    for (step, answer) in (1u32..).zip(answers) {
        let tuple = machine.tuple();
        let reading_cm = match answer {
            Answer::Mm(mm) => Some(f32::from(*mm) / 10.0),
            Answer::NoEcho | Answer::Dead => None,
        };
        failed_steps = if *answer == Answer::Dead { failed_steps + 1 } else { 0 };
        let status = machine.step(controller, reading_cm);
        let t_ms = step * u32::from(controller.step_ms);
        let ending = match status {
            Status::Finished => Some("finished"),
            _ if failed_steps == FAILED_STEPS_TO_STOP => Some("sonar dead"),
            Status::TimedOut => Some("timed out"),
            Status::Running => None,
        };
        if let Some(ending) = ending {
            events.push(json!([t_ms, 0, 0]));
            return json!([ending, events]);
        }
        if machine.tuple() != tuple {
            events.push(json!([t_ms, motors(&machine).left, motors(&machine).right]));
        }
    }
    panic!("more steps than answers");
}

#[test]
fn micropython_runs_as_the_core_does() {
    let cases = (0..CONTROLLERS).map(|number| {
        let mut rng = generator(7, &[number]);
        let controller = controller(&mut rng);
        let answers = answers(&controller, &mut rng);
        let readings = answers.iter().map(|answer| match answer {
            Answer::Mm(mm) => json!(mm),
            Answer::NoEcho => json!("none"),
            Answer::Dead => json!("dead"),
        });
        let program = pybricks::program(&controller, &Origin::default()).unwrap();
        let case = json!({"program": program, "readings": readings.collect::<Vec<_>>()});
        (case, expected(&controller, &answers))
    });
    let (cases, expected): (Vec<Value>, Vec<Value>) = cases.unzip();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cases.json");
    std::fs::write(&path, serde_json::to_string(&cases).unwrap()).unwrap();
    let node =
        Command::new("node").arg("run.mjs").arg(&path).current_dir(workspace().join("tests/micropython")).output();
    let output = node.expect("node is missing: tests/run.sh installs it");
    assert!(output.status.success(), "is MicroPython there (npm ci)? {}", String::from_utf8_lossy(&output.stderr));
    let done: Vec<Value> =
        String::from_utf8(output.stdout).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(done.len(), expected.len());
    for (number, (done, expected)) in done.iter().zip(&expected).enumerate() {
        assert_eq!(done, expected, "case {number}");
    }
}
