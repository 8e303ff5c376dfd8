//! Safety of the robot and its surroundings in both formats: a check of the sensor before driving, immediate stops, and logs
//! that replace no file.

use std::collections::BTreeMap;

use mindgap_controller_export::brick::{
    self, Drive, EventKind, Press, Program, Report, RunConfig, ScriptedWorld, Sonar, Termination,
};
use mindgap_controller_export::collect::{self, CollectOptions, Commands};
use mindgap_controller_export::names::{BrickName, RunLogs};
use mindgap_controller_export::nxc::{self, NxcOptions};
use mindgap_controller_export::onboard::{BUTTON_POLL_MS, Ending, Safety};
use mindgap_controller_export::wiring::Wiring;
use mindgap_controller_export::{Origin, rxe};
use mindgap_core::controller::Controller;
use mindgap_tests::controllers::at_its_limits;
use mindgap_tests::nbc::compile;

const STEPS: usize = 12;
/// Readings that end no tuple.
const FAR: [Sonar; STEPS] = [Sonar::Echo(60); STEPS];

fn controller() -> Controller {
    Controller { max_steps: STEPS as u16, ..at_its_limits() }
}

fn options(safety: Safety) -> NxcOptions {
    NxcOptions { safety, ..NxcOptions::new(BrickName::program("run").unwrap()) }
}

fn nxc_program(options: &NxcOptions) -> Program {
    Program::load(&compile(&nxc::program(&controller(), &Origin::default(), options).unwrap())).unwrap()
}

/// The controller in both formats.
fn programs(safety: Safety) -> [Program; 2] {
    let written = rxe::program(&controller(), &Wiring::default(), safety).unwrap();
    [nxc_program(&options(safety)), Program::load(&written).unwrap()]
}

fn run(program: &Program, mut world: ScriptedWorld) -> Report {
    brick::run(program, &mut world, &RunConfig::default())
}

/// Returns the times of the motor commands, left and right together.
fn driven_ms(report: &Report) -> Vec<u32> {
    let is_left = |kind: &EventKind| matches!(kind, EventKind::Motor { port: 1, .. });
    report.events.iter().filter(|event| is_left(&event.kind)).map(|event| event.t_ms).collect()
}

#[track_caller]
fn assert_ending(report: &Report, ending: Ending) {
    let reports = |kind: &EventKind| match kind {
        EventKind::Text { text, .. } => text == ending.text(),
        EventKind::Tone { hz, .. } => *hz == ending.hz(),
        _ => false,
    };
    let count = report.events.iter().filter(|event| reports(&event.kind)).count();
    assert_eq!((report.end, count), (Termination::Finished, 2), "{ending:?}: {report:?}");
}

#[test]
fn nothing_moves_unless_the_sensor_answers() {
    for program in programs(Safety::default()) {
        let on_another_port = ScriptedWorld { sonar_port: 0, ..ScriptedWorld::sonar(FAR) };
        for world in [ScriptedWorld::sonar([]), ScriptedWorld::sonar([Sonar::Hangs; 9]), on_another_port] {
            let report = run(&program, world);
            assert_ending(&report, Ending::NoSonar);
            assert!(driven_ms(&report).is_empty(), "{report:?}");
        }
        // The check takes no reading: the first one is that of the first step.
        let mut world = ScriptedWorld::sonar(FAR);
        let report = brick::run(&program, &mut world, &RunConfig::default());
        assert_ending(&report, Ending::TimedOut);
        assert_eq!(world.requests, STEPS);
    }
}

