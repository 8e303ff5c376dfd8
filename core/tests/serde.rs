//! Controllers and networks as JSON: the names are those of the file formats, and values come back unchanged.

use mindgap_core::controller::{Controller, Tuple, When};
use mindgap_core::network::{Network, ProductUnit, Scaling, SummationUnit};

#[test]
fn controller_round_trips_and_has_the_names_of_the_file_format() {
    let tuple = Tuple { left: 55, right: -48, when: When::Larger, threshold_cm: 42 };
    let controller = Controller { step_ms: 400, max_steps: 150, tuples: [tuple; 6] };
    let text = serde_json::to_string(&controller).unwrap();
    let first = r#"{"step_ms":400,"max_steps":150,"tuple":[{"left":55,"right":-48,"when":"larger","threshold_cm":42},"#;
    assert!(text.starts_with(first), "{text}");
    assert_eq!(serde_json::from_str::<Controller>(&text).unwrap(), controller);
}

#[test]
fn network_round_trips_and_has_the_names_of_the_file_format() {
    let mut network = Network::constant([Scaling::onto_one_to_two(0.0, 100.0); 2], 0.5f32);
    network.summation.push(SummationUnit { weights: [0.25, -1.0], bias: 0.125, output: 2.0 }).unwrap();
    network.product.push(ProductUnit { exponents: [1.5, -0.75], output: -0.5 }).unwrap();
    let text = serde_json::to_string(&network).unwrap();
    assert!(text.contains(r#""product_form":"positive","activation":"linear""#), "{text}");
    assert_eq!(serde_json::from_str::<Network<f32, 2>>(&text).unwrap(), network);
    let too_short = text.replace("[1.5,-0.75]", "[1.5]");
    let error = serde_json::from_str::<Network<f32, 2>>(&too_short).unwrap_err();
    assert!(error.to_string().contains("one entry per input"), "{error}");
}
