//! `mindgap crosscheck` and the export of networks: fixed point on a board against floating point on a PC.

use std::sync::LazyLock;

use mindgap_tests::command::Sandbox;
use mindgap_tests::nbc::compile;
use mindgap_tests::rooms::with_forty_runs;
use serde_json::{Value, json};

/// Returns a folder with a simulator and held-out logs.
fn sandbox() -> Sandbox {
    static MADE: LazyLock<Sandbox> = LazyLock::new(|| {
        let sandbox = with_forty_runs();
        sandbox.run("record --out held-out --runs 5 --steps 30 --seed 2");
        sandbox
    });
    MADE.copy()
}

/// Returns the same folder with a changed simulator.
fn sandbox_with(change: impl FnOnce(&mut Value)) -> Sandbox {
    let sandbox = sandbox();
    let mut simulator = sandbox.json("sim.json");
    change(&mut simulator);
    sandbox.write("sim.json", simulator.to_string());
    sandbox
}

const NETWORKS: [&str; 5] = ["turn", "forward", "lateral", "echo_probability", "echo_value"];

#[test]
fn fixed_point_networks_agree_with_floating_point() {
    let sandbox = sandbox();
    let table = sandbox.run("crosscheck sim.json held-out --json found.json");
    assert!(table.lines().count() < 24 && table.lines().all(|line| line.len() <= 80), "{table}");
    let found = sandbox.json("found.json");
    assert_eq!(found["schema"], 2);
    // Limits in degrees, cm, cm, 1 and cm.
    for (network, limit) in NETWORKS.into_iter().zip([0.1, 0.05, 0.05, 0.002, 0.2]) {
        let check = &found["networks"][network];
        for over in ["samples", "grid"] {
            let differences = &check[over];
            let (worst, mean) = (differences["worst"].as_f64().unwrap(), differences["mean"].as_f64().unwrap());
            assert!(worst <= limit, "{network} over {over}: {differences}");
            assert!(0.0 < mean && mean < worst, "{network} over {over}: {differences}");
        }
        assert_eq!(check["grid"]["n"], 390_625);
        assert_eq!(check["grid"]["clamped"], 0, "the grid lies within the trained range");
    }
    let runs = &found["runs"];
    assert_eq!(runs["n"], 1000);
    let (steps, same) = (runs["steps"].as_u64().unwrap(), runs["same_decisions"].as_u64().unwrap());
    assert!(steps > 10_000 && same as f64 / steps as f64 >= 0.999, "{runs}");
}

#[test]
fn every_sample_is_compared() {
    let sandbox = sandbox();
    sandbox.run("crosscheck sim.json held-out --runs 1 --json found.json");
    sandbox.run("evaluate sim.json held-out --json figures.json");
    let (found, figures) = (sandbox.json("found.json"), sandbox.json("figures.json"));
    for network in ["turn", "forward", "lateral", "echo_probability"] {
        assert_eq!(found["networks"][network]["samples"]["n"], figures["networks"][network]["n"], "{network}");
    }
}

#[test]
fn only_the_seed_decides_the_result() {
    let sandbox = sandbox();
    let found = |threads: usize, seed: u64| {
        let call = format!("crosscheck sim.json held-out --runs 50 --seed {seed} --json found.json");
        assert_eq!(sandbox.call_on_threads(threads, &call).code, 0);
        sandbox.text("found.json")
    };
    assert_eq!(found(1, 1), found(2, 1));
    assert_ne!(found(1, 1), found(1, 2));
}

#[test]
fn runs_use_the_given_controller() {
    let sandbox = sandbox();
    let tuple = "[[tuple]]\nleft = 30\nright = 30\nwhen = \"larger\"\nthreshold_cm = 255\n";
    sandbox.write("c.toml", format!("step_ms = 400\nmax_steps = 2\n{}", tuple.repeat(6)));
    sandbox.run("crosscheck sim.json held-out --runs 100 --controller c.toml --json found.json");
    let steps = sandbox.json("found.json")["runs"]["steps"].as_u64().unwrap();
    assert!((100..=200).contains(&steps), "{steps} steps of 100 runs of 2 at most");
}

