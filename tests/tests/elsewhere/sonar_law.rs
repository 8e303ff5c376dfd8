//! The first-echo law predicts scans of a real sonar at a place on which it was not fitted.

use std::path::Path;

use mindgap_logs::Logs;
use mindgap_tests::held_out_scans::HeldOut;

/// The law gives about −2.00 nats per reading, an ideal ray −3.95 (`docs/sonar.md`).
pub fn the_first_echo_law_predicts_scans_at_another_place(folder: &Path) {
    let HeldOut { poses_refitted, .. } = HeldOut::of(Logs::read(folder, |_| ()).expect("logs"));
    println!("{poses_refitted:.3} nats per reading");
    assert!(poses_refitted > -2.2, "{poses_refitted}");
}
