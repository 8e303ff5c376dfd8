//! Networks of the sizes in Table I with synthetic weights, for tests that need no trained networks.
//!
//! Each follows a simple law: a differential drive, and a sonar that reads a little long and gets fewer echoes at an angle. Each
//! has pairs of large product units that almost cancel, like trained networks.

use mindgap_core::network::{Activation, Network, ProductUnit, Scaling, SummationUnit};
use mindgap_foundations::chance::{Generator, generator};
use rand::RngExt;

/// The five networks of a simulator.
pub struct PlausibleNetworks {
    /// Turn in a step, degrees, from the current left and right and the previous left and right command.
    pub turn: Network<f32, 4>,
    /// Forward motion in a step, cm, from the same inputs.
    pub forward: Network<f32, 4>,
    /// Lateral motion to the left in a step, cm, from the same inputs.
    pub lateral: Network<f32, 4>,
    /// Probability of an echo, from the distance in cm and the incidence angle in degrees.
    pub echo_probability: Network<f32, 2>,
    /// Mean reading, cm, from the same inputs.
    pub echo_value: Network<f32, 2>,
}

/// Returns the networks for a seed.
pub fn plausible_networks(seed: u64) -> PlausibleNetworks {
    let commands = [Scaling::onto_one_to_two(-100.0, 100.0); 4];
    let sonar = [Scaling::onto_one_to_two(0.0, 255.0), Scaling::onto_one_to_two(0.0, 90.0)];
    let network = |place| generator(seed, &[place]);
    let mut echo_probability = made(10, sonar, 1.1, [-0.3, -0.8], 20.0, &mut network(3));
    echo_probability.activation = Activation::Ramp;
    PlausibleNetworks {
        turn: made(4, commands, 0.0, [-56.0, 56.0, -12.0, 12.0], 40.0, &mut network(0)),
        forward: made(20, commands, -16.0, [13.0, 13.0, 3.0, 3.0], 30.0, &mut network(1)),
        lateral: made(20, commands, 0.0, [-1.4, 1.4, -0.6, 0.6], 10.0, &mut network(2)),
        echo_probability,
        echo_value: made(40, sonar, 1.5, [251.0, 4.0], 500.0, &mut network(4)),
    }
}

/// Returns a network of `hidden` units with output `at_low` at the low ends of its input ranges, which rises by about `rises`
/// over each range. Product units with output weights up to `largest_weight` almost cancel.
fn made<const N: usize>(
    hidden: usize,
    inputs: [Scaling<f32>; N],
    at_low: f32,
    rises: [f32; N],
    largest_weight: f32,
    generator: &mut Generator,
) -> Network<f32, N> {
    let half = hidden / 2;
    let mut network = Network::constant(inputs, at_low - rises.iter().sum::<f32>());
    for _ in 0..half {
        let output = generator.random_range(0.5..2.0);
        let weights = rises.map(|rise| rise / (output * half as f32));
        network.summation.extend([SummationUnit { weights, bias: 0.0, output }]);
    }
    for pair in 0..half.div_ceil(2) {
        let exponents = rises.map(|_| generator.random_range(-2.0..2.0));
        if 2 * pair + 1 == half {
            network.product.extend([ProductUnit { exponents, output: 0.01 }]);
            break;
        }
        let output = generator.random_range(0.2..1.0) * largest_weight;
        let close = exponents.map(|exponent| exponent + generator.random_range(-0.002..0.002));
        let pair = [(exponents, output), (close, -output)];
        network.product.extend(pair.map(|(exponents, output)| ProductUnit { exponents, output }));
    }
    network
}
