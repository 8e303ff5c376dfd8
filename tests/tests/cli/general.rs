//! Features that all commands share: general options, defaults next to the logs, JSON, suggestions for misspelt words.

use mindgap_tests::command::Sandbox;
use mindgap_tests::rooms::{SCENE, trained, with_scene};

#[test]
fn results_are_the_same_on_any_number_of_threads() {
    let sandbox = trained();
    let evaluation = |threads| sandbox.run(&format!("evaluate sim.json logs --threads {threads} --json -"));
    assert_eq!(evaluation(1), evaluation(3));
    assert_eq!(sandbox.call("check logs --threads 0").code, 2);
}

#[test]
fn quiet_leaves_errors_and_what_goes_to_standard_output_as_a_file() {
    let sandbox = Sandbox::with_logs();
    // A sensor that always reads the same causes a warning.
    sandbox.edit_cells("logs/run-000.csv", |cells| cells[6] = "50");
    let outcome = sandbox.call("train logs --out sim.json -q");
    assert_eq!((outcome.code, outcome.out.as_str(), outcome.err.as_str()), (0, "", ""));
    assert!(sandbox.run("check logs --quiet --json -").starts_with('{'));
    assert!(sandbox.refused("check nowhere -q").contains("nowhere"));
    assert_eq!(sandbox.call("check logs -q -v").code, 2);
}

#[test]
fn verbose_says_on_standard_error_what_is_decided() {
    let sandbox = trained();
    let usual = sandbox.call("diagnose sim.json logs");
    let verbose = sandbox.call("diagnose sim.json logs -v --threads 1");
    assert_eq!(usual.out, verbose.out);
    for word in [" on 1 threads", "logs: 6 runs, 156 rows", "fitting each effect", "alone gains"] {
        assert!(verbose.err.contains(word) && !usual.err.contains(word), "{word}: {}", verbose.err);
    }
}

#[test]
fn every_command_reports_as_json_and_recognises_its_report() {
    let sandbox = with_scene();
    for (call, key) in [
        ("record --out more --runs 2 --steps 5 --effect slip", "effects"),
        ("train logs --out sim.json", "evaluations"),
        ("evolve sim.json --scene scene.toml --out controller.toml --max-steps 6 --paper", "generations"),
        ("drive controller.toml --scene scene.toml --out run.csv", "ending"),
        ("export controller.toml --format nxc --out avoid.nxc", "takes"),
        ("info sim.json", "what"),
    ] {
        for force in ["", " --force"] {
            // Other outputs may need --force to be replaced. A report never does.
            sandbox.run(&format!("{call} --json {key}.json{force}"));
        }
        assert!(sandbox.json(&format!("{key}.json")).get(key).is_some(), "{call}");
        let output = sandbox.run(&format!("info {key}.json"));
        assert!(output.contains(call.split(' ').next().unwrap_or_default()), "{output}");
    }
    assert!(sandbox.run("info sim.json --json what.json").contains("a simulator"));
    assert_eq!(sandbox.json("takes.json")["takes"]["step_ms"], 400);
}

#[test]
fn defaults_next_to_the_logs_apply_and_options_override_them() {
    let sandbox = Sandbox::new();
    sandbox.run("record --out drives/logs --runs 6 --steps 25");
    sandbox.write(
        "drives/mindgap.toml",
        "seed = 5\n\n[train]\nhidden = [\"turn=6\", \"forward=8\"]\njson = \"report.json\"\n",
    );
    let seed = |call: &str| {
        sandbox.run(call);
        sandbox.json("drives/report.json")["seed"].as_u64()
    };
    assert_eq!(seed("train drives/logs --out sim.json"), Some(5));
    assert!(sandbox.json("sim.json").get("table_one").is_some(), "other sizes than the paper's");
    assert_eq!(seed("train drives/logs --out sim.json --seed 7"), Some(7));
    let verbose = sandbox.call("train drives/logs --out sim.json -v");
    assert!(verbose.err.contains("drives/mindgap.toml:1: --seed=5"), "{}", verbose.err);
    // A command that reads no logs takes its defaults from the working directory.
    sandbox.write("mindgap.toml", "[record]\nruns = 2\nsteps = 4\nquiet = true\n");
    assert_eq!(sandbox.run("record --out few"), "");
    assert!(sandbox.run("info few").contains("2 runs, 10 rows"));
}

#[test]
fn options_override_conflicting_defaults() {
    let sandbox = Sandbox::new();
    sandbox.write("scene.toml", SCENE);
    sandbox.write("mindgap.toml", "scene = \"scene.toml\"\n");
    // An invalid program is reported only if the call is valid.
    sandbox.write("none.rxe", "none");
    let output = sandbox.refused("brick none.rxe --readings 50");
    assert!(output.contains("is not a program that an NXT can run"), "{output}");
}

#[test]
fn invalid_defaults_are_refused_with_their_line() {
    let sandbox = Sandbox::with_logs();
    for (text, message) in [
        ("threads = 1\nsed = 3\n", "mindgap.toml:2: sed is not an option of mindgap; did you mean seed?"),
        ("[train]\nsceen = 3\n", "mindgap.toml:2: sceen is not an option of mindgap"),
        ("[trian]\nseed = 3\n", "mindgap.toml:1: trian is not an option of mindgap; did you mean train?"),
        ("robot = \"a.toml\"\n", "mindgap.toml:1: robot means different things in different commands"),
        ("force = true\n", "mindgap.toml:1: force is not an option of mindgap"),
        ("quiet = 1\n", "mindgap.toml:1: quiet: must be true or false"),
        ("seed = true\n", "mindgap.toml:1: seed: must be a quoted string or a number"),
        ("\nseed = \"x\"\n", "mindgap.toml:2: invalid value 'x' for '--seed <N>'"),
        ("seed = \n", "mindgap.toml:1: "),
    ] {
        sandbox.write("mindgap.toml", text);
        let refused = sandbox.refused("train logs --out sim.json");
        assert!(refused.starts_with(message), "{text}: {refused}");
    }
}

#[test]
fn the_closest_known_word_is_suggested() {
    let sandbox = Sandbox::with_logs();
    for (call, meant) in [
        ("record --out more --effect slipp", "did you mean slip?"),
        ("train logs --out sim.json --hidden trun=4", "did you mean turn?"),
        ("check logs --threds 2", "'--threads'"),
        ("evalute sim.json logs", "'evaluate'"),
    ] {
        let outcome = sandbox.call(call);
        assert_eq!(outcome.code, 2);
        assert!(outcome.err.contains(meant), "{}", outcome.err);
    }
    assert!(sandbox.refused("diagnose kinematc logs").contains("did you mean kinematic?"));
    sandbox.edit("logs/scene.toml", |text| text + "\n[[obstacles]]\n");
    assert!(sandbox.refused("check logs").contains("did you mean obstacle?"));
}

#[test]
fn help_of_a_command_has_an_example_and_its_values() {
    let help = Sandbox::new().run("record --help");
    for word in ["Example:\n  mindgap record", "battery_sag", "General options", "--threads <N>"] {
        assert!(help.contains(word), "{word} is missing in\n{help}");
    }
}
