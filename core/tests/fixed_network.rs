//! Folded and fixed-point networks against the trained network in exact arithmetic.

use fixed::Saturating;
use fixed::types::{I6F26, I16F16, I38F26};
use mindgap_core::fixed_network::{FixedNetwork, FixedScaling, MAX_OUTPUT_SHIFT, Quantised, Unrepresentable, Weight};
use mindgap_core::folded::{FoldedNetwork, Power, PowerSum, Sign};
use mindgap_core::network::{Activation, MAX_HALF, Network, ProductForm, ProductUnit, Scaling, SummationUnit};
use proptest::collection::vec;
use proptest::prelude::*;

/// Networks of the positive form with exponents in ±5 and output weights up to `largest_weight`.
fn networks<const N: usize>(largest_weight: f32) -> impl Strategy<Value = Network<f32, N>> {
    let numbers = |limit: f32| prop::array::uniform::<_, N>(-limit..limit);
    let output = -largest_weight..largest_weight;
    let summation = (numbers(2.0), -2f32..2.0, output.clone());
    let product = (numbers(5.0), output.clone());
    let range = prop::array::uniform::<_, N>((-300f32..300.0, 1f32..400.0));
    (range, output, vec(summation, 0..=20), vec(product, 0..=20)).prop_map(|(range, bias, summation, product)| {
        let mut network =
            Network::constant(range.map(|(from, span)| Scaling::onto_one_to_two(from, from + span)), bias);
        let summation = summation.into_iter().map(|(weights, bias, output)| SummationUnit { weights, bias, output });
        network.summation.extend(summation);
        network.product.extend(product.into_iter().map(|(exponents, output)| ProductUnit { exponents, output }));
        network
    })
}

/// The same network in f64, to the bit.
fn widened<const N: usize>(network: &Network<f32, N>) -> Network<f64, N> {
    let inputs = network.inputs.each_ref().map(|s| Scaling {
        gain: f64::from(s.gain),
        offset: f64::from(s.offset),
        low: f64::from(s.low),
        high: f64::from(s.high),
    });
    let mut wide = Network::constant(inputs, f64::from(network.bias));
    wide.summation.extend(network.summation.iter().map(|u| SummationUnit {
        weights: u.weights.map(f64::from),
        bias: f64::from(u.bias),
        output: f64::from(u.output),
    }));
    wide.product.extend(
        network
            .product
            .iter()
            .map(|u| ProductUnit { exponents: u.exponents.map(f64::from), output: f64::from(u.output) }),
    );
    wide
}

fn exact<const N: usize>(network: &Network<f32, N>, inputs: [I16F16; N]) -> f64 {
    widened(network).evaluate(inputs.map(f64::from))
}

fn any_q16_16() -> impl Strategy<Value = I16F16> {
    prop_oneof![any::<i32>(), Just(i32::MIN), Just(i32::MAX), -30_000_000..30_000_000].prop_map(I16F16::from_bits)
}

fn any_q6_26() -> impl Strategy<Value = I6F26> {
    prop_oneof![any::<i32>(), Just(i32::MIN), Just(i32::MAX), Just(0)].prop_map(I6F26::from_bits)
}

fn any_sign() -> impl Strategy<Value = Sign> {
    prop_oneof![Just(Sign::Plus), Just(Sign::Minus)]
}

/// Fixed-point networks of any bits at all.
fn any_fixed_network() -> impl Strategy<Value = FixedNetwork<2>> {
    let scaling = (any::<i32>(), any::<u8>(), any::<i64>(), any_q6_26(), any_q6_26()).prop_map(
        |(gain, shift, offset, low, high)| FixedScaling { gain, shift, offset: I38F26::from_bits(offset), low, high },
    );
    let power = ([any_q6_26(), any_q6_26()], any_q6_26(), any_sign())
        .prop_map(|(exponents, log2_weight, sign)| Power { exponents, log2_weight, sign });
    let affine = (any_q6_26(), [any_q6_26(), any_q6_26()]);
    (prop::array::uniform(scaling), affine, vec(power, 0..=MAX_HALF), any::<u8>(), any::<bool>()).prop_map(
        |(inputs, (bias, slopes), powers, output_shift, ramp)| FixedNetwork {
            inputs,
            sum: PowerSum { bias, slopes, powers: powers.into_iter().collect() },
            output_shift,
            activation: if ramp { Activation::Ramp } else { Activation::Linear },
        },
    )
}

