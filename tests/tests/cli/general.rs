//! What all commands have in common: general options, defaults beside the logs, JSON, words that were probably meant.

use mindgap_tests::command::Workshop;
use mindgap_tests::rooms::{SCENE, trained, with_scene};

#[test]
fn results_are_the_same_on_any_number_of_threads() {
    let workshop = trained();
    let evaluation = |threads| workshop.done(&format!("evaluate sim.json logs --threads {threads} --json -"));
    assert_eq!(evaluation(1), evaluation(3));
    assert_eq!(workshop.call("check logs --threads 0").code, 2);
}

#[test]
fn quiet_leaves_errors_and_what_goes_to_standard_output_as_a_file() {
    let workshop = Workshop::with_logs();
    // A sensor that always reads the same is warned of.
    workshop.edit_cells("logs/run-000.csv", |cells| cells[6] = "50");
    let done = workshop.call("train logs --out sim.json -q");
    assert_eq!((done.code, done.out.as_str(), done.err.as_str()), (0, "", ""));
    assert!(workshop.done("check logs --quiet --json -").starts_with('{'));
    assert!(workshop.refused("check nowhere -q").contains("nowhere"));
    assert_eq!(workshop.call("check logs -q -v").code, 2);
}

#[test]
fn verbose_says_on_standard_error_what_is_decided() {
    let workshop = trained();
    let usual = workshop.call("diagnose sim.json logs");
    let verbose = workshop.call("diagnose sim.json logs -v --threads 1");
    assert_eq!(usual.out, verbose.out);
    for word in [" on 1 threads", "logs: 6 runs, 156 rows", "fitting each effect", "alone gains"] {
        assert!(verbose.err.contains(word) && !usual.err.contains(word), "{word}: {}", verbose.err);
    }
}

#[test]
fn every_command_that_makes_something_tells_it_as_json_and_knows_its_own_file() {
    let workshop = with_scene();
    for (call, key) in [
        ("record --out more --runs 2 --steps 5 --effect slip", "effects"),
        ("train logs --out sim.json", "evaluations"),
        ("evolve sim.json --scene scene.toml --out controller.toml --max-steps 6", "generations"),
        ("drive controller.toml --scene scene.toml --out run.csv", "ending"),
        ("export controller.toml --format nxc --out avoid.nxc", "takes"),
        ("info sim.json", "what"),
    ] {
        for force in ["", " --force"] {
            // What else it writes may have to be replaced by force, its own report never.
            workshop.done(&format!("{call} --json {key}.json{force}"));
        }
        assert!(workshop.json(&format!("{key}.json")).get(key).is_some(), "{call}");
        let told = workshop.done(&format!("info {key}.json"));
        assert!(told.contains(call.split(' ').next().unwrap_or_default()), "{told}");
    }
    assert!(workshop.done("info sim.json --json what.json").contains("a simulator"));
    assert_eq!(workshop.json("takes.json")["takes"]["step_ms"], 400);
}

#[test]
fn defaults_lie_beside_the_logs_and_calls_win() {
    let workshop = Workshop::new();
    workshop.done("record --out drives/logs --runs 6 --steps 25");
    workshop.write(
        "drives/mindgap.toml",
        "seed = 5\n\n[train]\nhidden = [\"turn=6\", \"forward=8\"]\njson = \"told.json\"\n",
    );
    let seed = |call: &str| {
        workshop.done(call);
        workshop.json("drives/told.json")["seed"].as_u64()
    };
    assert_eq!(seed("train drives/logs --out sim.json"), Some(5));
    assert!(workshop.json("sim.json").get("table_one").is_some(), "other sizes than the paper's");
    assert_eq!(seed("train drives/logs --out sim.json --seed 7"), Some(7));
    let verbose = workshop.call("train drives/logs --out sim.json -v");
    assert!(verbose.err.contains("drives/mindgap.toml:1: --seed=5"), "{}", verbose.err);
    // A command that reads no logs looks where it is called.
    workshop.write("mindgap.toml", "[record]\nruns = 2\nsteps = 4\nquiet = true\n");
    assert_eq!(workshop.done("record --out few"), "");
    assert!(workshop.done("info few").contains("2 runs, 10 rows"));
}

#[test]
fn defaults_give_way_to_what_conflicts_with_them() {
    let workshop = Workshop::new();
    workshop.write("scene.toml", SCENE);
    workshop.write("mindgap.toml", "scene = \"scene.toml\"\n");
    // A program that is none is told only when the call is right.
    workshop.write("none.rxe", "none");
    let told = workshop.refused("brick none.rxe --readings 50");
    assert!(told.contains("is not a program that an NXT can run"), "{told}");
}

#[test]
fn defaults_that_are_wrong_are_told_with_their_line() {
    let workshop = Workshop::with_logs();
    for (text, told) in [
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
        workshop.write("mindgap.toml", text);
        let refused = workshop.refused("train logs --out sim.json");
        assert!(refused.starts_with(told), "{text}: {refused}");
    }
}

#[test]
fn words_that_were_probably_meant_are_named() {
    let workshop = Workshop::with_logs();
    for (call, meant) in [
        ("record --out more --effect slipp", "did you mean slip?"),
        ("train logs --out sim.json --hidden trun=4", "did you mean turn?"),
        ("check logs --threds 2", "'--threads'"),
        ("evalute sim.json logs", "'evaluate'"),
    ] {
        let done = workshop.call(call);
        assert_eq!(done.code, 2);
        assert!(done.err.contains(meant), "{}", done.err);
    }
    assert!(workshop.refused("diagnose kinematc logs").contains("did you mean kinematic?"));
    workshop.edit("logs/scene.toml", |text| text + "\n[[obstacles]]\n");
    assert!(workshop.refused("check logs").contains("did you mean obstacle?"));
}

#[test]
fn help_of_a_command_has_an_example_and_what_else_it_says() {
    let help = Workshop::new().done("record --help");
    for word in ["Example:\n  mindgap record", "battery_sag", "General options", "--threads <N>"] {
        assert!(help.contains(word), "{word} is missing in\n{help}");
    }
}
