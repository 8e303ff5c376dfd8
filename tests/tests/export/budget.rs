//! Budgets are compared with the compiled programs and the resources that they use.

use mindgap_controller_export::brick::{self, Program, Report, RunConfig, ScriptedWorld, Sonar};
use mindgap_controller_export::budget::{Budget, INSTRUCTIONS_PER_MS};
use mindgap_controller_export::collect::{self, CollectOptions, Commands};
use mindgap_controller_export::names::{BrickName, RunLogs};
use mindgap_controller_export::nxc::{self, NxcOptions};
use mindgap_controller_export::onboard::Safety;
use mindgap_controller_export::wiring::Wiring;
use mindgap_controller_export::{ExportError, Origin, rxe};
use mindgap_core::controller::Controller;
use mindgap_tests::controllers::at_its_limits;
use mindgap_tests::nbc::compile;

/// Largest ratio of a budget to the resources used.
const SLACK: f64 = 1.25;

fn nxc_options(log: bool, display: bool) -> NxcOptions {
    let log = log.then(|| RunLogs::named_after(&"elevenchars.csv".parse().unwrap()).unwrap());
    NxcOptions { log, display, ..NxcOptions::new(BrickName::program("run").unwrap()) }
}

fn collect_options() -> [CollectOptions; 3] {
    let random = Commands::Random { steps: 150, near_cm: 40, seed: u32::MAX };
    [random, Commands::Script(vec![[-100, 100]; 40]), Commands::Script(vec![[-100, 100]; 500])].map(|commands| {
        let program = BrickName::program("collect").unwrap();
        CollectOptions { program, wiring: Wiring::default(), safety: Safety::default(), step_ms: 400, commands }
    })
}

/// Every kind of program with its budget.
fn programs() -> Vec<(Vec<u8>, Budget)> {
    let nxc = [(false, false), (true, false), (false, true), (true, true)].map(|(log, display)| {
        let options = nxc_options(log, display);
        let source = nxc::program(&at_its_limits(), &Origin::default(), &options).unwrap();
        (compile(&source), nxc::budget(&at_its_limits(), &options))
    });
    let careful = Safety { stop_cm: Some(15), stall: true };
    let rxe = [Safety::default(), careful].map(|safety| {
        let file = rxe::program(&at_its_limits(), &Wiring::default(), safety).unwrap();
        (file, rxe::budget(&at_its_limits(), safety))
    });
    let options = NxcOptions { safety: careful, ..nxc_options(true, true) };
    let source = nxc::program(&at_its_limits(), &Origin::default(), &options).unwrap();
    let careful = (compile(&source), nxc::budget(&at_its_limits(), &options));
    let collect =
        collect_options().map(|options| (compile(&collect::program(&options).unwrap()), collect::budget(&options)));
    nxc.into_iter().chain([careful]).chain(rxe).chain(collect).collect()
}

fn run(program: &Program, sonar: &[Sonar]) -> Report {
    let setup =
        RunConfig { instructions_per_ms: INSTRUCTIONS_PER_MS, start_tick_ms: 4_000_000_000, ..RunConfig::default() };
    brick::run(program, &mut ScriptedWorld::sonar(sonar), &setup)
}

fn assert_close(resource: &str, budget: u32, used: usize) {
    assert!(used <= budget as usize, "{resource}: {used} used of {budget}");
    assert!(f64::from(budget) <= SLACK * used as f64, "{resource}: only {used} used of {budget}");
}

#[test]
fn programs_use_at_most_their_budgets_and_hardly_less() {
    let long: Vec<_> = (0..160u32).map(|k| Sonar::Echo((k * 37 % 256) as u8)).collect();
    for (file, budget) in programs() {
        let program = Program::load(&file).unwrap();
        assert_close("program", budget.program_bytes, file.len());
        assert_close("memory", budget.memory_bytes, run(&program, &long).pool_bytes);
        let log_bytes: usize = run(&program, &[Sonar::Echo(100); 160]).files.values().map(Vec::len).sum();
        assert!(log_bytes <= budget.log_bytes as usize, "{log_bytes} of {}", budget.log_bytes);
    }
}

/// A step ends before the next one starts, even with the slowest sensor.
#[test]
fn slowest_brick_keeps_the_shortest_step() {
    for (_, budget) in programs() {
        assert!(budget.worst_step_ms <= 130, "{budget}");
    }
    let options = nxc_options(true, true);
    let shortest = |step_ms| Controller { step_ms, ..at_its_limits() };
    let Err(ExportError::StepTooShort { shortest_ms, .. }) = nxc::program(&shortest(1), &Origin::default(), &options)
    else {
        panic!("accepted")
    };
    let source = nxc::program(&shortest(shortest_ms), &Origin::default(), &options).unwrap();
    let program = Program::load(&compile(&source)).unwrap();
    let sonar: Vec<_> = (0..150).map(|k| if k % 2 == 0 { Sonar::Hangs } else { Sonar::Echo(255) }).collect();
    let report = run(&program, &sonar);
    let log = String::from_utf8(report.files["elevenchars_000.csv"].clone()).unwrap();
    let times: Vec<u32> = log.lines().skip(1).map(|row| row.split(',').next().unwrap().parse().unwrap()).collect();
    assert_eq!(times.len(), 151, "a hanging answer blocks the next request");
    for (step, t_ms) in (0..).zip(times) {
        let late_ms = t_ms - step * u32::from(shortest_ms);
        assert!(late_ms < u32::from(shortest_ms), "step {step} is {late_ms} ms late");
    }
}

#[test]
fn budget_prints_one_line_per_resource() {
    let lines = nxc::budget(&at_its_limits(), &nxc_options(true, false)).to_string();
    let expected = "program     6800 of 104104 bytes of flash\n\
                    log         7328 of 97304 bytes of flash without other files\n\
                    memory      5500 of 32768 bytes\n\
                    step         118 of 400 ms at worst";
    assert_eq!(lines, expected);
}