proptest! {
    #[test]
    fn folding_changes_nothing(network in networks::<3>(100.0), inputs in prop::array::uniform3(-500f64..500.0)) {
        let folded = FoldedNetwork::fold(&network).unwrap().evaluate(inputs);
        let unfolded = widened(&network).evaluate(inputs);
        // Terms of 100 · 2^15, forty of them, each good to 1e-15 or so.
        prop_assert!((folded - unfolded).abs() < 1e-6, "{} is not {}", folded, unfolded);
    }

    #[test]
    fn rounding_stays_within_its_bound(network in networks::<2>(1000.0), inputs in [any_q16_16(), any_q16_16()]) {
        let Quantised { network: fixed, error_bound } = FixedNetwork::quantise(&network).unwrap();
        let exact = exact(&network, inputs).clamp(-32768.0, 32768.0);
        let error = (f64::from(fixed.evaluate(inputs).value) - exact).abs();
        prop_assert!(error <= error_bound, "{} off, bound {}", error, error_bound);
    }

    #[test]
    fn rounding_stays_within_its_bound_for_motion(network in networks::<4>(10.0), inputs in prop::array::uniform4(any_q16_16())) {
        let Quantised { network: fixed, error_bound } = FixedNetwork::quantise(&network).unwrap();
        let exact = exact(&network, inputs).clamp(-32768.0, 32768.0);
        let error = (f64::from(fixed.evaluate(inputs).value) - exact).abs();
        prop_assert!(error <= error_bound, "{} off, bound {}", error, error_bound);
    }

    #[test]
    fn any_bits_give_an_answer(network in any_fixed_network(), inputs in [any_q16_16(), any_q16_16()]) {
        let output = network.evaluate(inputs).value;
        if network.activation == Activation::Ramp {
            prop_assert!((I16F16::ZERO..=I16F16::ONE).contains(&output));
        }
    }

    #[test]
    fn the_unfolded_network_runs_in_fixed_point_too(
        network in networks::<2>(2.0), inputs in [any_q16_16(), any_q16_16()], signed in any::<bool>(),
    ) {
        // Any numbers have to give an answer. Which one is checked for folded networks, whose formats are made for it.
        let number = |w: &mut f32| I16F16::saturating_from_num(*w);
        let mut fixed = Network::constant(network.inputs.map(|mut s| Scaling {
            gain: number(&mut s.gain), offset: number(&mut s.offset), low: number(&mut s.low), high: number(&mut s.high),
        }), I16F16::saturating_from_num(network.bias));
        if signed {
            fixed.product_form = ProductForm::Signed;
        }
        for unit in &network.product {
            let unit = ProductUnit {
                exponents: unit.exponents.map(I16F16::saturating_from_num),
                output: I16F16::saturating_from_num(unit.output),
            };
            fixed.product.push(unit).unwrap();
        }
        let _: Saturating<I16F16> = fixed.evaluate(inputs.map(Saturating));
    }
}

/// 2 cm + 3 x + 300 x^5 - 290 x^5.1 of one input of 0..255 cm.
fn large_terms_that_cancel() -> Network<f32, 1> {
    let mut network = Network::constant([Scaling::onto_one_to_two(0.0, 255.0)], 2.0);
    network.summation.push(SummationUnit { weights: [1.0], bias: 0.0, output: 3.0 }).unwrap();
    network.product.push(ProductUnit { exponents: [5.0], output: 300.0 }).unwrap();
    network.product.push(ProductUnit { exponents: [5.1], output: -290.0 }).unwrap();
    network
}

#[test]
fn large_terms_may_cancel() {
    let network = large_terms_that_cancel();
    let Quantised { network: fixed, error_bound } = FixedNetwork::quantise(&network).unwrap();
    // Terms of 20,000 cm, divided by 2^10 to stay below 32.
    assert_eq!(fixed.output_shift, 10);
    assert!(error_bound < 0.005, "{error_bound}");
    for mm in 0..=2550 {
        let input = [I16F16::from_num(f64::from(mm) / 10.0)];
        let error = (f64::from(fixed.evaluate(input).value) - exact(&network, input)).abs();
        assert!(error < 0.002, "{error} off at {mm} mm");
    }
}

