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
    assert!(told.contains("text     \"finished\" at 0, 24") && told.contains("tone     880 Hz"), "{told}");
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
    assert!(listed.contains("of 5 readings"), "{listed}");
}

#[test]
fn it_ends_whatever_the_program_does() {
    let workshop = with_program();
    let cut = workshop.done("brick run.rxe --readings 100,100,100,100 --limit-ms 1000");
    assert!(cut.contains("still running, stopped after 1000 ms"), "{cut}");
    let aborted = workshop.done("brick run.rxe --readings 100,100,100,100 --exit-ms 700");
    assert!(
        aborted.contains("aborted by the dark button after 700 ms; motors: A coast, B coast, C coast"),
        "{aborted}"
    );
    workshop.write("ever.rxe", compile("task main() { while (true) OnFwd(OUT_A, 30); }"));
    let ever = workshop.done("brick ever.rxe --readings none --limit-ms 50");
    assert!(ever.contains("stopped after 50 ms"), "{ever}");
}

#[test]
fn what_cannot_run_is_refused() {
    let workshop = with_program();
    let program = workshop.bytes("run.rxe");
    for length in [0, 13, 37, 60, program.len() / 2, program.len() - 1] {
        workshop.write("torn.rxe", &program[..length]);
        let problem = workshop.refused("brick torn.rxe --readings none");
        assert!(problem.starts_with("torn.rxe: is not a program that an NXT can run: "), "{problem}");
    }
    assert!(workshop.refused("brick none.rxe --readings 1").starts_with("none.rxe: cannot be read: "));
    assert_eq!(
        workshop.refused("brick run.rxe --readings 12,far"),
        "--readings \"12,far\" is not a file, and as a list it has a reading that is \"far\", \
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
    workshop.write("world.csv", "t_ms,port_1\n0,200\n");
    assert_eq!(
        workshop.refused("brick run.rxe --readings none --world world.csv"),
        "world.csv:2: port_1 = \"200\" is not a whole number from 0 to 100"
    );
}

#[test]
fn a_program_that_fails_says_where() {
    let workshop = Workshop::new();
    workshop.write("fails.rxe", compile("task main() { int a[] = {1}; int i = 5; NumOut(0, LCD_LINE1, a[i]); }"));
    let told = workshop.done("brick fails.rxe --readings none --json facts.json");
    assert!(told.contains("failed: wrong operand or index after ") && told.contains(" of clump 0: index\n"), "{told}");
    assert_eq!(workshop.json("facts.json")["failed_at"]["instruction"], "index");
}

#[test]
fn a_program_that_writes_for_ever_takes_neither_memory_nor_output() {
    let workshop = Workshop::new();
    let source = "task main() { string s = \"01234567\"; repeat(8) s = StrCat(s, s); while (true) TextOut(0, 0, s); }";
    workshop.write("ever.rxe", compile(source));
    let told = workshop.done("brick ever.rxe --readings none --limit-events 5");
    assert_eq!(told.matches("text     \"0123456701234567\" at 0, 0").count(), 5, "{told}");
    assert!(told.contains(" more events (--limit-events)"), "{told}");
}

#[test]
fn buttons_and_sensors_come_from_a_script() {
    let workshop = with_program();
    workshop.write("world.csv", "t_ms,orange\n0,0\n1000,1\n1001,0\n");
    let told = workshop.done("brick run.rxe --readings 100,100,100,100,100,100 --world world.csv");
    assert!(told.contains("\"stopped\""), "{told}");
    let source = "task main() { SetSensorTouch(IN_1); while (!Sensor(IN_1)) Wait(1); NumOut(0, 0, CurrentTick() - FirstTick()); }";
    workshop.write("touch.rxe", compile(source));
    workshop.write("world.csv", "t_ms,port_1\n0,0\n700,1\n");
    let told = workshop.done("brick touch.rxe --readings none --world world.csv");
    assert!(told.contains("text     \"70"), "{told}");
}

#[test]
fn a_program_drives_a_robot_in_a_scene() {
    let workshop = with_program();
    workshop.write("scene.toml", mindgap_tests::rooms::SCENE);
    let told = workshop.done("brick run.rxe --scene scene.toml --out run.csv --figure path.svg");
    assert!(told.contains("the built-in robot "), "{told}");
    let log = workshop.text("run.csv");
    assert!(log.starts_with("t_ms,left,right,x_cm,y_cm,heading_deg,echo_cm,"), "{log}");
    let rows: Vec<Vec<&str>> = log.lines().skip(1).map(|row| row.split(',').collect()).collect();
    // A row a step, with the commands from there on; at the first no reading has been taken.
    assert_eq!(rows[0][..3], ["0", "55", "48"]);
    assert_eq!((rows[0][6], rows[1][0]), ("", "400"));
    assert!(rows.iter().skip(1).any(|row| !row[6].is_empty()), "{log}");
    assert!(workshop.text("path.svg").contains("<svg"));
    // The same seed, the same bytes; another one, another run.
    workshop.done("brick run.rxe --scene scene.toml --out again.csv");
    assert_eq!(workshop.text("again.csv"), log);
    workshop.done("brick run.rxe --scene scene.toml --seed 2 --out other.csv");
    assert_ne!(workshop.text("other.csv"), log);

    let refused = |options: &str| workshop.refused(&format!("brick run.rxe {options}"));
    assert!(refused("--scene scene.toml --figure path.txt").starts_with("path.txt: must end with .svg or .png"));
    assert!(refused("--scene scene.toml --start 99").contains("there is no start 99"));
    assert_eq!(workshop.call("brick run.rxe --scene scene.toml --readings 1").code, 2);
    assert_eq!(workshop.call("brick run.rxe --readings 1 --sim sim.json").code, 2);
}

#[test]
fn in_a_simulator_a_program_drives_as_its_controller_does() {
    let workshop = with_program();
    workshop.write("scene.toml", mindgap_tests::rooms::SCENE);
    workshop.done("record --out logs --runs 30 --steps 40");
    workshop.done("train logs --out sim.json");
    workshop.done("simulate sim.json controller.toml --scene scene.toml --runs 40 --json runs.json");
    let runs = workshop.json("runs.json");
    let places = runs["runs"].as_array().unwrap();
    let of_controller =
        |axis: &str| places.iter().map(|run| run["path"][1][axis].as_f64().unwrap()).sum::<f64>() / 40.0;
    let mut of_program = [0.0; 2];
    for seed in 0..10 {
        workshop.done(&format!("brick run.rxe --scene scene.toml --sim sim.json --seed {seed} --out run-{seed}.csv"));
        let log = workshop.text(&format!("run-{seed}.csv"));
        let row: Vec<f64> = log.lines().nth(2).unwrap().split(',').map(|cell| cell.parse().unwrap_or(0.0)).collect();
        (of_program[0], of_program[1]) = (of_program[0] + row[3] / 10.0, of_program[1] + row[4] / 10.0);
    }
    // After the first step, before readings part the runs.
    for (axis, program_cm) in ["x_cm", "y_cm"].into_iter().zip(of_program) {
        let controller_cm = of_controller(axis);
        assert!((program_cm - controller_cm).abs() < 0.3, "{axis}: {program_cm} and {controller_cm}");
    }
}

#[test]
fn every_start_of_a_controller_adds_a_log() {
    let workshop = with_program();
    for (options, file) in [("--log", "avoid_000.csv"), ("--log log.csv", "log_000.csv")] {
        workshop.done(&format!("export controller.toml --format nxc --out avoid.nxc {options}"));
        workshop.write("avoid.rxe", compile(&workshop.text("avoid.nxc")));
        let told = workshop.done("brick avoid.rxe --readings 100,41,60,60");
        assert!(told.contains(&format!("file {file}, ")), "{told}");
    }
    let refused = workshop.refused("export controller.toml --format nxc --out twelve-chars.nxc --log");
    assert!(refused.contains("twelve-chars.csv") && refused.contains("1 to 11 characters"), "{refused}");
    assert!(
        workshop.refused("export controller.toml --format c --out c.h --stall").starts_with("--stop-cm and --stall")
    );
    assert_eq!(workshop.call("export controller.toml --format rxe --out c.rxe --stop-cm 0").code, 2);
}

#[test]
fn a_script_needs_times_and_commands_alone() {
    let workshop = Workshop::new();
    workshop.write("script.csv", "t_ms,left,right\n0,40,40\n400,-30,30\n800,0,0\n");
    workshop.done("export script.csv --format nxc-collect --out script.nxc");
    let source = workshop.text("script.nxc");
    assert!(source.contains("The robot does not\n// look where it drives"), "{source}");
    workshop.write("script.rxe", compile(&source));
    let told = workshop.done("brick script.rxe --readings 100,100,100,100");
    assert!(told.contains("motor B  40") && told.contains("motor B  -30"), "{told}");
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
    assert_eq!(refused("--format nxc-collect --steps 0"), "c.nxc: steps is 0; it has to be in 1..65535");
    assert!(refused("--format nxc-collect --near-cm 0").starts_with("c.nxc: near_cm is 0"));
    assert!(refused("--format nxc-collect --step-ms 50").starts_with("c.nxc: "));
    assert!(refused("--format nxc-collect --steps 60000").starts_with("c.nxc: "));
    let no_script = refused("controller.toml --format nxc-collect");
    assert!(no_script.starts_with("controller.toml:1: columns t_ms, left, right are missing"), "{no_script}");
    assert_eq!(workshop.call("export --format nxc --out c.nxc").code, 2);
}
