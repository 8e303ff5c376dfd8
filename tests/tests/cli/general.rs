//! Features that all commands share: general options, defaults next to the logs, JSON, suggestions for misspelt words.

use std::fs;

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
    // A file that is passed over causes a warning.
    sandbox.write("logs/run_000.csv", "t_ms,left,right\n");
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
        ("info sim.json", "files"),
    ] {
        for force in ["", " --force"] {
            // Other outputs may need --force to be replaced. A report never does.
            sandbox.run(&format!("{call} --json {key}.json{force}"));
        }
        assert!(sandbox.json(&format!("{key}.json")).get(key).is_some(), "{call}");
        let output = sandbox.run(&format!("info {key}.json"));
        assert!(output.contains(call.split(' ').next().unwrap_or_default()), "{output}");
    }
    assert!(sandbox.run("info sim.json --json files.json").contains("a simulator"));
    assert_eq!(sandbox.json("takes.json")["takes"]["step_ms"], 400);
}

#[test]
fn defaults_next_to_the_logs_apply_and_options_override_them() {
    let sandbox = Sandbox::new();
    sandbox.run("record --out drives/logs --runs 6 --steps 25");
    sandbox.write("drives/mindgap.toml", "seed = 5\n\n[train]\nhidden = [\"turn=6\", \"forward=8\"]\n");
    let seed = |call: &str| {
        sandbox.run(&format!("{call} --json report.json"));
        sandbox.json("report.json")["seed"].as_u64()
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
fn a_gap_is_an_exit_code_only_when_asked_for() {
    let sandbox = trained();
    sandbox.run("record --out slow --runs 6 --steps 25 --seed 9 --effect drive_scale=0.85");
    sandbox.run("diagnose sim.json slow");
    let asked = sandbox.call("diagnose sim.json slow --exit-code --json gap.json");
    assert_eq!(asked.code, 3, "{}", asked.err);
    assert!(asked.out.contains("drive_scale") && sandbox.json("gap.json")["verdict"] != "no_gap", "{}", asked.out);
    let same = sandbox.call("diagnose sim.json logs --exit-code --json same.json");
    let has_gap = sandbox.json("same.json")["verdict"] != "no_gap";
    assert_eq!(same.code, if has_gap { 3 } else { 0 }, "{}", same.err);
    assert_eq!(sandbox.call("diagnose none.json logs --exit-code").code, 1);
}

#[test]
fn the_format_of_an_export_follows_from_its_ending() {
    let sandbox = with_scene();
    sandbox.run("evolve sim.json --scene scene.toml --out c.toml --max-steps 6 --paper");
    for (ending, format) in
        [("nxc", "nxc"), ("rxe", "rxe"), ("rs", "rust"), ("h", "c"), ("ino", "arduino"), ("py", "pybricks")]
    {
        sandbox.run(&format!("export c.toml --out a.{ending}"));
        let by_ending = sandbox.bytes(&format!("a.{ending}"));
        sandbox.run(&format!("export c.toml --format {format} --out a.{ending} --force"));
        assert!(sandbox.bytes(&format!("a.{ending}")) == by_ending, "{ending}");
    }
    assert!(sandbox.refused("export c.toml --out a.txt").starts_with("a.txt: has an ending that stands for no format"));
    assert!(sandbox.refused("export --out b.nxc").starts_with("b.nxc: a controller or a simulator is needed"));
}

/// A file that came with data cannot decide what is run or written.
#[test]
fn defaults_next_to_the_logs_neither_run_nor_write_unless_allowed() {
    let sandbox = Sandbox::with_logs();
    sandbox.write("scene.toml", SCENE);
    sandbox.run("train logs --out sim.json");
    fs::create_dir_all(sandbox.path().join("config/mindgap")).expect("a folder");
    let call = |call: &str| {
        let mut command = sandbox.command(call);
        command.env("XDG_CONFIG_HOME", sandbox.path().join("config"));
        sandbox.execute(command)
    };
    let train = "train logs --out sim.json";
    let loops = "loop out --sim sim.json --scene scene.toml --trials 1 --max-steps 10";
    for (text, command, line, key) in [
        ("seed = 3\njson = \"r.json\"\n", train, 2, "train.json"),
        ("[train]\njson = \"r.json\"\n", train, 2, "train.json"),
        ("allow = [\"train.json\"]\njson = \"r.json\"\n", train, 2, "train.json"),
        ("[train]\nallow = [\"train.json\"]\njson = \"r.json\"\n", train, 3, "train.json"),
        ("json = \"-\"\n", train, 1, "train.json"),
        ("[train]\nout = \"elsewhere.json\"\n", "train logs", 2, "train.out"),
        ("html = \"r.html\"\n", "diagnose sim.json logs", 1, "diagnose.html"),
        ("[diagnose]\nfigures = \"r\"\n", "diagnose sim.json logs", 2, "diagnose.figures"),
        ("[loop]\nrobot = \"touch r\"\n", loops, 2, "loop.robot"),
    ] {
        sandbox.write("mindgap.toml", text);
        let refused = call(command);
        let expected = format!("mindgap.toml:{line}: a file next to logs cannot set {key}");
        assert_eq!((refused.code, refused.out.as_str()), (1, ""), "{text}: {}", refused.err);
        let last = refused.err.lines().last().unwrap_or_default();
        assert!(last.contains(&expected), "{text}: {}", refused.err);
        let written = ["r", "r.json", "r.html", "elsewhere.json", "out"];
        assert!(!written.iter().any(|name| sandbox.path().join(name).exists()), "{text}");
    }
    // Ignored, without a refusal.
    sandbox.write("mindgap.toml", "allow = [\"train.json\"]\nseed = 3\n");
    let ignored = call(train);
    assert!(ignored.code == 0 && ignored.err.contains("mindgap.toml:1: allow is ignored"), "{}", ignored.err);
    // Allowed by the command line or by the user's own file, and then printed.
    sandbox.write("mindgap.toml", "json = \"r.json\"\n");
    let allowed = call(&format!("{train} --allow train.json"));
    assert!(allowed.code == 0 && allowed.err.contains("mindgap.toml:1: --json=r.json"), "{}", allowed.err);
    sandbox.write("config/mindgap/mindgap.toml", "allow = [\"train.json\"]\nseed = 9\n");
    let allowed = call(train);
    assert!(allowed.code == 0 && allowed.err.contains("mindgap.toml:1: --json=r.json"), "{}", allowed.err);
    assert_eq!(sandbox.json("r.json")["seed"], 9);
    // The user's own file may set anything itself, and the file next to the logs overrides how.
    sandbox.write("config/mindgap/mindgap.toml", "seed = 9\n[train]\njson = \"own.json\"\n");
    sandbox.write("mindgap.toml", "seed = 3\n");
    assert_eq!(call(train).code, 0);
    assert_eq!(sandbox.json("config/mindgap/own.json")["seed"], 3);
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
