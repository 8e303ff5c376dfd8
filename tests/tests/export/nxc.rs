//! NXC programs are compiled by the real compiler, `nbc`.

use mindgap_controller_export::collect::{self, CollectOptions, Commands};
use mindgap_controller_export::names::{BrickName, RunLogs};
use mindgap_controller_export::nxc::{self, NxcOptions};
use mindgap_controller_export::onboard::Safety;
use mindgap_controller_export::wiring::{MotorPort, SensorPort, Wiring};
use mindgap_controller_export::{ExportError, Origin};
use mindgap_core::controller::Controller;
use mindgap_tests::controllers::at_its_limits;
use mindgap_tests::nbc::compile;

/// The file version of firmware 1.28 and later.
const FILE_VERSION: u8 = 6;

fn options() -> NxcOptions {
    NxcOptions::new(BrickName::program("avoid").unwrap())
}

fn full_options() -> NxcOptions {
    let log = Some(RunLogs::named_after(&"avoid.csv".parse().unwrap()).unwrap());
    NxcOptions { log, display: true, safety: Safety { stop_cm: Some(15), stall: true }, ..options() }
}

#[test]
fn nbc_accepts_every_kind_of_program() {
    let other_ports = Wiring { left: MotorPort::C, right: MotorPort::A, sonar: SensorPort::One };
    let sizes = [
        options(),
        NxcOptions { wiring: other_ports, ..options() },
        NxcOptions { display: true, ..options() },
        full_options(),
    ]
    .map(|options| {
        let rxe = compile(&nxc::program(&at_its_limits(), &Origin::default(), &options).unwrap());
        assert_eq!(&rxe[..14], b"MindstormsNXT\0");
        assert_eq!(rxe[15], FILE_VERSION);
        rxe.len()
    });
    assert_eq!(sizes[0], sizes[1], "ports do not change the size");
    assert!(sizes[1] < sizes[2] && sizes[2] < sizes[3], "{sizes:?}");
    assert!(sizes[3] < 9000, "{sizes:?}");
}

#[test]
fn first_lines_state_the_origin_of_the_controller() {
    let origin = Origin {
        simulator: Some("sim.mgap\nStopAllTasks();".to_owned()),
        seed: Some(7),
        generations: Some(1000),
        fitness: Some(0.25),
        ..Origin::default()
    };
    let source = nxc::program(&at_its_limits(), &origin, &options()).unwrap();
    for line in ["// simulator: sim.mgap?StopAllTasks();", "// seed: 7", "// generations: 1000", "// fitness: 0.25"] {
        assert!(source.lines().any(|l| l == line), "{line} is missing in\n{source}");
    }
    compile(&source);
}

#[test]
fn no_statement_depends_on_the_firmware() {
    let source = nxc::program(&at_its_limits(), &Origin::default(), &full_options()).unwrap();
    let code: Vec<_> = source.lines().filter_map(|line| line.split("//").next()).collect();
    assert!(code.iter().any(|line| line.contains("LowspeedWrite")));
    for construct in ["<<", ">>", "float", "SensorUS", "OnFwdReg"] {
        assert!(!code.iter().any(|line| line.contains(construct)), "{construct}");
    }
}

/// nbc may read the wrong register for the initial value of a local variable, depending on the preceding function.
#[test]
fn no_local_variable_is_initialised_where_it_is_declared() {
    let options = CollectOptions {
        program: BrickName::program("collect").unwrap(),
        wiring: Wiring::default(),
        safety: Safety { stop_cm: Some(15), stall: true },
        step_ms: 400,
        commands: Commands::Random { steps: 150, near_cm: 40, seed: 7 },
    };
    let run = nxc::program(&at_its_limits(), &Origin::default(), &full_options()).unwrap();
    for line in run.lines().chain(collect::program(&options).unwrap().lines()) {
        let mut words = line.split_whitespace().skip_while(|word| *word == "unsigned");
        let declares = ["int", "long", "char", "bool", "byte", "string"].contains(&words.next().unwrap_or_default());
        let is_local_number = line.starts_with(' ') && !line.contains('[');
        assert!(!(declares && is_local_number && line.contains('=')), "{line}");
    }
}

#[test]
fn impossible_program_is_rejected_with_the_necessary_change() {
    let program = |controller: &Controller, options: &NxcOptions| nxc::program(controller, &Origin::default(), options);
    let mut wild = at_its_limits();
    wild.tuples[2].left = -128;
    assert_eq!(program(&wild, &options()).unwrap_err().to_string(), "tuple 3: a motor command is outside -100..100");

    let hasty = program(&Controller { step_ms: 100, ..at_its_limits() }, &options()).unwrap_err();
    let ExportError::StepTooShort { shortest_ms, .. } = hasty else { panic!("{hasty}") };
    assert!(program(&Controller { step_ms: shortest_ms, ..at_its_limits() }, &options()).is_ok());

    let wiring = Wiring { left: MotorPort::C, ..Wiring::default() };
    assert_eq!(
        program(&at_its_limits(), &NxcOptions { wiring, ..options() }),
        Err(ExportError::OnePortForTwoMotors('C'))
    );
}

#[test]
fn error_of_a_log_too_large_states_the_step_limit_that_fits() {
    let long =
        |max_steps| nxc::program(&Controller { max_steps, ..at_its_limits() }, &Origin::default(), &full_options());
    let Err(ExportError::LogTooLarge { steps, .. }) = long(u16::MAX) else { panic!("accepted") };
    assert!(long(steps).is_ok());
    assert!(matches!(long(steps + 1), Err(ExportError::LogTooLarge { .. })));
}
