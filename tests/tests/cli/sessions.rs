//! `mindgap diagnose SIM LOGS LOGS`: sessions of one robot.

use std::sync::LazyLock;

use mindgap_tests::command::Sandbox;
use mindgap_tests::rooms::with_forty_runs;
use serde_json::Value;

/// Returns a folder with a simulator and four sessions: two on tiles, and two on a carpet on which the robot turns less.
fn four_sessions() -> Sandbox {
    static SESSIONS: LazyLock<Sandbox> = LazyLock::new(|| {
        let sandbox = with_forty_runs();
        for (day, fault) in [(1, ""), (2, CARPET), (3, ""), (4, CARPET)] {
            let floor = if fault.is_empty() { "tiles" } else { "carpet" };
            sandbox.run(&format!("record --out days/{day} --runs 8 --seed {} {fault}", 10 + day));
            sandbox.write(
                &format!("days/{day}/session.toml"),
                format!(
                    "floor = \"{floor}\"\noperator = \"{}\"\ndate = 2026-11-0{day}\n",
                    if day < 3 { "a" } else { "b" }
                ),
            );
        }
        sandbox
    });
    SESSIONS.copy()
}

const CARPET: &str = "--effect track_width=0.85";
const ALL: &str = "days/1 days/2 days/3 days/4";

fn effects(session: &Value) -> &Vec<Value> {
    session["effects"].as_array().expect("a list")
}

#[test]
fn what_differs_between_sessions_is_reported_with_its_condition() {
    let sandbox = four_sessions();
    let said = sandbox.run(&format!("diagnose sim.json {ALL} --json d.json --html d.html"));
    let diagnosis = sandbox.json("d.json");
    let sessions = diagnosis["sessions"].as_array().expect("sessions");
    let folders: Vec<&str> = sessions.iter().filter_map(|session| session["folder"].as_str()).collect();
    assert_eq!(folders, ["days/1", "days/2", "days/3", "days/4"]);
    assert_eq!(
        sessions[1]["conditions"],
        serde_json::json!({"floor": "carpet", "operator": "a", "date": "2026-11-02"})
    );
    for session in sessions {
        let [effect] = effects(session).as_slice() else { panic!("one effect differs: {session}") };
        assert_eq!((effect["id"].as_str(), &effect["goes_with"]), (Some("track_width"), &serde_json::json!(["floor"])));
        let factor = effect["parameters"]["factor"].as_f64().expect("a number");
        let is_carpet = session["conditions"]["floor"] == "carpet";
        assert!(if is_carpet { (factor - 1.0).abs() > 0.05 } else { (factor - 1.0).abs() < 0.03 }, "{session}");
    }
    assert!(said.contains("Differences between sessions:") && said.contains("track_width goes with floor:"), "{said}");
    let page = sandbox.text("d.html");
    assert!(
        page.contains("What differs between sessions") && page.contains("days/4 (date 2026-11-04, floor carpet"),
        "the page says so"
    );
    assert!(diagnosis["data"].as_array().is_some_and(Vec::is_empty), "{}", diagnosis["data"]);
}

#[test]
fn sessions_that_are_alike_differ_in_nothing() {
    let sandbox = four_sessions();
    let said = sandbox.run("diagnose sim.json days/1 days/3 --json d.json");
    let diagnosis = sandbox.json("d.json");
    assert_eq!(diagnosis["verdict"], "no_gap", "{said}");
    assert!(
        diagnosis["sessions"].as_array().is_some_and(|all| all.len() == 2 && all.iter().all(|s| effects(s).is_empty()))
    );
    assert!(said.contains("No difference between the 2 sessions was found."), "{said}");
    let alone = sandbox.run("diagnose sim.json days/1 --json alone.json");
    assert!(!alone.contains("sessions") && sandbox.json("alone.json").get("sessions").is_none());
}

#[test]
fn sessions_that_do_not_belong_together_are_refused_in_one_line() {
    let sandbox = four_sessions();
    sandbox.edit("days/2/robot.toml", |text| text.replace("track_cm = 11.5", "track_cm = 13.5"));
    sandbox.edit("days/3/scene.toml", |text| {
        format!("{text}\n[[obstacle]]\nx_cm = 1\ny_cm = 1\nwidth_cm = 1\nheight_cm = 1\n")
    });
    sandbox.write("days/4/session.toml", "floor = \"tiles\"\nload_g = \n");
    for (logs, problem) in [
        ("days/1 days/2", "days/2/robot.toml: track_cm is 13.5, and 11.5 in days/1: sessions are of one robot"),
        ("days/1 days/3", "days/3/scene.toml: has other walls or obstacles than that of days/1"),
        ("days/1 days/4", "days/4/session.toml:2: "),
        ("days/4", "days/4/session.toml:2: "),
        ("days/1 days/1", "days/1: is given twice"),
        ("days/1 days/9", "days/9/robot.toml: "),
        ("days/1 days/3 --fleet out", "--fleet takes one folder"),
    ] {
        let refused = sandbox.call(&format!("diagnose sim.json {logs}"));
        assert_eq!((refused.code, refused.err.lines().count()), (1, 1), "{logs}: {}", refused.err);
        assert!(refused.err.contains(problem), "{logs}: {}", refused.err);
    }
}
