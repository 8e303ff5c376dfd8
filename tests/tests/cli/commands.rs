//! Each command does its work on small inputs.

use std::io::Read;
use std::process::Stdio;

use mindgap_tests::command::{Sandbox, workspace};
use mindgap_tests::rooms::{SCENE, trained, with_scene};
use serde_json::{Value, json};

#[test]
fn record_writes_a_folder_of_logs() {
    let sandbox = Sandbox::new();
    let output = sandbox.run("record --out logs --runs 3 --steps 12");
    assert_eq!(output, "logs: 3 runs of 12 steps\n");
    for run in ["run-000", "run-001", "run-002"] {
        let text = sandbox.text(&format!("logs/{run}.csv"));
        assert!(text.starts_with("t_ms,left,right,x_cm,y_cm,heading_deg,echo_cm"), "{text}");
        assert_eq!(text.lines().count(), 1 + 13, "header, and one row more than steps");
    }
    assert!(sandbox.text("logs/robot.toml").contains("step_ms = 400"));
    assert_eq!(sandbox.text("logs/scene.toml").matches("[[obstacle]]").count(), 4);
}

#[test]
fn record_uses_the_given_scene_and_effects() {
    let sandbox = Sandbox::new();
    sandbox.write("room.toml", "[arena]\nwidth_cm = 150\nheight_cm = 120\n");
    sandbox.run("record --out plain --runs 2 --steps 10 --scene room.toml");
    sandbox
        .run("record --out weak --runs 2 --steps 10 --scene room.toml --effect drive_scale=0.9 --effect sonar_offset");
    assert_eq!(sandbox.bytes("plain/scene.toml"), sandbox.bytes("weak/scene.toml"));
    assert_ne!(sandbox.bytes("plain/run-000.csv"), sandbox.bytes("weak/run-000.csv"));
}

/// With `-`, standard output holds the JSON and nothing else.
#[test]
fn a_dash_writes_json_to_standard_output() {
    let sandbox = trained();
    sandbox.write("room.toml", SCENE);
    for call in ["evaluate sim.json logs", "crosscheck sim.json logs", "diagnose sim.json logs"] {
        sandbox.run(&format!("{call} --json file.json"));
        let output = sandbox.run(&format!("{call} --json -"));
        assert_eq!(serde_json::from_str::<Value>(&output).expect("JSON and nothing else"), sandbox.json("file.json"));
    }
    assert!(!sandbox.path().join("-").exists());
}

#[test]
fn every_trainer_gives_five_networks_that_evaluate_scores() {
    for trainer in ["", "--trainer paper"] {
        let sandbox = Sandbox::with_logs();
        sandbox.run(&format!("train logs --out sim.json {trainer}"));
        let table = sandbox.run("evaluate sim.json logs --json figures.json");
        for name in ["turn (deg)", "forward (cm)", "lateral (cm)", "echo value (cm)", "Brier"] {
            assert!(table.contains(name), "{table}");
        }
        let figures = sandbox.json("figures.json");
        assert_eq!(figures["schema"], 1);
        let networks = &figures["networks"];
        let has = |network: &str, keys: &[&str]| {
            for key in keys {
                let value = &networks[network][key];
                assert!(value.is_number(), "{network}.{key} = {value}");
            }
        };
        has("turn", &["r2", "mse", "n"]);
        has("forward", &["r2", "mse", "n"]);
        has("lateral", &["r2", "mse", "n"]);
        has("echo_probability", &["r2", "brier", "log_loss", "auc", "n"]);
        has("echo_value", &["r2", "mse", "mae_cm", "n"]);
        let tracked = tracked(&sandbox);
        let steps = tracked.iter().flat_map(|run| run.windows(2)).filter(|pair| pair[0] && pair[1]).count();
        assert_eq!(networks["turn"]["n"], steps, "one sample a step");
        let rows = tracked.iter().flatten().filter(|seen| **seen).count();
        assert_eq!(networks["echo_probability"]["n"], rows, "one sample a row");
    }
}

#[test]
fn networks_of_other_sizes_are_compared_with_the_papers() {
    let sandbox = Sandbox::with_logs();
    sandbox.run("train logs --hidden turn=8 --out sim.json");
    let shown = sandbox.run("evaluate sim.json logs --json sizes.json");
    assert_eq!(shown.matches("turn (deg)").count(), 2, "{shown}");
    let sizes = sandbox.json("sizes.json");
    assert!(sizes["networks"]["turn"]["mse"].is_number() && sizes["table_one"]["turn"]["mse"].is_number());
    assert_ne!(sizes["networks"]["turn"]["mse"], sizes["table_one"]["turn"]["mse"]);
    for wrong in ["turn=7", "turn=0", "turn=80", "eye=4", "turn"] {
        assert_eq!(sandbox.call(&format!("train logs --hidden {wrong} --out other.json")).code, 2, "{wrong}");
    }
}

/// For each row of each run in `logs`, whether the tracker saw the robot.
fn tracked(sandbox: &Sandbox) -> Vec<Vec<bool>> {
    let run = |run: usize| sandbox.text(&format!("logs/run-00{run}.csv"));
    let seen = |line: &str| line.split(',').nth(3).is_some_and(|x_cm| !x_cm.is_empty());
    (0..6).map(|i| run(i).lines().skip(1).map(seen).collect()).collect()
}

