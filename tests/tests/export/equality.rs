//! Onboard programs behave like the core's machine: same tuples, same commands, same ending, at the same times.

use mindgap_controller_export::brick::{
    self, Drive, Event, EventKind, Program, Report, RunConfig, ScriptedWorld, Sonar, Termination,
};
use mindgap_controller_export::names::{BrickName, RunLogs};
use mindgap_controller_export::nxc::{self, NxcOptions};
use mindgap_controller_export::onboard::{Ending, FAILED_STEPS_TO_STOP, NO_ECHO_CM, SONAR_TIMEOUT_MS, Safety};
use mindgap_controller_export::wiring::{MotorPort, SensorPort, Wiring};
use mindgap_controller_export::{Origin, rxe};
use mindgap_core::controller::{Controller, Machine, Motors, Status, Tuple, When};
use mindgap_tests::nbc::compile;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};

/// Number of runs of programs of the .rxe writer, each with a different controller.
const RUNS: u32 = 10_000;
/// Number of controllers that are compiled by the real compiler, and of runs of each. The environment variable
/// `MINDGAP_CONTROLLERS` sets another number of controllers, each of which then runs a few times.
const COMPILED: usize = 24;
const RUNS_OF_COMPILED: u32 = 100;
const RUNS_OF_MANY: u32 = 3;
/// Time from a step's tick to its motor commands when the sensor answers.
const LATENCY_MS: u32 = 15;
/// Largest difference between the times of two programs.
const JITTER_MS: u32 = 5;

/// Motor commands and the step at which they are given. Both commands are zero at the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Change {
    step: u32,
    motors: Motors,
}

/// Any distance, and often one of a few that coincide.
fn distances_cm() -> impl Strategy<Value = u8> {
    prop_oneof![any::<u8>(), 100..=102u8]
}

fn tuples() -> impl Strategy<Value = Tuple> {
    let when = prop_oneof![Just(When::Larger), Just(When::Smaller)];
    (-100..=100i8, -100..=100i8, when, 0..=255i16).prop_map(|(left, right, when, threshold_cm)| Tuple {
        left,
        right,
        when,
        threshold_cm,
    })
}

/// Returns the shortest step time of a program without log and display.
fn min_step_ms() -> u16 {
    let hasty = Controller { step_ms: 1, ..mindgap_tests::controllers::at_its_limits() };
    let [rxe, nxc] = [rxe::budget(&hasty, Safety::default()), nxc::budget(&hasty, &options())].map(|b| b.worst_step_ms);
    assert_eq!(rxe, nxc, "both formats have the same limit");
    rxe
}

fn options() -> NxcOptions {
    NxcOptions::new(BrickName::program("run").unwrap())
}

fn controllers() -> impl Strategy<Value = Controller> {
    let min_ms = min_step_ms();
    let step_ms = prop_oneof![1 => min_ms..min_ms + 3, 3 => min_ms..1000];
    (step_ms, 1..50u16, prop::array::uniform6(tuples())).prop_map(|(step_ms, max_steps, tuples)| Controller {
        step_ms,
        max_steps,
        tuples,
    })
}

fn readings() -> impl Strategy<Value = Vec<Sonar>> {
    let answer = prop_oneof![
        30 => distances_cm().prop_map(Sonar::Echo),
        8 => Just(Sonar::Echo(NO_ECHO_CM)),
        2 => Just(Sonar::Silent),
        1 => Just(Sonar::Hangs),
    ];
    prop::collection::vec(answer, 50)
}

fn runner(cases: u32, rng: TestRng) -> TestRunner {
    TestRunner::new_with_rng(ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }, rng)
}

fn rng() -> TestRng {
    TestRng::deterministic_rng(RngAlgorithm::XorShift)
}

