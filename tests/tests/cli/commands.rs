//! Each command does what it says, on small inputs.

use std::io::Read;
use std::process::Stdio;

use mindgap_tests::command::{Workshop, workspace};
use mindgap_tests::rooms::{SCENE, trained, with_scene};
use serde_json::{Value, json};

#[test]
fn record_writes_a_folder_of_logs() {
    let workshop = Workshop::new();
    let told = workshop.done("record --out logs --runs 3 --steps 12");
    assert_eq!(told, "logs: 3 runs of 12 steps\n");
    for run in ["run-000", "run-001", "run-002"] {
        let text = workshop.text(&format!("logs/{run}.csv"));
        assert!(text.starts_with("t_ms,left,right,x_cm,y_cm,heading_deg,echo_cm"), "{text}");
        assert_eq!(text.lines().count(), 1 + 13, "header, and one row more than steps");
    }
    assert!(workshop.text("logs/robot.toml").contains("step_ms = 400"));
    assert_eq!(workshop.text("logs/scene.toml").matches("[[obstacle]]").count(), 4);
}

#[test]
fn record_drives_in_a_room_of_the_users_and_with_effects() {
    let workshop = Workshop::new();
    workshop.write("room.toml", "[arena]\nwidth_cm = 150\nheight_cm = 120\n");
    workshop.done("record --out plain --runs 2 --steps 10 --scene room.toml");
    workshop
        .done("record --out weak --runs 2 --steps 10 --scene room.toml --effect drive_scale=0.9 --effect sonar_offset");
    assert_eq!(workshop.bytes("plain/scene.toml"), workshop.bytes("weak/scene.toml"));
    assert_ne!(workshop.bytes("plain/run-000.csv"), workshop.bytes("weak/run-000.csv"));
}

/// `-` is standard output, on which nothing else stands then.
#[test]
fn json_goes_to_standard_output_too() {
    let workshop = trained();
    workshop.write("room.toml", SCENE);
    for call in ["evaluate sim.json logs", "crosscheck sim.json logs", "diagnose sim.json logs"] {
        workshop.done(&format!("{call} --json file.json"));
        let told = workshop.done(&format!("{call} --json -"));
        assert_eq!(serde_json::from_str::<Value>(&told).expect("JSON and nothing else"), workshop.json("file.json"));
    }
    assert!(!workshop.path().join("-").exists());
}

#[test]
fn every_trainer_gives_five_networks_that_evaluate_judges() {
    for trainer in ["", "--trainer paper"] {
        let workshop = Workshop::with_logs();
        workshop.done(&format!("train logs --out sim.json {trainer}"));
        let table = workshop.done("evaluate sim.json logs --json figures.json");
        for name in ["turn (deg)", "forward (cm)", "lateral (cm)", "echo value (cm)", "Brier"] {
            assert!(table.contains(name), "{table}");
        }
        let figures = workshop.json("figures.json");
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
        let tracked = tracked(&workshop);
        let steps = tracked.iter().flat_map(|run| run.windows(2)).filter(|pair| pair[0] && pair[1]).count();
        assert_eq!(networks["turn"]["n"], steps, "one sample a step");
        let rows = tracked.iter().flatten().filter(|seen| **seen).count();
        assert_eq!(networks["echo_probability"]["n"], rows, "one sample a row");
    }
}

#[test]
fn networks_of_other_sizes_are_shown_beside_those_of_the_paper() {
    let workshop = Workshop::with_logs();
    workshop.done("train logs --hidden turn=8 --out sim.json");
    let shown = workshop.done("evaluate sim.json logs --json sizes.json");
    assert_eq!(shown.matches("turn (deg)").count(), 2, "{shown}");
    let sizes = workshop.json("sizes.json");
    assert!(sizes["networks"]["turn"]["mse"].is_number() && sizes["table_one"]["turn"]["mse"].is_number());
    assert_ne!(sizes["networks"]["turn"]["mse"], sizes["table_one"]["turn"]["mse"]);
    for wrong in ["turn=7", "turn=0", "turn=80", "eye=4", "turn"] {
        assert_eq!(workshop.call(&format!("train logs --hidden {wrong} --out other.json")).code, 2, "{wrong}");
    }
}

/// For each row of each run in `logs`, whether the tracker saw the robot.
fn tracked(workshop: &Workshop) -> Vec<Vec<bool>> {
    let run = |run: usize| workshop.text(&format!("logs/run-00{run}.csv"));
    let seen = |line: &str| line.split(',').nth(3).is_some_and(|x_cm| !x_cm.is_empty());
    (0..6).map(|i| run(i).lines().skip(1).map(seen).collect()).collect()
}

#[test]
fn the_first_line_of_an_output_can_be_read_alone() {
    let workshop = trained();
    let mut child = workshop
        .command("evaluate sim.json logs --json figures.json")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The reader goes away before a word is written.
    drop(child.stdout.take());
    let mut err = String::new();
    child.stderr.take().unwrap().read_to_string(&mut err).unwrap();
    assert_eq!((child.wait().unwrap().code(), err.as_str()), (Some(0), ""));
    assert_eq!(workshop.json("figures.json")["schema"], 1);
}

