//! `mindgap monitor`: an unchanged robot is quiet, a changed one is named; what cannot be monitored is refused in one line.

use std::sync::LazyLock;

use mindgap_tests::command::Sandbox;

/// Returns a folder with a simulator, and logs of the robot as it was and with a weaker left motor.
fn sandbox() -> Sandbox {
    static MADE: LazyLock<Sandbox> = LazyLock::new(|| {
        let sandbox = Sandbox::new();
        sandbox.run("record --out logs --runs 60 --steps 60 --seed 1");
        sandbox.run("record --out same --runs 40 --steps 100 --seed 2");
        sandbox.run("record --out weak --runs 5 --steps 60 --seed 3 --effect motor_asymmetry=0.12");
        sandbox.run("train logs --out sim.json");
        sandbox
    });
    MADE.copy()
}

#[test]
fn unchanged_robot_is_quiet() {
    let sandbox = sandbox();
    let text = sandbox.run("monitor sim.json same --json found.json");
    assert!(text.starts_with("No alarm"), "{text}");
    let found = sandbox.json("found.json");
    assert!(found["alarm"].is_null() && found["steps"] == 4000, "{found}");
}

#[test]
fn weaker_motor_is_named_with_its_beginning() {
    let sandbox = sandbox();
    sandbox.run("monitor sim.json weak --json found.json");
    let found = sandbox.json("found.json");
    let alarm = &found["alarm"];
    assert_eq!(alarm["what"], "weaker left motor", "{found}");
    assert_eq!(alarm["effects"][0], "motor_asymmetry");
    assert_eq!(alarm["raised"]["run"], "run-000", "{found}");
    let size = alarm["size"].as_f64().unwrap();
    assert!((0.04..0.3).contains(&size), "{size}");
}

#[test]
fn simulator_without_its_own_error_is_refused_with_the_command_that_adds_it() {
    let sandbox = sandbox();
    let mut simulator = sandbox.json("sim.json");
    simulator.as_object_mut().unwrap().remove("robots");
    sandbox.write("sim.json", simulator.to_string());
    for call in ["monitor sim.json same", "export sim.json --format c --monitor --out robot.h"] {
        let message = sandbox.refused(call);
        assert!(message.contains("own error") && message.contains("mindgap train LOGS --out SIM"), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
    }
}