/// Returns what the core's machine does, with the rule that ends a run when the sensor is dead.
fn expected(controller: &Controller, sonar: &[Sonar]) -> (Vec<Change>, Ending) {
    let mut machine = Machine::start(controller);
    let mut changes = vec![Change { step: 0, motors: machine.motors() }];
    let mut failed_steps = 0;
    for (step, answer) in (1..).zip(sonar) {
        let tuple = machine.tuple();
        let reading_cm = match answer {
            Sonar::Echo(NO_ECHO_CM) | Sonar::Silent | Sonar::Hangs => None,
            Sonar::Echo(echo_cm) => Some(i16::from(*echo_cm)),
        };
        failed_steps = if matches!(answer, Sonar::Echo(_)) { 0 } else { failed_steps + 1 };
        let status = machine.step(reading_cm);
        let is_over = status != Status::Running || failed_steps == FAILED_STEPS_TO_STOP;
        if is_over {
            changes.push(Change { step, motors: Motors { left: 0, right: 0 } });
            let ending = match status {
                Status::Finished => Ending::Finished,
                _ if failed_steps == FAILED_STEPS_TO_STOP => Ending::SonarDead,
                _ => Ending::TimedOut,
            };
            return (changes, ending);
        }
        if machine.tuple() != tuple {
            changes.push(Change { step, motors: machine.motors() });
        }
    }
    panic!("the script is longer than any run");
}

fn run(program: &Program, wiring: &Wiring, sonar: &[Sonar]) -> Report {
    let mut world = ScriptedWorld { sonar_port: wiring.sonar as usize, ..ScriptedWorld::sonar(sonar) };
    brick::run(program, &mut world, &RunConfig::default())
}

/// Returns the motor commands of a run, left and right together, with their times.
fn commands(report: &Report, wiring: &Wiring) -> Vec<(u32, Drive, Drive)> {
    let drives = report.events.iter().filter_map(|Event { t_ms, kind }| match kind {
        EventKind::Motor { port, drive } => Some((*t_ms, *port, *drive)),
        _ => None,
    });
    let drives: Vec<_> = drives.collect();
    let (pairs, rest) = drives.as_chunks::<2>();
    assert!(rest.is_empty(), "a command for one motor only: {drives:?}");
    let pair = |[(t_ms, left, left_drive), (_, right, right_drive)]: &[(u32, usize, Drive); 2]| {
        assert_eq!([*left, *right], [wiring.left as usize, wiring.right as usize]);
        (*t_ms, *left_drive, *right_drive)
    };
    pairs.iter().map(pair).collect()
}

fn drive(command: i8) -> Drive {
    if command == 0 { Drive::Brake } else { Drive::Power(command) }
}

/// Compares a run with the core's machine, and its times with its steps.
fn check(controller: &Controller, wiring: &Wiring, sonar: &[Sonar], report: &Report) {
    let (changes, ending) = expected(controller, sonar);
    assert_eq!(report.end, Termination::Finished);
    let commands = commands(report, wiring);
    let drives: Vec<_> = commands.iter().map(|(_, left, right)| (*left, *right)).collect();
    let expected: Vec<_> = changes.iter().map(|c| (drive(c.motors.left), drive(c.motors.right))).collect();
    assert_eq!(drives, expected);

    let start_ms = commands[0].0;
    for (change, (t_ms, ..)) in changes.iter().zip(&commands).skip(1) {
        let tick_ms = start_ms + change.step * u32::from(controller.step_ms);
        let dead = matches!(sonar[change.step as usize - 1], Sonar::Hangs);
        let late_ms = if dead { u32::from(SONAR_TIMEOUT_MS) } else { 0 } + LATENCY_MS;
        assert!((tick_ms..tick_ms + late_ms).contains(t_ms), "step {} at {t_ms}, tick {tick_ms}", change.step);
    }

    let tone_hz = report.events.iter().find_map(|event| match event.kind {
        EventKind::Tone { hz, .. } => Some(hz),
        _ => None,
    });
    let text = report.events.iter().rev().find_map(|event| match &event.kind {
        EventKind::Text { text, .. } => Some(text.as_str()),
        _ => None,
    });
    assert_eq!((tone_hz, text), (Some(ending.hz()), Some(ending.text())));
    assert_eq!(report.motors[wiring.left as usize], Drive::Brake);
    assert_eq!(report.motors[wiring.right as usize], Drive::Brake);
}

