//! The .rxe writer is compared with the decompiler and assembler of the real compiler, and with its budget.

use std::path::Path;
use std::process::Command;

use mindgap_controller_export::brick::{
    self, EventKind, Program, Report, RunConfig, ScriptedWorld, Sonar, Termination,
};
use mindgap_controller_export::onboard::Safety;
use mindgap_controller_export::wiring::{MotorPort, Wiring};
use mindgap_controller_export::{ExportError, rxe};
use mindgap_core::controller::Controller;
use mindgap_tests::controllers::at_its_limits;

const MAX_FILE_BYTES: usize = 2_500;
const MAX_POOL_BYTES: usize = 1_024;
/// Most of them check the orange button during the step.
const MAX_INSTRUCTIONS_PER_STEP: u64 = 500;

fn run(file: &[u8], sonar: &[Sonar]) -> Report {
    brick::run(&Program::load(file).unwrap(), &mut ScriptedWorld::sonar(sonar), &RunConfig::default())
}

fn nbc(arguments: &[&str], folder: &Path) -> String {
    let output = Command::new("nbc").args(arguments).current_dir(folder).output();
    let output = output.expect("the NXC compiler is missing: apt-get install nbc");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn compiler_decompiles_and_reassembles_the_file() {
    let written = rxe::program(&at_its_limits(), &Wiring::default(), Safety::default()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("own.rxe"), &written).unwrap();
    let text = nbc(&["-x", "own.rxe", "-O=own.nbc"], folder.path());
    for line in [
        "sbyte[]\t0x37, 0x9C, 0x64, 0x0, 0x7, 0x3C",
        "syscall\tCommLSCheckStatus",
        "UpdateFlags",
        "syscall\tReadButton",
        "stop\tNA",
    ] {
        assert!(text.contains(line), "{line} is missing in\n{text}");
    }
    nbc(&["-v=128", "-sm-", "-O=again.rxe", "own.nbc"], folder.path());
    let again = std::fs::read(folder.path().join("again.rxe")).expect("nbc reported success and wrote nothing");
    let sonar = [50, 41, 255, 0, 1, 254, 255, 0, 129].map(Sonar::Echo);
    let (first, second) = (run(&written, &sonar), run(&again, &sonar));
    assert_eq!((first.end, first.events), (second.end, second.events));
}

#[test]
fn program_keeps_its_budget() {
    for max_steps in [1, u16::MAX] {
        let file =
            rxe::program(&Controller { max_steps, ..at_its_limits() }, &Wiring::default(), Safety::default()).unwrap();
        assert!(file.len() <= MAX_FILE_BYTES, "{} bytes", file.len());
        let report = run(&file, &[Sonar::Echo(50)]);
        assert!(report.pool_bytes <= MAX_POOL_BYTES, "{} bytes of memory", report.pool_bytes);
    }
}

#[test]
fn no_step_takes_more_instructions_than_budgeted() {
    let file = rxe::program(&at_its_limits(), &Wiring::default(), Safety::default()).unwrap();
    let instructions = |sonar: &[Sonar]| run(&file, &[&[Sonar::Echo(60)][..], sonar].concat()).instructions;
    let hangs_once = [Sonar::Hangs, Sonar::Echo(0), Sonar::Hangs, Sonar::Echo(1)];
    for sonar in [&[Sonar::Echo(41), Sonar::Echo(1), Sonar::Echo(0)][..], &[Sonar::Echo(255); 5], &hangs_once] {
        for steps in 1..=sonar.len() {
            let step = instructions(&sonar[..steps]) - instructions(&sonar[..steps - 1]);
            assert!(step < MAX_INSTRUCTIONS_PER_STEP, "{step} instructions in step {steps} of {sonar:?}");
        }
    }
}

#[test]
fn dead_sensor_stops_the_motors_within_two_steps() {
    let file = rxe::program(&at_its_limits(), &Wiring::default(), Safety::default()).unwrap();
    for dead in [Sonar::Silent, Sonar::Hangs] {
        let report = run(&file, &[Sonar::Echo(60), dead, dead]);
        let moved = || report.events.iter().filter(|event| matches!(event.kind, EventKind::Motor { .. }));
        let stopped_ms = moved().next_back().unwrap().t_ms - moved().next().unwrap().t_ms;
        assert_eq!(report.end, Termination::Finished);
        assert!((1200..1260).contains(&stopped_ms), "{stopped_ms}");
    }
    // A single lost answer does not stop the robot.
    assert!(run(&file, &[Sonar::Silent, Sonar::Echo(60), Sonar::Silent, Sonar::Echo(60)]).ended_ms > 6 * 400);
}

#[test]
fn impossible_program_is_rejected() {
    let hasty = Controller { step_ms: 1, ..at_its_limits() };
    assert!(matches!(
        rxe::program(&hasty, &Wiring::default(), Safety::default()),
        Err(ExportError::StepTooShort { step_ms: 1, .. })
    ));
    let wiring = Wiring { right: MotorPort::B, ..Wiring::default() };
    assert_eq!(rxe::program(&at_its_limits(), &wiring, Safety::default()), Err(ExportError::OnePortForTwoMotors('B')));
}
