//! Networks trained on logs of the built-in robot; made by
//! `cargo run --release -p mindgap-tests --example firmware-networks`.

use fixed::types::{I6F26, I38F26};
use heapless::Vec;
use mindgap_core::fixed_network::{FixedNetwork, FixedScaling};
use mindgap_core::folded::{Power, PowerSum, Sign};
use mindgap_core::network::Activation;

/// Way forward in a step, cm.
pub static FORWARD: FixedNetwork<4, 10> = FixedNetwork {
    inputs: [
            FixedScaling { gain: 1908874368, shift: 28, offset: I38F26::from_bits(94604856), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1857283200, shift: 28, offset: I38F26::from_bits(95675472), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1908874368, shift: 28, offset: I38F26::from_bits(94604856), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1857283200, shift: 28, offset: I38F26::from_bits(95675472), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
    ],
    sum: PowerSum {
        bias: I6F26::from_bits(7514979),
        slopes: [I6F26::from_bits(-5498160), I6F26::from_bits(-9743005), I6F26::from_bits(1190702), I6F26::from_bits(1471045)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-339254656), I6F26::from_bits(-15832219), I6F26::from_bits(-27371346), I6F26::from_bits(45791644)], log2_weight: I6F26::from_bits(-198877154), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(69986848), I6F26::from_bits(638212480), I6F26::from_bits(15133586), I6F26::from_bits(28874188)], log2_weight: I6F26::from_bits(-752516149), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-87773512), I6F26::from_bits(-319023904), I6F26::from_bits(2171535), I6F26::from_bits(-13091294)], log2_weight: I6F26::from_bits(-172897485), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-546153088), I6F26::from_bits(-59010536), I6F26::from_bits(-38373008), I6F26::from_bits(77870136)], log2_weight: I6F26::from_bits(-276924118), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(295884832), I6F26::from_bits(56231912), I6F26::from_bits(8600547), I6F26::from_bits(-22200058)], log2_weight: I6F26::from_bits(-332274140), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(35200256), I6F26::from_bits(540424128), I6F26::from_bits(9987376), I6F26::from_bits(27788956)], log2_weight: I6F26::from_bits(-431544757), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-88256848), I6F26::from_bits(16468651), I6F26::from_bits(-17283028), I6F26::from_bits(2414817)], log2_weight: I6F26::from_bits(-186477059), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(29462492), I6F26::from_bits(515509760), I6F26::from_bits(9174205), I6F26::from_bits(27027288)], log2_weight: I6F26::from_bits(-413264839), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(344124704), I6F26::from_bits(59008372), I6F26::from_bits(10919346), I6F26::from_bits(-25582962)], log2_weight: I6F26::from_bits(-401920008), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-97538592), I6F26::from_bits(-639957888), I6F26::from_bits(12367645), I6F26::from_bits(-18919610)], log2_weight: I6F26::from_bits(-252055380), sign: Sign::Plus },
        ]),
    },
    output_shift: 7,
    activation: Activation::Linear,
};

/// Probability of an echo.
pub static ECHO_PROBABILITY: FixedNetwork<2, 5> = FixedNetwork {
    inputs: [
            FixedScaling { gain: 2001955456, shift: 29, offset: I38F26::from_bits(65799308), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1613891072, shift: 27, offset: I38F26::from_bits(67100984), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
    ],
    sum: PowerSum {
        bias: I6F26::from_bits(47116200),
        slopes: [I6F26::from_bits(-21902004), I6F26::from_bits(3490314)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-503320416), I6F26::from_bits(214259552)], log2_weight: I6F26::from_bits(-159434104), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-344530624), I6F26::from_bits(14949793)], log2_weight: I6F26::from_bits(-122617212), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-72699216), I6F26::from_bits(384830656)], log2_weight: I6F26::from_bits(-198956353), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-270542048), I6F26::from_bits(251727024)], log2_weight: I6F26::from_bits(-56493177), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-121300424), I6F26::from_bits(326365312)], log2_weight: I6F26::from_bits(-83146829), sign: Sign::Minus },
        ]),
    },
    output_shift: 2,
    activation: Activation::Ramp,
};