#[test]
fn a_reader_may_close_the_pipe_early() {
    let sandbox = trained();
    let mut child = sandbox
        .command("evaluate sim.json logs --json figures.json")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The reader closes the pipe before anything is written.
    drop(child.stdout.take());
    let mut err = String::new();
    child.stderr.take().unwrap().read_to_string(&mut err).unwrap();
    assert_eq!((child.wait().unwrap().code(), err.as_str()), (Some(0), ""));
    assert_eq!(sandbox.json("figures.json")["schema"], 1);
}

#[test]
fn a_controller_is_evolved_simulated_and_exported() {
    let sandbox = with_scene();
    let output = sandbox.run("evolve sim.json --scene scene.toml --start 2 --out controller.toml --max-steps 8");
    assert!(output.starts_with("start 2: ") && output.ends_with("controller written to controller.toml\n"), "{output}");
    let controller = sandbox.text("controller.toml");
    assert_eq!(controller.matches("[[tuple]]").count(), 6);
    for line in ["step_ms = 400", "max_steps = 8", "simulator = \"sim.json\"", "scene = \"scene.toml\"", "start = 2"] {
        assert!(controller.lines().any(|l| l == line), "{line} is missing in\n{controller}");
    }

    let table = sandbox.run("simulate sim.json controller.toml --scene scene.toml --start 2 --runs 4 --json runs.json");
    // A header, the runs, an explanation of "timed out" where it occurs, and the summary.
    assert_eq!(table.lines().count(), 1 + 4 + usize::from(table.contains("\ntimed out: ")) + 1, "{table}");
    let rehearsal = sandbox.json("runs.json");
    assert_eq!(rehearsal["schema"], 1);
    assert!((0.0..=1.0).contains(&rehearsal["success"].as_f64().unwrap()));
    let runs = rehearsal["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 4);
    for run in runs {
        assert!(["finished", "timed_out", "crashed"].contains(&run["ending"].as_str().unwrap()));
        let (path, steps) = (run["path"].as_array().unwrap(), run["steps"].as_u64().unwrap());
        assert_eq!(path.len() as u64, steps + 1, "the start and one point a step");
        assert!((1..=8).contains(&steps));
        assert_eq!(path[0]["x_cm"], 100.0);
    }

    sandbox.run("export controller.toml --format nxc --out program.nxc --left A --sonar 1 --display");
    let program = sandbox.text("program.nxc");
    assert!(program.contains("task main()") && program.contains("// simulator: sim.json"), "{program}");
}

#[test]
fn the_paper_noise_option_changes_simulated_runs() {
    let sandbox = with_scene();
    sandbox.run("evolve sim.json --scene scene.toml --out c.toml --max-steps 20 --paper");
    let ends = |noise: &str| -> Vec<Value> {
        sandbox.run(&format!("simulate sim.json c.toml --scene scene.toml --runs 8 --json runs.json {noise}"));
        sandbox.json("runs.json")["runs"].as_array().unwrap().clone()
    };
    assert_ne!(ends(""), ends("--paper-noise"));
}

#[test]
fn a_usage_error_exits_with_two_and_help_with_zero() {
    let sandbox = Sandbox::new();
    let offset = "import streams a.csv --robot robot.toml --out l --offset-ms nan";
    for wrong in
        ["", "fly", "record", "record --out logs --runs none", "train logs", "record --out l --effect wings", offset]
    {
        assert_eq!(sandbox.call(wrong).code, 2, "mindgap {wrong}");
    }
    for right in ["--help", "--version", "record --help", "simulate --help"] {
        let outcome = sandbox.call(right);
        assert_eq!((outcome.code, outcome.err.as_str()), (0, ""), "mindgap {right}");
        assert!(!outcome.out.is_empty());
    }
    assert!(sandbox.listing().is_empty());
}

#[test]
fn a_simulator_holds_the_first_echo_law_of_its_sonar() {
    let sandbox = trained();
    sandbox.write("room.toml", SCENE);
    sandbox.run("evaluate sim.json logs --json figures.json");
    let models = &sandbox.json("figures.json")["sensor_models"];
    let nats = |model: &str| models[model]["as_logged"].as_f64().unwrap_or_else(|| panic!("{model}: {models}"));
    // Six runs are too few for the two networks to be compared.
    assert!(["beam", "first_echo"].into_iter().all(|model| nats(model) > nats("ideal_ray")), "{models}");
    assert!(nats("networks").is_finite(), "{models}");
    assert!(models["first_echo"]["poses_refitted"].is_null(), "a driven robot's poses are tracked: {models}");

    let controller = workspace().join("tests/tests/golden/controller.toml");
    sandbox.write("go.toml", std::fs::read(controller).expect("a fixed controller"));
    let call = "simulate sim.json go.toml --scene room.toml --runs 20";
    let by_law = sandbox.run(&format!("{call} --sonar first_echo"));
    assert_eq!(by_law, sandbox.run(&format!("{call} --sonar first_echo")));
    assert_ne!(by_law, sandbox.run(call));
    // An effect on the sensor changes the first-echo law, and the beam model without `--sonar`.
    let mut changed = sandbox.json("sim.json");
    let original = changed.clone();
    let added = json!({ "effect": "sonar_offset", "variant": "length", "parameters": { "cm": -20.0 } });
    changed["added"] = json!([added]);
    sandbox.write("sim.json", changed.to_string());
    let later = sandbox.run(&format!("{call} --sonar first_echo"));
    assert_ne!(later, by_law);
    assert_ne!(later, sandbox.run(call));
    let mut older = original;
    older.as_object_mut().expect("a table").remove("first_echo");
    sandbox.write("sim.json", older.to_string());
    sandbox.run(call);
    let refused = sandbox.refused(&format!("{call} --sonar first_echo"));
    assert!(refused.contains("no first-echo law"), "{refused}");
}
