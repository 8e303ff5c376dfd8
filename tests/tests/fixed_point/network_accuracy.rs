//! Fixed-point networks of the sizes of Table I against the same networks in f32.

use fixed::types::I16F16;
use mindgap_core::network::Network;
use mindgap_foundations::chance::generator;
use mindgap_models::simulator::fixed_point::Quantised;
use mindgap_tests::plausible_networks::plausible_networks;
use rand::RngExt;

const SAMPLES: usize = 20_000;

/// The largest difference over samples drawn evenly from `ranges`, and the bound on the rounding error.
fn largest_difference<const N: usize>(network: &Network<f32, N>, ranges: [(f32, f32); N]) -> (f64, f64) {
    let Quantised { network: fixed, error_bound } = Quantised::new(network).unwrap();
    let mut generator = generator(1, &[]);
    let differences = (0..SAMPLES).map(|_| {
        let inputs = ranges.map(|(from, to)| I16F16::from_num(generator.random_range(from..to)));
        let float: f32 = network.evaluate(inputs.map(|x| x.to_num()));
        let fixed = fixed.evaluate(inputs);
        assert!(!fixed.clamped);
        f64::from(fixed.value.to_num::<f32>() - float).abs()
    });
    (differences.fold(0.0, f64::max), error_bound)
}

#[test]
fn fixed_point_answers_as_float_does() {
    for seed in 0..10 {
        let networks = plausible_networks(seed);
        let commands = [(-100.0, 100.0); 4];
        let sonar = [(0.0, 255.0), (0.0, 90.0)];
        let found = [
            ("turn", largest_difference(&networks.turn, commands), 0.1),
            ("forward", largest_difference(&networks.forward, commands), 0.05),
            ("lateral", largest_difference(&networks.lateral, commands), 0.05),
            ("echo probability", largest_difference(&networks.echo_probability, sonar), 0.002),
            ("echo value", largest_difference(&networks.echo_value, sonar), 0.2),
        ];
        for (network, (difference, error_bound), wanted) in found {
            println!("seed {seed}, {network}: {difference:.6}, bound {error_bound:.6}");
            assert!(difference <= wanted / 10.0, "{network} of seed {seed} differs by {difference}");
        }
    }
}