#[test]
fn an_input_outside_the_trained_range_is_clamped_and_flagged() {
    let fixed = FixedNetwork::quantise(&large_terms_that_cancel()).unwrap().network;
    let at = |cm: f64| fixed.evaluate([I16F16::from_num(cm)]);
    assert_eq!([0.0, 100.0, 255.0].map(|cm| at(cm).clamped), [false; 3]);
    assert_eq!([-0.1, 255.1, 32767.0, -32768.0].map(|cm| at(cm).clamped), [true; 4]);
    assert_eq!((at(-9.0).value, at(999.0).value), (at(0.0).value, at(255.0).value));
}

#[test]
fn a_unit_that_adds_nothing_is_left_out() {
    let mut network = large_terms_that_cancel();
    network.product.push(ProductUnit { exponents: [1.0], output: 0.0 }).unwrap();
    network.product.push(ProductUnit { exponents: [-2.0], output: 1e-12 }).unwrap();
    assert_eq!(FixedNetwork::quantise(&network).unwrap().network.sum.powers.len(), 2);
}

#[test]
fn what_does_not_fit_is_named() {
    let refusal = |change: fn(&mut Network<f32, 1>)| {
        let mut network = large_terms_that_cancel();
        change(&mut network);
        FixedNetwork::quantise(&network).unwrap_err()
    };
    let exponent = refusal(|n| n.product[1].exponents = [-40_000.0]);
    assert_eq!(exponent, Unrepresentable::Weight(Weight::Exponent { unit: 1, input: 0 }, -40_000.0));
    assert_eq!(exponent.to_string(), "product unit 2: exponent of input 1 = -40000 does not fit Q6.26 (-32..32)");
    let exponent = refusal(|n| n.product[0].exponents = [40_000.0]);
    assert_eq!(exponent, Unrepresentable::Weight(Weight::Exponent { unit: 0, input: 0 }, 40_000.0));
    let gain = refusal(|n| n.inputs[0].gain = 1e30);
    assert_eq!(gain, Unrepresentable::Weight(Weight::Gain(0), f64::from(1e30f32)));
    let high = refusal(|n| n.inputs[0].high = 33.0);
    assert_eq!(high.to_string(), "input 1: largest scaled value = 33 does not fit Q6.26 (-32..32)");
    let terms = refusal(|n| n.product[0].output = 1e9);
    assert!(matches!(terms, Unrepresentable::Terms(sum) if sum > 3.2e10), "{terms}");
    assert_eq!(refusal(|n| n.product_form = ProductForm::Signed), Unrepresentable::SignedForm);
    let broken = refusal(|n| n.bias = f32::NAN);
    assert_eq!(broken.to_string(), "a weight, exponent, bias or scaling is not a finite number");
}

#[test]
fn extreme_weights_saturate() {
    let power = |sign| Power { exponents: [I6F26::MAX], log2_weight: I6F26::MAX, sign };
    let constant = FixedScaling { gain: 0, shift: 0, offset: I38F26::ONE, low: I6F26::ONE, high: I6F26::MAX };
    let answer = |bias, signs: [Sign; 2]| {
        let powers = heapless::Vec::<_, 2>::from_array(signs.map(power));
        let sum = PowerSum { bias, slopes: [bias], powers };
        let output_shift = MAX_OUTPUT_SHIFT;
        FixedNetwork { inputs: [constant], sum, output_shift, activation: Activation::Linear }
            .evaluate([I16F16::ZERO])
            .value
    };
    assert_eq!(answer(I6F26::MAX, [Sign::Plus; 2]), I16F16::MAX);
    assert_eq!(answer(I6F26::MIN, [Sign::Minus; 2]), I16F16::MIN);
    assert_eq!(answer(I6F26::ZERO, [Sign::Plus, Sign::Minus]), I16F16::ZERO);
}
