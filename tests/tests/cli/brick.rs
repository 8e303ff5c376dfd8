//! `mindgap brick` as a black box, and the programs that it is given.

use mindgap_tests::command::Workshop;
use mindgap_tests::nbc::compile;

const CONTROLLER: &str = "\
step_ms = 400
max_steps = 10
tuple = [
  { left = 55, right = 48, when = \"smaller\", threshold_cm = 42 },
  { left = -20, right = 20, when = \"larger\", threshold_cm = 50 },
  { left = 30, right = 31, when = \"smaller\", threshold_cm = 42 },
  { left = 32, right = 33, when = \"larger\", threshold_cm = 42 },
  { left = 34, right = 35, when = \"larger\", threshold_cm = 42 },
  { left = 36, right = 37, when = \"larger\", threshold_cm = 42 },
]
";

/// A folder with a controller's program.
fn with_program() -> Workshop {
    let workshop = Workshop::new();
    workshop.write("controller.toml", CONTROLLER);
    workshop.done("export controller.toml --format rxe --out run.rxe");
    workshop
}

/// Time and order of every line about a motor.
fn powers(told: &str) -> Vec<(u32, String)> {
    told.lines()
        .filter_map(|line| {
            let (t_ms, motor) = line.split_once(" ms  motor ")?;
            Some((t_ms.trim().parse().unwrap(), motor.split_whitespace().collect::<Vec<_>>().join(" ")))
        })
        .collect()
}

#[test]
fn it_tells_what_a_controller_does() {
    let workshop = with_program();
    let told = workshop.done("brick run.rxe --readings 100,41,60.4,none,41,50,50,50 --json facts.json");
    let moved = powers(&told);
    // Steps count from when the motors start: before that the sensor warms up.
    let began_ms = moved[0].0;
    for (at_ms, motor) in [(0, "B 55"), (0, "C 48"), (800, "B -20"), (1200, "C 31"), (2000, "B 32"), (2400, "C 35")] {
        // A reading takes a while, at most this.
        let near = |t_ms: u32| (at_ms..at_ms + 30).contains(&(t_ms - began_ms));
        assert!(moved.iter().any(|(t_ms, told)| near(*t_ms) && told == motor), "{motor}: {told}");
    }
    assert!(told.contains("finished after ") && told.contains("B brake, C brake"), "{told}");
    let facts = workshop.json("facts.json");
    assert_eq!((&facts["schema"], &facts["end"]), (&1.into(), &"finished".into()));
    let motors = facts["events"].as_array().unwrap().iter().filter(|event| event["motor"].is_string());
    assert_eq!(motors.count(), moved.len());
}

#[test]
fn readings_of_a_log_are_those_of_a_list() {
    let workshop = with_program();
    workshop.write("readings.csv", "t_ms,echo_cm\n0,100\n400,41\n800,60.4\n1200,\n1600,41\n");
    let listed = workshop.done("brick run.rxe --readings 100,41,60,none,41");
    assert_eq!(workshop.done("brick run.rxe --readings readings.csv"), listed);
    assert!(listed.contains("of 5 readings were asked for"), "{listed}");
}

#[test]
fn it_ends_whatever_the_program_does() {
    let workshop = with_program();
    let cut = workshop.done("brick run.rxe --readings 100,100,100,100 --limit-ms 1000");
    assert!(cut.contains("still running, given up after 1000 ms"), "{cut}");
    let aborted = workshop.done("brick run.rxe --readings 100,100,100,100 --exit-ms 700");
    assert!(
        aborted.contains("aborted by the dark button after 700 ms; motors: A coast, B coast, C coast"),
        "{aborted}"
    );
    workshop.write("ever.rxe", compile("task main() { while (true) OnFwd(OUT_A, 30); }"));
    let ever = workshop.done("brick ever.rxe --readings none --limit-ms 50");
    assert!(ever.contains("given up after 50 ms"), "{ever}");
}

#[test]
fn what_cannot_run_is_refused() {
    let workshop = with_program();
    let program = workshop.bytes("run.rxe");
    for length in [0, 13, 37, 60, program.len() / 2, program.len() - 1] {
        workshop.write("torn.rxe", &program[..length]);
        let problem = workshop.refused("brick torn.rxe --readings none");
        assert!(problem.starts_with("torn.rxe: is no program that a brick runs: "), "{problem}");
    }
    assert!(workshop.refused("brick none.rxe --readings 1").starts_with("none.rxe: cannot be read: "));
    assert_eq!(
        workshop.refused("brick run.rxe --readings 12,far"),
        "--readings \"12,far\" is no file, and as a list it has a reading that is \"far\", \
         neither a distance nor none, silent or hangs"
    );
    workshop.write("readings.csv", "t_ms,echo_cm\n0,100\n400,256\n");
    assert_eq!(
        workshop.refused("brick run.rxe --readings readings.csv"),
        "readings.csv:3: echo_cm is 256, outside 0..255 cm"
    );
    workshop.write("readings.csv", "t_ms,echo\n0,100\n");
    assert_eq!(workshop.refused("brick run.rxe --readings readings.csv"), "readings.csv:1: column echo_cm is missing");
    assert_eq!(workshop.call("brick run.rxe").code, 2);
    assert_eq!(workshop.call("brick run.rxe --readings none --limit-ms 0").code, 2);
}

#[test]
fn a_collecting_program_logs_runs() {
    let workshop = Workshop::new();
    let told = workshop.done("export --format nxc-collect --steps 12 --seed 5 --out collect.nxc");
    assert!(told.starts_with("collect.nxc written\nprogram ") && told.contains("\nlog "), "{told}");
    workshop.write("collect.rxe", compile(&workshop.text("collect.nxc")));
    let far = vec!["200"; 13].join(",");
    let told = workshop.done(&format!("brick collect.rxe --readings {far} --json facts.json"));
    assert!(told.contains("file run-000.csv, "), "{told}");
    let facts = workshop.json("facts.json");
    let log = facts["files"]["run-000.csv"].as_str().unwrap();
    assert_eq!(log.lines().count(), 1 + 13, "{log}");

    workshop.done("export --format nxc-collect --steps 12 --seed 6 --out other.nxc");
    assert_ne!(workshop.text("other.nxc").replace("other", "collect"), workshop.text("collect.nxc"));
}

#[test]
fn a_collecting_program_that_cannot_be_is_refused() {
    let workshop = with_program();
    let refused = |options: &str| workshop.refused(&format!("export {options} --out c.nxc"));
    assert_eq!(refused("--format nxc-collect --steps 0"), "c.nxc: steps is 0; it has to lie in 1..65535");
    assert!(refused("--format nxc-collect --near-cm 0").starts_with("c.nxc: near_cm is 0"));
    assert!(refused("--format nxc-collect --step-ms 50").starts_with("c.nxc: "));
    assert!(refused("--format nxc-collect --steps 60000").starts_with("c.nxc: "));
    let no_script = refused("controller.toml --format nxc-collect");
    assert!(no_script.starts_with("controller.toml:1: columns t_ms, left, right,"), "{no_script}");
    assert_eq!(workshop.call("export --format nxc --out c.nxc").code, 2);
}
