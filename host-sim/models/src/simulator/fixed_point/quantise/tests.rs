use super::*;
use fixed::types::I16F16;
use mindgap_core::network::SummationUnit;
use proptest::collection::vec;
use proptest::prelude::*;

/// Networks with exponents in ±5 and output weights up to `largest_weight`.
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

/// The network in double precision, by its definition.
fn exact<const N: usize>(network: &Network<f32, N>, inputs: [I16F16; N]) -> f64 {
    let mut x = inputs.map(f64::from);
    for (x, s) in x.iter_mut().zip(&network.inputs) {
        *x = (*x * f64::from(s.gain) + f64::from(s.offset)).clamp(s.low.into(), s.high.into());
    }
    let summation = network.summation.iter().map(|unit| {
        let inner = x.iter().zip(unit.weights).map(|(x, weight)| x * f64::from(weight)).sum::<f64>();
        (inner + f64::from(unit.bias)) * f64::from(unit.output)
    });
    let product = network.product.iter().map(|unit| {
        let power = x.iter().zip(unit.exponents).map(|(x, exponent)| libm::pow(*x, exponent.into()));
        power.product::<f64>() * f64::from(unit.output)
    });
    f64::from(network.bias) + summation.chain(product).sum::<f64>()
}

fn any_q16_16() -> impl Strategy<Value = I16F16> {
    prop_oneof![any::<i32>(), Just(i32::MIN), Just(i32::MAX), -30_000_000..30_000_000].prop_map(I16F16::from_bits)
}

proptest! {
    #[test]
    fn rounding_stays_within_its_bound(network in networks::<2>(1000.0), inputs in [any_q16_16(), any_q16_16()]) {
        let Quantised { network: fixed, error_bound } = Quantised::new(&network).unwrap();
        let exact = exact(&network, inputs).clamp(-32768.0, 32768.0);
        let error = (f64::from(fixed.evaluate(inputs).value) - exact).abs();
        prop_assert!(error <= error_bound, "{} off, bound {}", error, error_bound);
    }

    #[test]
    fn rounding_stays_within_its_bound_for_motion(network in networks::<4>(10.0), inputs in prop::array::uniform4(any_q16_16())) {
        let Quantised { network: fixed, error_bound } = Quantised::new(&network).unwrap();
        let exact = exact(&network, inputs).clamp(-32768.0, 32768.0);
        let error = (f64::from(fixed.evaluate(inputs).value) - exact).abs();
        prop_assert!(error <= error_bound, "{} off, bound {}", error, error_bound);
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
    let Quantised { network: fixed, error_bound } = Quantised::new(&network).unwrap();
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
    let fixed = Quantised::new(&large_terms_that_cancel()).unwrap().network;
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
    assert_eq!(Quantised::new(&network).unwrap().network.sum.powers.len(), 2);
}

#[test]
fn what_does_not_fit_is_named() {
    let refusal = |change: fn(&mut Network<f32, 1>)| {
        let mut network = large_terms_that_cancel();
        change(&mut network);
        Quantised::new(&network).unwrap_err()
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
    let broken = refusal(|n| n.bias = f32::NAN);
    assert_eq!(broken.to_string(), "a weight, exponent, bias or scaling is not a finite number");
}