#[test]
fn a_difference_in_arithmetic_is_found() {
    // Two terms that cancel, so large that their difference in single precision is tenths of a centimetre.
    let sandbox = sandbox_with(|simulator| {
        let units = simulator["echo_value"]["network"]["product"].as_array_mut().unwrap();
        units.extend([3e6, -3e6].map(|output| json!({ "exponents": [0.3, 0.2], "output": output })));
    });
    let table = sandbox.run("crosscheck sim.json held-out --json found.json");
    let found = sandbox.json("found.json");
    let worst = |network: &str| found["networks"][network]["grid"]["worst"].as_f64().unwrap();
    assert!(worst("echo_value") > 0.1, "{table}");
    let untouched = self::sandbox();
    untouched.run("crosscheck sim.json held-out --json found.json");
    let untouched = untouched.json("found.json");
    assert_eq!(found["networks"]["forward"], untouched["networks"]["forward"], "{table}");
    assert!(untouched["networks"]["echo_value"]["grid"]["worst"].as_f64().unwrap() < 0.01, "{untouched}");
    let runs = &found["runs"];
    let divergence = &runs["first_divergence"];
    assert!(
        runs["diverged"].as_u64().unwrap() > 0 && runs["same_decisions"].as_u64() < runs["steps"].as_u64(),
        "{table}"
    );
    assert_ne!(divergence["float"]["tuple"], divergence["fixed"]["tuple"], "{divergence}");
    assert!(
        table.contains(&format!("the first is run {}, at step {}:", divergence["run"], divergence["step"])),
        "{table}"
    );
}

#[test]
fn inputs_outside_the_trained_range_are_counted() {
    let sandbox = sandbox();
    // Faster than any command in the training logs.
    sandbox.edit_cells("held-out/run-000.csv", |cells| cells[1] = "100");
    let table = sandbox.run("crosscheck sim.json held-out --runs 1 --json found.json");
    let clamped = &sandbox.json("found.json")["networks"]["turn"]["samples"]["clamped"];
    assert!(clamped.as_u64().unwrap() > 10, "{clamped}");
    assert!(table.contains(&format!("turn (deg): {clamped} of ")), "{table}");
}

#[test]
fn logs_without_a_place_to_start_are_refused() {
    let sandbox = sandbox();
    for run in 0..5 {
        sandbox.edit_cells(&format!("held-out/run-00{run}.csv"), |cells| cells[3..6].fill(""));
    }
    let problem = "sim.json: the robot does not fit at any pose in the logs, so no run can start";
    assert_eq!(sandbox.refused("crosscheck sim.json held-out --json found.json"), problem);
}

#[test]
fn a_network_that_cannot_be_represented_is_refused() {
    let wild = sandbox_with(|s| s["forward"]["network"]["product"][2]["exponents"][1] = json!(40.5));
    let problem = "sim.json: the forward network cannot be represented in fixed point: \
                   product unit 3: exponent of input 2 = 40.5 does not fit Q6.26 (-32..32)";
    assert_eq!(wild.refused("crosscheck sim.json held-out --json found.json"), problem);
    assert_eq!(wild.refused("export sim.json --format rust --out networks.rs"), problem);

    let missing = sandbox_with(|s| s["turn"] = Value::Null);
    let problem = "sim.json: the simulator has no turn network: it is not there";
    assert_eq!(missing.refused("crosscheck sim.json held-out --json found.json"), problem);
}

#[test]
fn networks_are_exported_as_source_code() {
    let sandbox = sandbox();
    assert_eq!(sandbox.run("export sim.json --format rust --out networks.rs"), "networks.rs written\n");
    let source = sandbox.text("networks.rs");
    for definition in ["TURN: FixedNetwork<4, 2>", "ECHO_VALUE: FixedNetwork<2, "] {
        assert!(source.contains(&format!("pub static {definition}")), "{source}");
    }
    let said = sandbox.run("export sim.json --format nxc --out networks.nxc");
    assert!(said.starts_with("networks.nxc written\nprogram ") && said.contains("\nEchoValue "), "{said}");
    compile(&format!("{} task main() {{ NumOut(0, LCD_LINE1, EchoValue(1, 2)); }}", sandbox.text("networks.nxc")));
    for (format, file, definition) in [
        ("c", "networks.h", "static inline int32_t network_echo_value(int32_t distance_cm, int32_t incidence_deg) {"),
        ("arduino", "networks.h", "static inline int32_t network_turn("),
        ("pybricks", "networks.py", "def echo_value(distance_cm, incidence_deg):"),
    ] {
        sandbox.run(&format!("export sim.json --format {format} --out {file}"));
        assert!(sandbox.text(file).contains(definition), "{}", sandbox.text(file));
    }
    let problem = "sim.json: contains networks, which the formats rxe, nxc-collect and pybricks-collect do not support";
    assert_eq!(sandbox.refused("export sim.json --format rxe --out networks.rxe"), problem);
}
