//! `mindgap brick` on exported and handwritten programs.

use mindgap_tests::command::Sandbox;
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

/// Returns a folder with the program of a controller.
fn with_program() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("controller.toml", CONTROLLER);
    sandbox.run("export controller.toml --format rxe --out run.rxe");
    sandbox
}

/// Returns the time and command of every line about a motor.
fn powers(output: &str) -> Vec<(u32, String)> {
    output
        .lines()
        .filter_map(|line| {
            let (t_ms, motor) = line.split_once(" ms  motor ")?;
            Some((t_ms.trim().parse().unwrap(), motor.split_whitespace().collect::<Vec<_>>().join(" ")))
        })
        .collect()
}

#[test]
fn the_trace_shows_what_a_controller_does() {
    let sandbox = with_program();
    let output = sandbox.run("brick run.rxe --readings 100,41,60.4,none,41,50,50,50 --json facts.json");
    let moved = powers(&output);
    // Steps count from the start of the motors. Before that the sensor warms up.
    let began_ms = moved[0].0;
    for (at_ms, motor) in [(0, "B 55"), (0, "C 48"), (800, "B -20"), (1200, "C 31"), (2000, "B 32"), (2400, "C 35")] {
        // A reading takes up to 30 ms.
        let near = |t_ms: u32| (at_ms..at_ms + 30).contains(&(t_ms - began_ms));
        assert!(moved.iter().any(|(t_ms, command)| near(*t_ms) && command == motor), "{motor}: {output}");
    }
    assert!(output.contains("finished after ") && output.contains("B brake, C brake"), "{output}");
    assert!(output.contains("text     \"finished\" at 0, 24") && output.contains("tone     880 Hz"), "{output}");
    let facts = sandbox.json("facts.json");
    assert_eq!((&facts["schema"], &facts["end"]), (&1.into(), &"finished".into()));
    let motors = facts["events"].as_array().unwrap().iter().filter(|event| event["motor"].is_string());
    assert_eq!(motors.count(), moved.len());
}

#[test]
fn readings_from_a_log_equal_readings_from_a_list() {
    let sandbox = with_program();
    sandbox.write("readings.csv", "t_ms,echo_cm\n0,100\n400,41\n800,60.4\n1200,\n1600,41\n");
    let listed = sandbox.run("brick run.rxe --readings 100,41,60,none,41");
    assert_eq!(sandbox.run("brick run.rxe --readings readings.csv"), listed);
    assert!(listed.contains("of 5 readings"), "{listed}");
}

#[test]
fn emulation_ends_for_any_program() {
    let sandbox = with_program();
    let cut = sandbox.run("brick run.rxe --readings 100,100,100,100 --limit-ms 1000");
    assert!(cut.contains("still running, stopped after 1000 ms"), "{cut}");
    let aborted = sandbox.run("brick run.rxe --readings 100,100,100,100 --exit-ms 700");
    assert!(
        aborted.contains("aborted by the dark button after 700 ms; motors: A coast, B coast, C coast"),
        "{aborted}"
    );
    sandbox.write("ever.rxe", compile("task main() { while (true) OnFwd(OUT_A, 30); }"));
    let ever = sandbox.run("brick ever.rxe --readings none --limit-ms 50");
    assert!(ever.contains("stopped after 50 ms"), "{ever}");
}

#[test]
fn unusable_programs_and_readings_are_refused() {
    let sandbox = with_program();
    let program = sandbox.bytes("run.rxe");
    for length in [0, 13, 37, 60, program.len() / 2, program.len() - 1] {
        sandbox.write("torn.rxe", &program[..length]);
        let problem = sandbox.refused("brick torn.rxe --readings none");
        assert!(problem.starts_with("torn.rxe: is not a program that an NXT can run: "), "{problem}");
    }
    assert!(sandbox.refused("brick none.rxe --readings 1").starts_with("none.rxe: cannot be read: "));
    assert_eq!(
        sandbox.refused("brick run.rxe --readings 12,far"),
        "--readings \"12,far\" is not a file, and as a list it has a reading that is \"far\", \
         neither a distance nor none, silent or hangs"
    );
    sandbox.write("readings.csv", "t_ms,echo_cm\n0,100\n400,256\n");
    assert_eq!(
        sandbox.refused("brick run.rxe --readings readings.csv"),
        "readings.csv:3: echo_cm is 256, outside 0..255 cm"
    );
    sandbox.write("readings.csv", "t_ms,echo\n0,100\n");
    assert_eq!(sandbox.refused("brick run.rxe --readings readings.csv"), "readings.csv:1: column echo_cm is missing");
    assert_eq!(sandbox.call("brick run.rxe").code, 2);
    assert_eq!(sandbox.call("brick run.rxe --readings none --limit-ms 0").code, 2);
    sandbox.write("world.csv", "t_ms,port_1\n0,200\n");
    assert_eq!(
        sandbox.refused("brick run.rxe --readings none --world world.csv"),
        "world.csv:2: port_1 = \"200\" is not a whole number from 0 to 100"
    );
}