#[test]
fn a_controller_is_evolved_simulated_and_exported() {
    let workshop = with_scene();
    let told = workshop.done("evolve sim.json --scene scene.toml --start 2 --out controller.toml --max-steps 20");
    assert!(told.starts_with("start 2: ") && told.ends_with("controller written to controller.toml\n"), "{told}");
    let controller = workshop.text("controller.toml");
    assert_eq!(controller.matches("[[tuple]]").count(), 6);
    for line in ["step_ms = 400", "max_steps = 20", "simulator = \"sim.json\"", "scene = \"scene.toml\"", "start = 2"] {
        assert!(controller.lines().any(|l| l == line), "{line} is missing in\n{controller}");
    }

    let table =
        workshop.done("simulate sim.json controller.toml --scene scene.toml --start 2 --runs 4 --json runs.json");
    // A head, the runs, what "timed out" means where it occurs, and the sum.
    assert_eq!(table.lines().count(), 1 + 4 + usize::from(table.contains("\ntimed out: ")) + 1, "{table}");
    let rehearsal = workshop.json("runs.json");
    assert_eq!(rehearsal["schema"], 1);
    assert!((0.0..=1.0).contains(&rehearsal["success"].as_f64().unwrap()));
    let runs = rehearsal["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 4);
    for run in runs {
        assert!(["finished", "timed_out", "crashed"].contains(&run["ending"].as_str().unwrap()));
        let (path, steps) = (run["path"].as_array().unwrap(), run["steps"].as_u64().unwrap());
        assert_eq!(path.len() as u64, steps + 1, "the start and one point a step");
        assert!((1..=20).contains(&steps));
        assert_eq!(path[0]["x_cm"], 100.0);
    }

    workshop.done("export controller.toml --format nxc --out program.nxc --left A --sonar 1 --display");
    let program = workshop.text("program.nxc");
    assert!(program.contains("task main()") && program.contains("// simulator: sim.json"), "{program}");
}

#[test]
fn simulated_noise_is_the_users_choice() {
    let workshop = with_scene();
    workshop.done("evolve sim.json --scene scene.toml --out c.toml --max-steps 20");
    let ends = |noise: &str| -> Vec<Value> {
        workshop.done(&format!("simulate sim.json c.toml --scene scene.toml --runs 8 --json runs.json {noise}"));
        workshop.json("runs.json")["runs"].as_array().unwrap().clone()
    };
    assert_ne!(ends(""), ends("--paper-noise"));
}

#[test]
fn a_wrong_call_exits_with_two_and_help_with_zero() {
    let workshop = Workshop::new();
    for wrong in ["", "fly", "record", "record --out logs --runs none", "train logs", "record --out l --effect wings"] {
        assert_eq!(workshop.call(wrong).code, 2, "mindgap {wrong}");
    }
    for right in ["--help", "--version", "record --help", "simulate --help"] {
        let done = workshop.call(right);
        assert_eq!((done.code, done.err.as_str()), (0, ""), "mindgap {right}");
        assert!(!done.out.is_empty());
    }
    assert!(workshop.listing().is_empty());
}

#[test]
fn a_simulator_knows_the_first_echo_law_of_its_sonar() {
    let workshop = trained();
    workshop.write("room.toml", SCENE);
    workshop.done("evaluate sim.json logs --json figures.json");
    let models = &workshop.json("figures.json")["sensor_models"];
    let nats = |model: &str| models[model]["as_logged"].as_f64().unwrap_or_else(|| panic!("{model}: {models}"));
    // Six runs are few for the two networks.
    assert!(["beam", "first_echo"].into_iter().all(|model| nats(model) > nats("ideal_ray")), "{models}");
    assert!(nats("networks").is_finite(), "{models}");
    assert!(models["first_echo"]["poses_refitted"].is_null(), "a driven robot's poses are tracked: {models}");

    let controller = workspace().join("tests/tests/golden/controller.toml");
    workshop.write("go.toml", std::fs::read(controller).expect("a fixed controller"));
    let call = "simulate sim.json go.toml --scene room.toml --runs 20";
    let by_law = workshop.done(&format!("{call} --sonar first_echo"));
    assert_eq!(by_law, workshop.done(&format!("{call} --sonar first_echo")));
    assert_ne!(by_law, workshop.done(call));
    // What an effect changes of the sensor it changes of the law too; without `--sonar`, of the beam.
    let mut changed = workshop.json("sim.json");
    let original = changed.clone();
    let added = json!({ "effect": "sonar_offset", "variant": "length", "parameters": { "cm": -20.0 } });
    changed["added"] = json!([added]);
    workshop.write("sim.json", changed.to_string());
    let later = workshop.done(&format!("{call} --sonar first_echo"));
    assert_ne!(later, by_law);
    assert_ne!(later, workshop.done(call));
    let mut older = original;
    older.as_object_mut().expect("a table").remove("first_echo");
    workshop.write("sim.json", older.to_string());
    workshop.done(call);
    let refused = workshop.refused(&format!("{call} --sonar first_echo"));
    assert!(refused.contains("no first-echo law"), "{refused}");
}
