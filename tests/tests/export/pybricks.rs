//! Programs for Pybricks hubs, run in a real MicroPython, behave like the core's machine and networks.

use std::path::Path;
use std::process::Command;
use std::sync::Arc;

use mindgap_controller_export::collect::Commands;
use mindgap_controller_export::pybricks_networks::{PybricksNetwork, pybricks_networks};
use mindgap_controller_export::{Origin, pybricks, pybricks_collect};
use mindgap_core::folded::FoldedNetwork;
use mindgap_core::network::Network;
use mindgap_foundations::random::{Generator, generator};
use mindgap_import::brick_log::{BrickLog, is_brick_log};
use mindgap_tests::command::workspace;
use mindgap_tests::controllers::at_its_limits;
use mindgap_tests::plausible_networks::{PlausibleNetworks, plausible_networks};
use rand::RngExt;
use serde_json::{Value, json};

use super::scripted::{Answer, answers, controller, expected};

const CONTROLLERS: u64 = 2_000;
/// Hubs, and the distance in mm that means that there was no echo.
const KITS: [(&str, u16); 3] = [("nxt", 2_550), ("ev3", 2_550), ("spike", 2_000)];
const HEADER: &str = "t_ms,left,right,rot_left_deg,rot_right_deg,battery_mv,echo_cm";
/// Number of seeds of networks, and of inputs tried with each network.
const SEEDS: u64 = 4;
const SAMPLES: usize = 500;
const MOTION: [&str; 4] = ["left", "right", "previous_left", "previous_right"];
const SONAR: [&str; 2] = ["distance_cm", "incidence_deg"];

#[test]
fn program_in_micropython_behaves_like_the_core() {
    let cases = (0..CONTROLLERS).map(|number| {
        let mut rng = generator(7, &[number]);
        let controller = controller(1, &mut rng);
        let (kit, no_echo_mm) = KITS[number as usize % KITS.len()];
        let mut answers = answers(&controller, 1, &mut rng);
        for answer in &mut answers {
            if matches!(answer, Answer::Mm(mm) if *mm >= no_echo_mm) {
                *answer = Answer::NoEcho;
            }
        }
        let program = pybricks::program(&controller, &Origin::default()).unwrap();
        let (ending, commands) = expected(&controller, &answers);
        let commands: Vec<_> = commands.iter().map(|(t_ms, m)| json!([t_ms, m.left, m.right])).collect();
        (case(kit, &program, &answers), json!([[ending.text()], commands]))
    });
    let (cases, expected): (Vec<Value>, Vec<Value>) = cases.unzip();
    let results = in_micropython(&cases);
    assert_eq!(results.len(), expected.len());
    for (number, (result, expected)) in results.iter().zip(&expected).enumerate() {
        assert_eq!(result, expected, "case {number}");
    }
}

#[test]
fn missing_device_ends_in_a_message() {
    let controller = at_its_limits();
    let commands = Commands::Random { steps: 5, near_cm: 40, seed: 1 };
    let programs = [
        pybricks::program(&controller, &Origin::default()).unwrap(),
        pybricks_collect::program(400, &commands).unwrap(),
    ];
    let devices = ["left motor", "right motor", "sonar"];
    let (mut cases, mut messages) = (Vec::new(), Vec::new());
    for (kit, _) in KITS {
        let ports = if kit == "spike" { ["A", "B", "C"] } else { ["B", "C", "S4"] };
        for (device, port) in devices.iter().zip(ports) {
            for program in &programs {
                let mut case = case(kit, program, &[Answer::Mm(500)]);
                case["missing"] = json!([format!("Port.{port}")]);
                cases.push(case);
                messages.push(json!([[format!("no {device} on Port.{port}")], []]));
            }
        }
    }
    assert_eq!(in_micropython(&cases), messages);
}

