//! Budgets against what the compiler makes and what the programs then take.

use std::collections::BTreeMap;

use mindgap_controller_export::brick::{self, Program, Script, Setup, Sonar};
use mindgap_controller_export::budget::Budget;
use mindgap_controller_export::collect::{self, CollectOptions};
use mindgap_controller_export::names::BrickName;
use mindgap_controller_export::nxc::{self, NxcOptions};
use mindgap_controller_export::wiring::Wiring;
use mindgap_controller_export::{ExportError, Origin, rxe};
use mindgap_core::controller::{Controller, Tuple, When};
use mindgap_tests::nbc::compile;

#[test]
fn measure() {
    let tuple = |left, right, when, threshold_cm| Tuple { left, right, when, threshold_cm };
    let controller = Controller {
        step_ms: 400,
        max_steps: 150,
        tuples: [
            tuple(55, 48, When::Smaller, 42),
            tuple(-100, 100, When::Larger, 0),
            tuple(100, -100, When::Smaller, 255),
            tuple(0, 0, When::Larger, 254),
            tuple(7, -3, When::Smaller, 1),
            tuple(60, 60, When::Larger, 128),
        ],
    };
    let name = BrickName::program("run").unwrap();
    let o = |log: bool, display| NxcOptions { program: name.clone(), wiring: Wiring::default(), log: log.then(|| "run.csv".parse().unwrap()), display };
    let n = |log, display| compile(&nxc::program(&controller, &Origin::default(), &o(log, display)).unwrap());
    let c = CollectOptions { program: name.clone(), wiring: Wiring::default(), step_ms: 400, steps: 150, near_cm: 40, seed: 7 };
    for file in [rxe::program(&controller, &Wiring::default()).unwrap(), n(false, false), n(true, false), n(false, true), n(true, true), compile(&collect::program(&c).unwrap())] {
        let program = Program::load(&file).unwrap();
        let mut worst = 0;
        for sonar in [&[Sonar::Echo(41), Sonar::Echo(1), Sonar::Echo(0)][..], &[Sonar::Echo(255); 5], &[Sonar::Hangs, Sonar::Echo(0), Sonar::Hangs, Sonar::Echo(1), Sonar::Echo(20), Sonar::Hangs, Sonar::Echo(1)]] {
            for steps in 1..=sonar.len() {
                let i = |sonar: &[Sonar]| brick::run(&program, &mut Script::sonar(sonar), &Setup::default());
                worst = worst.max(i(&sonar[..steps]).instructions - i(&sonar[..steps - 1]).instructions);
            }
        }
        let report = brick::run(&program, &mut Script::sonar((0..200).map(|i| Sonar::Echo((i * 37 % 256) as u8)).collect::<Vec<_>>()), &Setup::default());
        println!("{} bytes, pool {} worst {worst} {:?} {}", file.len(), report.pool_bytes, report.end, report.ended_ms);
        for (n, f) in report.files { println!("{n}\n{}", String::from_utf8(f).unwrap()); }
    }
}