#[test]
fn orange_button_stops_at_once() {
    for program in programs(Safety::default()) {
        let start_ms = driven_ms(&run(&program, ScriptedWorld::sonar(FAR)))[0];
        for pressed_ms in (start_ms + 1..start_ms + 1_700).step_by(37) {
            for held_ms in [1, 300] {
                let press = Press::orange(pressed_ms, pressed_ms + held_ms);
                let report = run(&program, ScriptedWorld { presses: vec![press], ..ScriptedWorld::sonar(FAR) });
                assert_ending(&report, Ending::Stopped);
                let stopped_ms = *driven_ms(&report).last().unwrap();
                let at_once = pressed_ms..=pressed_ms + u32::from(BUTTON_POLL_MS) + 5;
                assert!(at_once.contains(&stopped_ms), "pressed at {pressed_ms}, stopped at {stopped_ms}");
                assert_eq!(report.motors[1..], [Drive::Brake; 2]);
            }
        }
        // The press that starts the program does not stop it, however long it is. One while the sensor warms up does.
        let started = Press::orange(0, 900);
        let report = run(&program, ScriptedWorld { presses: vec![started], ..ScriptedWorld::sonar(FAR) });
        assert_ending(&report, Ending::TimedOut);
        assert!(driven_ms(&report)[0] > 900);
        let early = vec![Press::orange(0, 50), Press::orange(100, 110)];
        let report = run(&program, ScriptedWorld { presses: early, ..ScriptedWorld::sonar(FAR) });
        assert_ending(&report, Ending::Stopped);
        assert!(
            !report.events.iter().any(|event| matches!(event.kind, EventKind::Motor { drive: Drive::Power(_), .. }))
        );
    }
}

#[test]
fn near_obstacle_and_stalled_wheels_stop_it_if_asked_to() {
    let near = || ScriptedWorld::sonar([Sonar::Echo(60), Sonar::Echo(43), Sonar::Echo(44)]);
    let blocked = || ScriptedWorld { wheels_blocked: true, ..ScriptedWorld::sonar(FAR) };
    for program in programs(Safety { stop_cm: Some(44), stall: true }) {
        let report = run(&program, near());
        assert_ending(&report, Ending::Near);
        let driven_ms = driven_ms(&report);
        assert!((800..830).contains(&(driven_ms.last().unwrap() - driven_ms[0])), "{driven_ms:?}");
        let report = run(&program, blocked());
        assert_ending(&report, Ending::Stalled);
        assert!(report.ended_ms < 4_000, "{}", report.ended_ms);
        assert_ending(&run(&program, ScriptedWorld::sonar(FAR)), Ending::TimedOut);
    }
    for program in programs(Safety::default()) {
        assert_ending(&run(&program, blocked()), Ending::TimedOut);
        let near = ScriptedWorld::sonar([Sonar::Echo(43); STEPS]);
        assert_ending(&run(&program, near), Ending::TimedOut);
    }
}

#[test]
fn clock_wraparound_changes_nothing() {
    let collected = collect::program(&CollectOptions {
        program: BrickName::program("collect").unwrap(),
        wiring: Wiring::default(),
        safety: Safety::default(),
        step_ms: 400,
        commands: Commands::Random { steps: STEPS as u16, near_cm: 40, seed: 1 },
    });
    let collector = Program::load(&compile(&collected.unwrap())).unwrap();
    for program in programs(Safety::default()).into_iter().chain([collector]) {
        let report = |start_tick_ms| {
            let config = RunConfig { start_tick_ms, ..RunConfig::default() };
            brick::run(&program, &mut ScriptedWorld::sonar(FAR), &config)
        };
        let usual = report(5_000);
        for before_ms in [1, 100, 250, 1_000, 1_077, 2_500] {
            assert_eq!(report(u32::MAX - before_ms).events, usual.events, "{before_ms}");
        }
    }
}

#[test]
fn every_start_logs_to_a_new_file() {
    let log = Some(RunLogs::named_after(&"run.csv".parse().unwrap()).unwrap());
    let program = nxc_program(&NxcOptions { log, ..options(Safety::default()) });
    let collected = BTreeMap::from([("run-000.csv".to_owned(), b"collected".to_vec())]);
    let start = |files| {
        let config = RunConfig { files, ..RunConfig::default() };
        brick::run(&program, &mut ScriptedWorld::sonar(FAR), &config).files
    };
    let once = start(collected);
    let twice = start(once.clone());
    assert_eq!(twice.keys().collect::<Vec<_>>(), ["run-000.csv", "run_000.csv", "run_001.csv"]);
    assert_eq!(twice["run-000.csv"], b"collected");
    assert_eq!(twice["run_000.csv"], once["run_000.csv"]);
    assert_eq!(String::from_utf8_lossy(&once["run_000.csv"]).lines().count(), 1 + 1 + STEPS);

    // The flash may be fuller than it was when the program was exported.
    let config = RunConfig { flash_bytes: 512, ..RunConfig::default() };
    let report = brick::run(&program, &mut ScriptedWorld::sonar(FAR), &config);
    assert_ending(&report, Ending::NoRoom);
    assert!(driven_ms(&report).is_empty() && report.files.is_empty());
}
