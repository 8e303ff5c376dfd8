//! The first-echo law on real sonars: scans at a place that it was not fitted on.

use std::path::Path;

use mindgap_logs::Logs;
use mindgap_tests::held_out_scans::HeldOut;

/// It was −2.00 when this was written; an ideal ray has −3.95 (`docs/sonar.md`).
pub fn a_scan_elsewhere_is_likely_by_the_first_echo_law(folder: &Path) {
    let HeldOut { poses_refitted, .. } = HeldOut::of(Logs::read(folder, |_| ()).expect("logs"));
    println!("{poses_refitted:.3} nats a reading");
    assert!(poses_refitted > -2.2, "{poses_refitted}");
}