#[test]
fn a_failing_program_reports_the_instruction() {
    let sandbox = Sandbox::new();
    sandbox.write("fails.rxe", compile("task main() { int a[] = {1}; int i = 5; NumOut(0, LCD_LINE1, a[i]); }"));
    let output = sandbox.run("brick fails.rxe --readings none --json facts.json");
    assert!(
        output.contains("failed: wrong operand or index after ") && output.contains(" of clump 0: index\n"),
        "{output}"
    );
    assert_eq!(sandbox.json("facts.json")["failed_at"]["instruction"], "index");
}

#[test]
fn an_endless_writer_fills_neither_memory_nor_output() {
    let sandbox = Sandbox::new();
    let source = "task main() { string s = \"01234567\"; repeat(8) s = StrCat(s, s); while (true) TextOut(0, 0, s); }";
    sandbox.write("ever.rxe", compile(source));
    let output = sandbox.run("brick ever.rxe --readings none --limit-events 5");
    assert_eq!(output.matches("text     \"0123456701234567\" at 0, 0").count(), 5, "{output}");
    assert!(output.contains(" more events (--limit-events)"), "{output}");
}

#[test]
fn buttons_and_sensors_follow_a_script() {
    let sandbox = with_program();
    sandbox.write("world.csv", "t_ms,orange\n0,0\n1000,1\n1001,0\n");
    let output = sandbox.run("brick run.rxe --readings 100,100,100,100,100,100 --world world.csv");
    assert!(output.contains("\"stopped\""), "{output}");
    let source = "task main() { SetSensorTouch(IN_1); while (!Sensor(IN_1)) Wait(1); NumOut(0, 0, CurrentTick() - FirstTick()); }";
    sandbox.write("touch.rxe", compile(source));
    sandbox.write("world.csv", "t_ms,port_1\n0,0\n700,1\n");
    let output = sandbox.run("brick touch.rxe --readings none --world world.csv");
    assert!(output.contains("text     \"70"), "{output}");
}

#[test]
fn a_port_that_no_option_configures_is_reported() {
    let sandbox = with_program();
    let source =
        "task main() { SetSensorTouch(IN_2); NumOut(0, 0, Sensor(IN_2)); SetSensorLowspeed(IN_4); SensorUS(IN_4); }";
    sandbox.write("touch.rxe", compile(source));
    sandbox.write("world.csv", "t_ms,port_2\n0,0\n");
    sandbox.write("scene.toml", mindgap_tests::rooms::SCENE);
    for (options, unconfigured) in [
        ("--readings none", vec![2]),
        ("--readings none --sonar 1", vec![2, 4]),
        ("--readings none --world world.csv", vec![]),
        ("--scene scene.toml", vec![2]),
    ] {
        let called = sandbox.call(&format!("brick touch.rxe {options} --json facts.json --force"));
        assert_eq!(called.code, 0, "{}", called.err);
        let warned = |port: usize| called.err.contains(&format!("the program reads port {port}, which no option"));
        assert!((1..=4).all(|port| warned(port) == unconfigured.contains(&port)), "{options}: {}", called.err);
        assert_eq!(sandbox.json("facts.json")["unconfigured_ports"], serde_json::json!(unconfigured), "{options}");
    }
}

#[test]
fn a_program_drives_a_robot_in_a_scene() {
    let sandbox = with_program();
    sandbox.write("scene.toml", mindgap_tests::rooms::SCENE);
    let output = sandbox.run("brick run.rxe --scene scene.toml --out run.csv --figure path.svg");
    assert!(output.contains("the built-in robot "), "{output}");
    let log = sandbox.text("run.csv");
    assert!(log.starts_with("t_ms,left,right,x_cm,y_cm,heading_deg,echo_cm,"), "{log}");
    let rows: Vec<Vec<&str>> = log.lines().skip(1).map(|row| row.split(',').collect()).collect();
    // One row per step, with the commands that follow. The first row has no reading yet.
    assert_eq!(rows[0][..3], ["0", "55", "48"]);
    assert_eq!((rows[0][6], rows[1][0]), ("", "400"));
    assert!(rows.iter().skip(1).any(|row| !row[6].is_empty()), "{log}");
    assert!(sandbox.text("path.svg").contains("<svg"));
    // The same seed gives the same bytes, another seed another run.
    sandbox.run("brick run.rxe --scene scene.toml --out again.csv");
    assert_eq!(sandbox.text("again.csv"), log);
    sandbox.run("brick run.rxe --scene scene.toml --seed 2 --out other.csv");
    assert_ne!(sandbox.text("other.csv"), log);

    let refused = |options: &str| sandbox.refused(&format!("brick run.rxe {options}"));
    assert!(refused("--scene scene.toml --figure path.txt").starts_with("path.txt: must end with .svg or .png"));
    assert!(refused("--scene scene.toml --start 99").contains("there is no start 99"));
    assert_eq!(sandbox.call("brick run.rxe --scene scene.toml --readings 1").code, 2);
    assert_eq!(sandbox.call("brick run.rxe --readings 1 --sim sim.json").code, 2);
}