#[test]
fn collecting_program_prints_a_log_and_turns_away_from_walls() {
    let near = Answer::Mm(200);
    let far = Answer::Mm(1_500);
    let commands = Commands::Random { steps: 60, near_cm: 40, seed: 3 };
    let random = pybricks_collect::program(400, &commands).unwrap();
    let script = pybricks_collect::program(250, &Commands::Script(vec![[10, -20], [30, 40]])).unwrap();
    let drive: Vec<Answer> = (0..61).map(|step| if step % 10 < 4 { near } else { far }).collect();
    let broken = [far, Answer::Dead, far, Answer::Dead, Answer::Dead];
    for (kit, _) in KITS {
        let cases = [case(kit, &random, &drive), case(kit, &script, &[far, Answer::NoEcho, far])];
        let results = in_micropython(&cases);
        let (driven, scripted) = (&results[0], &results[1]);
        assert_eq!(
            scripted,
            &json!([
                [
                    HEADER,
                    "0,10,-20,0,0,7654,150.0",
                    "250,30,40,250,250,7654,",
                    "500,0,0,500,500,7654,150.0",
                    "finished"
                ],
                [[0, 10, -20], [250, 30, 40], [500, 0, 0]]
            ])
        );
        // The printed log is one that the reader of logs accepts, and its commands are those of the motors.
        let lines: Vec<&str> = driven[0].as_array().unwrap().iter().map(|line| line.as_str().unwrap()).collect();
        let text = format!("Running\n{}\n", lines.join("\n"));
        assert!(is_brick_log(&text));
        let log = BrickLog::parse(Path::new("run.txt"), &text, &Arc::default(), |warning| panic!("{warning}")).unwrap();
        assert_eq!((log.run.rows.len(), log.is_truncated, *lines.last().unwrap()), (61, false, "finished"));
        for (row, set) in log.run.rows.iter().zip(driven[1].as_array().unwrap()) {
            assert_eq!(json!([row.t_ms as u32, row.left as i32, row.right as i32]), *set);
            if row.echo_cm == Some(20.0) && [row.left, row.right] != [0.0, 0.0] {
                assert_eq!(row.left, -row.right, "{kit}: drives on at {} ms", row.t_ms);
            }
        }
        let stopped = &in_micropython(&[case(kit, &random, &broken)])[0];
        assert_eq!(stopped[0].as_array().unwrap().last(), Some(&json!("sonar dead")));
        assert_eq!(stopped[1].as_array().unwrap().last(), Some(&json!([1600, 0, 0])));
    }
}

/// Returns a case for `run.mjs`.
fn case(kit: &str, program: &str, answers: &[Answer]) -> Value {
    let readings = answers.iter().map(|answer| match answer {
        Answer::Mm(mm) => json!(mm),
        Answer::NoEcho => json!("none"),
        Answer::Dead => json!("dead"),
    });
    json!({"program": program, "kit": kit, "readings": readings.collect::<Vec<_>>()})
}

#[test]
fn networks_in_micropython_agree_with_the_core() {
    for seed in 0..SEEDS {
        let PlausibleNetworks { turn, forward, lateral, echo_probability, echo_value } = plausible_networks(seed);
        let networks = [
            PybricksNetwork::new("turn", "Degrees.", MOTION, &turn),
            PybricksNetwork::new("forward", "Cm.", MOTION, &forward),
            PybricksNetwork::new("lateral", "Cm.", MOTION, &lateral),
            PybricksNetwork::new("echo_probability", "0 to 1.", SONAR, &echo_probability),
            PybricksNetwork::new("echo_value", "Cm.", SONAR, &echo_value),
        ];
        let rng = &mut generator(seed, &[78]);
        let commands: Vec<[f32; 4]> = (0..SAMPLES).map(|_| inputs([(-100.0, 100.0); 4], rng)).collect();
        let facing: Vec<[f32; 2]> = (0..SAMPLES).map(|_| inputs([(0.0, 255.0), (0.0, 90.0)], rng)).collect();
        let case = json!({
            "program": pybricks_networks(&networks),
            "calls": {"turn": commands, "forward": commands, "lateral": commands, "echo_probability": facing,
                      "echo_value": facing},
        });
        let results = in_micropython(&[case]);
        let largest_error = |name: &str, core: Vec<f32>| {
            let outputs = results[0][name].as_array().expect("one output per sample");
            assert_eq!(outputs.len(), core.len());
            let errors =
                outputs.iter().zip(core).map(|(output, core)| (output.as_f64().unwrap() - f64::from(core)).abs());
            errors.fold(0.0, f64::max)
        };
        let core = |network: &Network<f32, 4>| {
            let folded = FoldedNetwork::<f32, 4>::fold(network);
            commands.iter().map(|inputs| folded.evaluate(*inputs)).collect()
        };
        let core_sonar = |network: &Network<f32, 2>| {
            let folded = FoldedNetwork::<f32, 2>::fold(network);
            facing.iter().map(|inputs| folded.evaluate(*inputs)).collect()
        };
        let motion = [("turn", &turn), ("forward", &forward), ("lateral", &lateral)];
        for (name, network) in motion {
            let error = largest_error(name, core(network));
            assert!(error < 2e-3, "{name} of seed {seed}: {error}");
        }
        for (name, network) in [("echo_probability", &echo_probability), ("echo_value", &echo_value)] {
            let error = largest_error(name, core_sonar(network));
            assert!(error < 1e-2, "{name} of seed {seed}: {error}");
        }
    }
}

/// Draws inputs from slightly more than the trained range.
fn inputs<const N: usize>(ranges: [(f32, f32); N], rng: &mut Generator) -> [f32; N] {
    ranges.map(|(low, high)| rng.random_range(1.1 * low - 1.0..1.1 * high))
}

/// Returns the result of each case in MicroPython.
fn in_micropython(cases: &[Value]) -> Vec<Value> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cases.json");
    std::fs::write(&path, serde_json::to_string(cases).unwrap()).unwrap();
    let node =
        Command::new("node").arg("run.mjs").arg(&path).current_dir(workspace().join("tests/micropython")).output();
    let output = node.expect("node is missing: tests/run.sh installs it");
    assert!(output.status.success(), "is MicroPython there (npm ci)? {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}
