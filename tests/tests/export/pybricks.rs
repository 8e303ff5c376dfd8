//! Programs for pybricks hubs in a real MicroPython do what the core's machine and networks do.

use std::process::Command;

use mindgap_controller_export::pybricks_networks::{PybricksNetwork, pybricks_networks};
use mindgap_controller_export::{Origin, pybricks};
use mindgap_core::folded::FoldedNetwork;
use mindgap_core::network::Network;
use mindgap_foundations::chance::{Generator, generator};
use mindgap_tests::command::workspace;
use mindgap_tests::plausible_networks::{PlausibleNetworks, plausible_networks};
use rand::RngExt;
use serde_json::{Value, json};

use super::scripted::{Answer, answers, controller, expected};

const CONTROLLERS: u64 = 2_000;
/// Seeds of networks, and inputs tried with each network.
const SEEDS: u64 = 4;
const SAMPLES: usize = 500;
const MOTION: [&str; 4] = ["left", "right", "previous_left", "previous_right"];
const SONAR: [&str; 2] = ["distance_cm", "incidence_deg"];

#[test]
fn micropython_runs_as_the_core_does() {
    let cases = (0..CONTROLLERS).map(|number| {
        let mut rng = generator(7, &[number]);
        let controller = controller(1, &mut rng);
        let answers = answers(&controller, 1, &mut rng);
        let readings = answers.iter().map(|answer| match answer {
            Answer::Mm(mm) => json!(mm),
            Answer::NoEcho => json!("none"),
            Answer::Dead => json!("dead"),
        });
        let program = pybricks::program(&controller, &Origin::default()).unwrap();
        let case = json!({"program": program, "readings": readings.collect::<Vec<_>>()});
        let (ending, commands) = expected(&controller, &answers);
        let commands: Vec<_> = commands.iter().map(|(t_ms, m)| json!([t_ms, m.left, m.right])).collect();
        (case, json!([ending.text(), commands]))
    });
    let (cases, expected): (Vec<Value>, Vec<Value>) = cases.unzip();
    let done = in_micropython(&cases);
    assert_eq!(done.len(), expected.len());
    for (number, (done, expected)) in done.iter().zip(&expected).enumerate() {
        assert_eq!(done, expected, "case {number}");
    }
}

#[test]
fn networks_in_micropython_answer_as_the_core() {
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
        let faces: Vec<[f32; 2]> = (0..SAMPLES).map(|_| inputs([(0.0, 255.0), (0.0, 90.0)], rng)).collect();
        let case = json!({
            "program": pybricks_networks(&networks),
            "calls": {"turn": commands, "forward": commands, "lateral": commands, "echo_probability": faces,
                      "echo_value": faces},
        });
        let done = in_micropython(&[case]);
        let off = |name: &str, core: Vec<f32>| {
            let answers = done[0][name].as_array().expect("an answer a sample");
            assert_eq!(answers.len(), core.len());
            let off = answers.iter().zip(core).map(|(answer, core)| (answer.as_f64().unwrap() - f64::from(core)).abs());
            off.fold(0.0, f64::max)
        };
        let core = |network: &Network<f32, 4>| {
            let folded = FoldedNetwork::<f32, 4>::fold(network);
            commands.iter().map(|inputs| folded.evaluate(*inputs)).collect()
        };
        let core_of_sonar = |network: &Network<f32, 2>| {
            let folded = FoldedNetwork::<f32, 2>::fold(network);
            faces.iter().map(|inputs| folded.evaluate(*inputs)).collect()
        };
        let motion = [("turn", &turn), ("forward", &forward), ("lateral", &lateral)];
        for (name, network) in motion {
            let off = off(name, core(network));
            assert!(off < 2e-3, "{name} of seed {seed}: {off}");
        }
        for (name, network) in [("echo_probability", &echo_probability), ("echo_value", &echo_value)] {
            let off = off(name, core_of_sonar(network));
            assert!(off < 1e-2, "{name} of seed {seed}: {off}");
        }
    }
}

/// Inputs from a little beyond the range that was trained.
fn inputs<const N: usize>(ranges: [(f32, f32); N], rng: &mut Generator) -> [f32; N] {
    ranges.map(|(low, high)| rng.random_range(1.1 * low - 1.0..1.1 * high))
}

/// What MicroPython says of each case.
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