#[test]
fn written_bytecode_behaves_like_the_core() {
    let outcome = runner(RUNS, rng()).run(&(controllers(), readings()), |(controller, sonar)| {
        let wiring = Wiring::default();
        let program = Program::load(&rxe::program(&controller, &wiring, Safety::default()).unwrap()).unwrap();
        check(&controller, &wiring, &sonar, &run(&program, &wiring, &sonar));
        Ok(())
    });
    outcome.unwrap();
}

#[test]
fn compiled_nxc_behaves_like_the_core_and_the_written_bytecode() {
    let other = Wiring { left: MotorPort::A, right: MotorPort::B, sonar: SensorPort::Two };
    let mut chance = runner(1, rng());
    let many = std::env::var("MINDGAP_CONTROLLERS").ok().map(|number| number.parse().expect("a number of controllers"));
    let runs = if many.is_some() { RUNS_OF_MANY } else { RUNS_OF_COMPILED };
    for number in 0..many.unwrap_or(COMPILED) {
        let controller = controllers().new_tree(&mut chance).unwrap().current();
        let wiring = if number % 2 == 0 { Wiring::default() } else { other };
        let log = (number % 4 >= 2).then(|| RunLogs::named_after(&"run.csv".parse().unwrap()).unwrap());
        let options = NxcOptions { wiring, display: log.is_some(), log, ..options() };
        let source = nxc::program(&controller, &Origin::default(), &options).unwrap();
        let compiled = Program::load(&compile(&source)).unwrap();
        let written = Program::load(&rxe::program(&controller, &wiring, Safety::default()).unwrap()).unwrap();
        let outcome = runner(runs, chance.new_rng()).run(&readings(), |sonar| {
            let compiled_run = run(&compiled, &wiring, &sonar);
            check(&controller, &wiring, &sonar, &compiled_run);
            if options.log.is_some() {
                check_log(&controller, &sonar, &compiled_run);
            }
            let written_run = run(&written, &wiring, &sonar);
            let times = |report| commands(report, &wiring).into_iter().map(|(t_ms, ..)| t_ms);
            for (compiled_ms, written_ms) in times(&compiled_run).zip(times(&written_run)) {
                assert!(compiled_ms.abs_diff(written_ms) <= JITTER_MS, "{compiled_ms} and {written_ms}");
            }
            Ok(())
        });
        outcome.unwrap();
    }
}

/// Checks that the log has one row per step: the commands from then on, and the reading that led to them.
fn check_log(controller: &Controller, sonar: &[Sonar], report: &Report) {
    let (changes, _) = expected(controller, sonar);
    let log = String::from_utf8(report.files["run_000.csv"].clone()).unwrap();
    let mut rows = log.split("\r\n");
    assert_eq!(rows.next(), Some("t_ms,left,right,rot_left_deg,rot_right_deg,battery_mv,echo_cm"));
    let steps = changes.last().unwrap().step;
    let mut motors = changes[0].motors;
    for step in 0..=steps {
        if let Some(change) = changes.iter().find(|change| change.step == step) {
            motors = change.motors;
        }
        let reading = match step.checked_sub(1).map(|request| sonar[request as usize]) {
            None | Some(Sonar::Silent | Sonar::Hangs | Sonar::Echo(NO_ECHO_CM)) => String::new(),
            Some(Sonar::Echo(echo_cm)) => echo_cm.to_string(),
        };
        let row = rows.next().unwrap();
        let (t_ms, rest) = row.split_once(',').unwrap();
        let tick_ms = step * u32::from(controller.step_ms);
        let late_ms = t_ms.parse::<u32>().unwrap() - tick_ms;
        assert!(late_ms < u32::from(SONAR_TIMEOUT_MS) + LATENCY_MS, "{row}");
        let commands = format!("{},{},", motors.left, motors.right);
        let rotations: Vec<&str> = rest.strip_prefix(&commands).expect(row).split(',').collect();
        assert!(rotations.len() == 4 && rotations[..2].iter().all(|deg| deg.parse::<i32>().is_ok()), "{row}");
        assert_eq!(rotations[2..], ["7800", &reading], "{row}");
    }
    assert_eq!((rows.next(), rows.next()), (Some(""), None), "rows after the last step");
}
