//! The first-echo law predicts scans of a real sonar at a place on which it was not fitted.

use std::path::Path;

use mindgap_logs::Logs;
use mindgap_tests::held_out_scans::HeldOut;

/// It was −2.00 when this was written; an ideal ray has −3.95 (`docs/reference/measurements.md`).
pub fn the_first_echo_law_predicts_scans_at_another_place(folder: &Path) {
    let HeldOut { poses_refitted, .. } = HeldOut::of(Logs::read(folder, |_| ()).expect("logs"));
    println!("{poses_refitted:.3} nats per reading");
    assert!(poses_refitted > -2.2, "{poses_refitted}");
}
