//! Fixed-point networks with arbitrary bits: each gives a result, and numbers that do not fit saturate.

use mindgap_core::fixed::types::{I6F26, I16F16, I38F26};
use mindgap_core::fixed_network::{FixedNetwork, FixedScaling, MAX_OUTPUT_SHIFT};
use mindgap_core::folded::{Power, PowerSum, Sign};
use mindgap_core::heapless::Vec;
use mindgap_core::network::{Activation, MAX_HALF};
use proptest::collection::vec;
use proptest::prelude::*;

fn any_q16_16() -> impl Strategy<Value = I16F16> {
    prop_oneof![any::<i32>(), Just(i32::MIN), Just(i32::MAX), -30_000_000..30_000_000].prop_map(I16F16::from_bits)
}

fn any_q6_26() -> impl Strategy<Value = I6F26> {
    prop_oneof![any::<i32>(), Just(i32::MIN), Just(i32::MAX), Just(0)].prop_map(I6F26::from_bits)
}

fn any_sign() -> impl Strategy<Value = Sign> {
    prop_oneof![Just(Sign::Plus), Just(Sign::Minus)]
}

/// Fixed-point networks with arbitrary bits.
fn any_fixed_network() -> impl Strategy<Value = FixedNetwork<2>> {
    let scaling = (any::<i32>(), any::<u8>(), any::<i64>(), any_q6_26(), any_q6_26()).prop_map(
        |(gain, shift, offset, low, high)| FixedScaling { gain, shift, offset: I38F26::from_bits(offset), low, high },
    );
    let power = ([any_q6_26(), any_q6_26()], any_q6_26(), any_sign())
        .prop_map(|(exponents, log2_weight, sign)| Power { exponents, log2_weight, sign });
    let affine = (any_q6_26(), [any_q6_26(), any_q6_26()]);
    (prop::array::uniform(scaling), affine, vec(power, 0..=MAX_HALF), any::<u8>()).prop_map(
        |(inputs, (bias, slopes), powers, output_shift)| FixedNetwork {
            inputs,
            sum: PowerSum { bias, slopes, powers: powers.into_iter().collect() },
            output_shift,
            activation: Activation::Linear,
        },
    )
}

proptest! {
    #[test]
    fn ramp_output_is_the_clamped_linear_output(network in any_fixed_network(), inputs in [any_q16_16(), any_q16_16()]) {
        let output = |activation| FixedNetwork { activation, ..network.clone() }.evaluate(inputs).value;
        let linear = output(Activation::Linear);
        prop_assert_eq!(output(Activation::Ramp), linear.clamp(I16F16::ZERO, I16F16::ONE));
    }
}

#[test]
fn extreme_weights_saturate() {
    let power = |sign| Power { exponents: [I6F26::MAX], log2_weight: I6F26::MAX, sign };
    let constant = FixedScaling { gain: 0, shift: 0, offset: I38F26::ONE, low: I6F26::ONE, high: I6F26::MAX };
    let output = |bias, signs: [Sign; 2]| {
        let powers = Vec::<_, 2>::from_array(signs.map(power));
        let sum = PowerSum { bias, slopes: [bias], powers };
        let output_shift = MAX_OUTPUT_SHIFT;
        FixedNetwork { inputs: [constant], sum, output_shift, activation: Activation::Linear }
            .evaluate([I16F16::ZERO])
            .value
    };
    assert_eq!(output(I6F26::MAX, [Sign::Plus; 2]), I16F16::MAX);
    assert_eq!(output(I6F26::MIN, [Sign::Minus; 2]), I16F16::MIN);
    assert_eq!(output(I6F26::ZERO, [Sign::Plus, Sign::Minus]), I16F16::ZERO);
}
