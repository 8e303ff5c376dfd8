//! The Rust module: the golden file is compiled here, and the exporter writes the same text.

use mindgap_controller_export::{ExportError, Origin, rust};
use mindgap_core::controller::InvalidController;
use mindgap_tests::controllers::at_its_limits;

#[path = "../golden/controller.rs"]
mod golden;

#[test]
fn module_equals_the_golden_file_and_contains_the_controller() {
    let origin = Origin {
        simulator: Some("sim.mgap".to_owned()),
        scene: Some("scene.toml".to_owned()),
        start: Some(1),
        seed: Some(7),
        generations: Some(1000),
        fitness: Some(0.25),
    };
    let golden_text = include_str!("../golden/controller.rs");
    assert_eq!(rust::module(&at_its_limits(), &origin).unwrap(), golden_text);
    assert_eq!(golden::CONTROLLER, at_its_limits());
}

#[test]
fn controller_out_of_range_is_rejected() {
    let mut wild = at_its_limits();
    wild.tuples[0].threshold_cm = -1;
    let refused = ExportError::Controller(InvalidController::Threshold(0));
    assert_eq!(rust::module(&wild, &Origin::default()), Err(refused));
}
