//! Networks as NXC: compiled by the real compiler and run on the brick in software they answer the core's bits.

use fixed::types::I16F16;
use mindgap_controller_export::brick::{self, Event, EventKind, Program, Report, RunConfig, ScriptedWorld};
use mindgap_controller_export::nxc_networks::{budget, nxc_networks};
use mindgap_controller_export::tabulated::Tabulated;
use mindgap_core::fixed_network::FixedNetwork;
use mindgap_core::network::Network;
use mindgap_foundations::chance::generator;
use mindgap_models::simulator::fixed_point::Quantised;
use mindgap_tests::nbc::compile;
use mindgap_tests::plausible_networks::{PlausibleNetworks, plausible_networks};
use rand::RngExt;

/// Inputs tried with each network.
const SAMPLES: usize = 40;
/// Seeds of networks.
const SEEDS: u64 = 4;

fn quantised<const N: usize>(network: &Network<f32, N>) -> FixedNetwork<N> {
    Quantised::new(network).expect("a network of plausible weights").network
}

fn number(text: &str) -> i32 {
    text.parse().unwrap_or_else(|_| panic!("{text:?} is no number"))
}

/// What a program shows, number by number, and what it took.
fn shown(source: &str) -> (Vec<i32>, Report) {
    let setup = RunConfig { run_ms: 600_000, ..RunConfig::default() };
    let program = Program::load(&compile(source)).expect("what the compiler made");
    let report = brick::run(&program, &mut ScriptedWorld::default(), &setup);
    let text = |Event { kind, .. }: &Event| match kind {
        EventKind::Text { text, .. } => Some(number(text)),
        _ => None,
    };
    (report.events.iter().filter_map(text).collect(), report)
}

/// Samples from a little beyond the range that was trained, some of them at its ends.
fn samples<const N: usize>(range: [(f64, f64); N], seed: u64) -> Vec<[I16F16; N]> {
    let rng = &mut generator(seed, &[77]);
    let mut input = |(low, high): (f64, f64)| {
        let beyond = 0.1 * (high - low);
        I16F16::from_num(match rng.random_range(0..8) {
            0 => low,
            1 => high,
            _ => rng.random_range(low - beyond..high + beyond),
        })
    };
    (0..SAMPLES).map(|_| range.map(&mut input)).collect()
}

/// Calls of a function at samples, each shown.
fn calls<const N: usize>(name: &str, samples: &[[I16F16; N]]) -> String {
    let call = |sample: &[I16F16; N]| {
        let arguments: Vec<String> = sample.iter().map(|x| x.to_bits().to_string()).collect();
        format!("  NumOut(0, LCD_LINE1, {name}({}));\n", arguments.join(", "))
    };
    samples.iter().map(call).collect()
}

const COMMANDS: [(f64, f64); 4] = [(-100.0, 100.0); 4];
const SONAR: [(f64, f64); 2] = [(0.0, 255.0), (0.0, 90.0)];

#[test]
fn networks_on_the_brick_answer_the_cores_bits() {
    for seed in 0..SEEDS {
        let PlausibleNetworks { turn, forward, lateral, echo_probability, echo_value } = plausible_networks(seed);
        let motion = [quantised(&turn), quantised(&forward), quantised(&lateral)];
        let sonar = [quantised(&echo_probability), quantised(&echo_value)];
        let drives = ["left", "right", "previous_left", "previous_right"];
        let faces = ["distance", "incidence"];
        let networks = [
            Tabulated::new("Turn", "Degrees.", drives, &motion[0]),
            Tabulated::new("Forward", "Cm.", drives, &motion[1]),
            Tabulated::new("Lateral", "Cm.", drives, &motion[2]),
            Tabulated::new("EchoProbability", "0 to 1.", faces, &sonar[0]),
            Tabulated::new("EchoValue", "Cm.", faces, &sonar[1]),
        ];
        let source = nxc_networks(&networks);
        let (commands, facing) = (samples(COMMANDS, seed), samples(SONAR, seed));
        let moved = ["Turn", "Forward", "Lateral"].map(|name| calls(name, &commands));
        let heard = ["EchoProbability", "EchoValue"].map(|name| calls(name, &facing));
        let body = [moved.concat(), heard.concat()].concat();
        let (answers, report) = shown(&format!("{source}\ntask main()\n{{\n{body}}}\n"));
        let motions = motion.iter().flat_map(|n| commands.iter().map(|x| n.evaluate(*x).value.to_bits()));
        let sonars = sonar.iter().flat_map(|n| facing.iter().map(|x| n.evaluate(*x).value.to_bits()));
        let expected: Vec<i32> = motions.chain(sonars).collect();
        assert_eq!(answers.len(), expected.len(), "{:?}", report.end);
        for (place, (answer, expected)) in answers.iter().zip(expected).enumerate() {
            assert_eq!(*answer, expected, "seed {seed}, answer {place}");
        }
        let planned_ms: usize = budget(&networks).answer_ms.iter().map(|(_, ms)| ms * SAMPLES).sum();
        assert!(report.instructions < 80 * planned_ms as u64, "{} instructions", report.instructions);
    }
}

#[test]
fn a_program_with_all_networks_keeps_its_budget() {
    let PlausibleNetworks { turn, echo_value, .. } = plausible_networks(5);
    let drives = ["left", "right", "previous_left", "previous_right"];
    let networks = [
        Tabulated::new("Turn", "Degrees.", drives, &quantised(&turn)),
        Tabulated::new("EchoValue", "Cm.", ["distance", "incidence"], &quantised(&echo_value)),
    ];
    let budget = budget(&networks);
    let source = nxc_networks(&networks);
    let body = "NumOut(0, LCD_LINE1, Turn(1, 2, 3, 4)); NumOut(0, LCD_LINE1, EchoValue(1, 2));";
    let program = compile(&format!("{source} task main() {{ {body} }}"));
    assert!(program.len() <= budget.program_bytes, "{} bytes, planned {}", program.len(), budget.program_bytes);
    let report =
        brick::run(&Program::load(&program).expect("a program"), &mut ScriptedWorld::default(), &RunConfig::default());
    assert!(report.pool_bytes as usize <= budget.memory_bytes, "{} of {}", report.pool_bytes, budget.memory_bytes);
    for (name, arguments) in [("Turn", "1, 2, 3, 4"), ("EchoValue", "6553600, 1966080")] {
        let (_, report) = shown(&format!("{source} task main() {{ NumOut(0, LCD_LINE1, {name}({arguments})); }}"));
        let (_, ms) = budget.answer_ms.iter().find(|(network, _)| *network == name).expect("one of them");
        assert!((40 * ms..80 * ms).contains(&(report.instructions as usize)), "{name} {ms}: {}", report.instructions);
    }
}
