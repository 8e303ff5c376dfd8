//! One evaluator over numbers one by one, pairs and lanes: the same bits.

use super::Lanes;
use mindgap_core::folded::{FoldedNetwork, evaluate_all};
use mindgap_core::maths;
use mindgap_core::network::{Network, ProductUnit, Scaling, SummationUnit};
use mindgap_core::pair::Pair;
use proptest::prelude::*;

/// Numbers of every size, zero and subnormal ones among them.
fn any_size() -> impl Strategy<Value = f32> {
    prop_oneof![
        Just(0.0f32),
        Just(f32::MIN_POSITIVE / 8.0),
        -3.0f32..3.0,
        -1e4f32..1e4,
        Just(1e30f32),
        Just(-1e30f32),
        Just(f32::INFINITY)
    ]
}

fn network(genes: &[f32]) -> Network<f32, 2> {
    let mut network = Network::constant([Scaling::onto_one_to_two(0.0, 100.0); 2], genes[0]);
    let unit = SummationUnit { weights: [genes[1], genes[2]], bias: genes[3], output: genes[4] };
    network.summation.push(unit).unwrap();
    for unit in genes[5..].chunks_exact(3) {
        let unit = ProductUnit { exponents: [unit[0], unit[1]], output: unit[2] };
        network.product.push(unit).unwrap();
    }
    network
}

fn number(lane: Lanes<pulp::Scalar>) -> f32 {
    let mut number = [0.0];
    lane.store(&mut number);
    number[0]
}

fn same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

proptest! {
    #[test]
    fn lanes_pairs_and_single_numbers_give_the_same_bits(
        genes in prop::collection::vec(any_size(), 14), inputs in prop::array::uniform2(any_size()),
    ) {
        let folded = FoldedNetwork::<f32, 2>::fold(&network(&genes));
        let single = folded.evaluate(inputs);
        let (x, log2_x) = folded.scale(inputs.map(|input| Pair(input, input)));
        let pair = folded.evaluate_scaled_pair(&x, &log2_x);
        let lane = number(folded.evaluate(inputs.map(|input| Lanes::splat(pulp::Scalar::new(), input))));
        prop_assert!(same(single, lane) && same(single, pair.0) && same(single, pair.1), "{single} {lane} {pair:?}");
    }

    #[test]
    fn overflow_safe_powers_are_the_general_ones_to_the_bit(
        genes in prop::collection::vec(-20f32..20.0, 20), inputs in prop::array::uniform2(-20f32..120.0),
    ) {
        let folded = FoldedNetwork::<f32, 2>::fold(&network(&genes));
        let x = [0, 1].map(|i| folded.inputs[i].apply(inputs[i]));
        let general = folded.sum.evaluate(&x, &x.map(maths::log2));
        prop_assert_eq!(folded.evaluate(inputs).to_bits(), general.to_bits());
    }

    #[test]
    fn folding_changes_a_network_by_no_more_than_rounding(
        genes in prop::collection::vec(-3f32..3.0, 20), inputs in prop::array::uniform2(-20f32..120.0),
    ) {
        let network = network(&genes);
        let [folded] = evaluate_all(&[FoldedNetwork::fold(&network)], inputs);
        let plain = network.evaluate(inputs);
        prop_assert!((folded - plain).abs() <= 1e-4 * (1.0 + plain.abs()), "{folded} {plain}");
    }
}
