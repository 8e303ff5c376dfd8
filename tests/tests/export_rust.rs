//! The Rust module: compiled here as it stands in the golden file, which is what the exporter writes.

use mindgap_controller_export::{ExportError, Origin, rust};
use mindgap_core::controller::{Controller, InvalidController, Tuple, When};

#[path = "golden/controller.rs"]
mod golden;

fn controller() -> Controller {
    let tuple = |left, right, when, threshold_cm| Tuple { left, right, when, threshold_cm };
    Controller {
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
    }
}

#[test]
fn the_module_is_the_golden_file_and_holds_the_controller() {
    let origin = Origin {
        simulator: Some("sim.mgap".to_owned()),
        scene: Some("scene.toml".to_owned()),
        start: Some(1),
        seed: Some(7),
        generations: Some(1000),
        fitness: Some(0.25),
    };
    let golden_text = include_str!("golden/controller.rs");
    assert_eq!(rust::module(&controller(), &origin).unwrap(), golden_text);
    assert_eq!(golden::CONTROLLER, controller());
}

#[test]
fn a_controller_out_of_range_is_refused() {
    let mut wild = controller();
    wild.tuples[0].threshold_cm = -1;
    let refused = ExportError::Controller(InvalidController::Threshold(0));
    assert_eq!(rust::module(&wild, &Origin::default()), Err(refused));
}