#[test]
fn in_a_simulator_a_program_drives_like_its_controller() {
    let sandbox = with_program();
    sandbox.write("scene.toml", mindgap_tests::rooms::SCENE);
    sandbox.run("record --out logs --runs 30 --steps 40");
    sandbox.run("train logs --out sim.json");
    sandbox.run("simulate sim.json controller.toml --scene scene.toml --runs 40 --json runs.json");
    let runs = sandbox.json("runs.json");
    let places = runs["runs"].as_array().unwrap();
    let of_controller =
        |axis: &str| places.iter().map(|run| run["path"][1][axis].as_f64().unwrap()).sum::<f64>() / 40.0;
    let mut of_program = [0.0; 2];
    for seed in 0..10 {
        sandbox.run(&format!("brick run.rxe --scene scene.toml --sim sim.json --seed {seed} --out run-{seed}.csv"));
        let log = sandbox.text(&format!("run-{seed}.csv"));
        let row: Vec<f64> = log.lines().nth(2).unwrap().split(',').map(|cell| cell.parse().unwrap_or(0.0)).collect();
        (of_program[0], of_program[1]) = (of_program[0] + row[3] / 10.0, of_program[1] + row[4] / 10.0);
    }
    // The first step, before readings make the runs diverge.
    for (axis, program_cm) in ["x_cm", "y_cm"].into_iter().zip(of_program) {
        let controller_cm = of_controller(axis);
        assert!((program_cm - controller_cm).abs() < 0.3, "{axis}: {program_cm} and {controller_cm}");
    }
}

#[test]
fn every_start_of_a_controller_adds_a_log() {
    let sandbox = with_program();
    for (options, file) in [("--log", "avoid_000.csv"), ("--log log.csv", "log_000.csv")] {
        sandbox.run(&format!("export controller.toml --format nxc --out avoid.nxc {options}"));
        sandbox.write("avoid.rxe", compile(&sandbox.text("avoid.nxc")));
        let output = sandbox.run("brick avoid.rxe --readings 100,41,60,60");
        assert!(output.contains(&format!("file {file}, ")), "{output}");
    }
    let refused = sandbox.refused("export controller.toml --format nxc --out twelve-chars.nxc --log");
    assert!(refused.contains("twelve-chars.csv") && refused.contains("1 to 11 characters"), "{refused}");
    assert!(
        sandbox
            .refused("export controller.toml --format c --out c.h --stall")
            .contains("a stop distance and a stall check need")
    );
    assert_eq!(sandbox.call("export controller.toml --format rxe --out c.rxe --stop-cm 0").code, 2);
}

#[test]
fn a_script_needs_only_times_and_commands() {
    let sandbox = Sandbox::new();
    sandbox.write("script.csv", "t_ms,left,right\n0,40,40\n400,-30,30\n800,0,0\n");
    sandbox.run("export script.csv --format nxc-collect --out script.nxc");
    let source = sandbox.text("script.nxc");
    assert!(source.contains("The robot does\n// not look where it drives"), "{source}");
    sandbox.write("script.rxe", compile(&source));
    let output = sandbox.run("brick script.rxe --readings 100,100,100,100");
    assert!(output.contains("motor B  40") && output.contains("motor B  -30"), "{output}");
}

#[test]
fn a_collecting_program_logs_runs() {
    let sandbox = Sandbox::new();
    let output = sandbox.run("export --format nxc-collect --steps 12 --seed 5 --out collect.nxc");
    assert!(output.starts_with("collect.nxc written\nprogram ") && output.contains("\nlog "), "{output}");
    sandbox.write("collect.rxe", compile(&sandbox.text("collect.nxc")));
    let far = vec!["200"; 13].join(",");
    let output = sandbox.run(&format!("brick collect.rxe --readings {far} --json facts.json"));
    assert!(output.contains("file run-000.csv, "), "{output}");
    let facts = sandbox.json("facts.json");
    let log = facts["files"]["run-000.csv"].as_str().unwrap();
    assert_eq!(log.lines().count(), 1 + 13, "{log}");

    sandbox.run("export --format nxc-collect --steps 12 --seed 6 --out other.nxc");
    assert_ne!(sandbox.text("other.nxc").replace("other", "collect"), sandbox.text("collect.nxc"));
}

#[test]
fn an_impossible_collecting_program_is_refused() {
    let sandbox = with_program();
    let refused = |options: &str| sandbox.refused(&format!("export {options} --out c.nxc"));
    assert_eq!(refused("--format nxc-collect --steps 0"), "c.nxc: steps is 0; it has to be in 1..65535");
    assert!(refused("--format nxc-collect --near-cm 0").starts_with("c.nxc: near_cm is 0"));
    assert!(refused("--format nxc-collect --step-ms 50").starts_with("c.nxc: "));
    assert!(refused("--format nxc-collect --steps 60000").starts_with("c.nxc: "));
    let no_script = refused("controller.toml --format nxc-collect");
    assert!(no_script.starts_with("controller.toml:1: columns t_ms, left, right are missing"), "{no_script}");
    assert_eq!(sandbox.call("export --format nxc --out c.nxc").code, 2);
}
