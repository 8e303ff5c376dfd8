//! Networks trained on logs of the built-in robot; made by
//! `cargo run --release -p mindgap-tests --bin firmware-networks`.

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
        bias: I6F26::from_bits(5765312),
        slopes: [I6F26::from_bits(-6521608), I6F26::from_bits(-12840817), I6F26::from_bits(2304971), I6F26::from_bits(2412913)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-80566776), I6F26::from_bits(-341453696), I6F26::from_bits(-4951488), I6F26::from_bits(8922733)], log2_weight: I6F26::from_bits(-88978297), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(23723866), I6F26::from_bits(431397216), I6F26::from_bits(-40736), I6F26::from_bits(22551978)], log2_weight: I6F26::from_bits(-380719805), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(390971392), I6F26::from_bits(59491732), I6F26::from_bits(30792644), I6F26::from_bits(-37482996)], log2_weight: I6F26::from_bits(-388831565), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-235983184), I6F26::from_bits(-101984968), I6F26::from_bits(12390335), I6F26::from_bits(501160576)], log2_weight: I6F26::from_bits(-857539635), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-95278992), I6F26::from_bits(-695194944), I6F26::from_bits(7984184), I6F26::from_bits(11647397)], log2_weight: I6F26::from_bits(-179116640), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-17504), I6F26::from_bits(387032128), I6F26::from_bits(-4755894), I6F26::from_bits(25609034)], log2_weight: I6F26::from_bits(-235608459), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-58007400), I6F26::from_bits(173369344), I6F26::from_bits(-14181566), I6F26::from_bits(31217908)], log2_weight: I6F26::from_bits(-144340413), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-23281378), I6F26::from_bits(306077312), I6F26::from_bits(-8734093), I6F26::from_bits(26891352)], log2_weight: I6F26::from_bits(-159972254), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-17911856), I6F26::from_bits(-25398936), I6F26::from_bits(-17217768), I6F26::from_bits(12434347)], log2_weight: I6F26::from_bits(-111352608), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(425000224), I6F26::from_bits(60725004), I6F26::from_bits(34007244), I6F26::from_bits(-40592140)], log2_weight: I6F26::from_bits(-434133453), sign: Sign::Minus },
        ]),
    },
    output_shift: 6,
    activation: Activation::Linear,
};

/// Probability of an echo.
pub static ECHO_PROBABILITY: FixedNetwork<2, 5> = FixedNetwork {
    inputs: [
            FixedScaling { gain: 2001955456, shift: 29, offset: I38F26::from_bits(65799308), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1613891072, shift: 27, offset: I38F26::from_bits(67100984), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
    ],
    sum: PowerSum {
        bias: I6F26::from_bits(219425824),
        slopes: [I6F26::from_bits(2373248), I6F26::from_bits(-232466176)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-356897088), I6F26::from_bits(-137259088)], log2_weight: I6F26::from_bits(150733478), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(17258670), I6F26::from_bits(116855624)], log2_weight: I6F26::from_bits(6006619), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-492247936), I6F26::from_bits(-231704992)], log2_weight: I6F26::from_bits(79746130), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-236420672), I6F26::from_bits(-49163908)], log2_weight: I6F26::from_bits(99248868), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(17060930), I6F26::from_bits(-69565328)], log2_weight: I6F26::from_bits(5223979), sign: Sign::Minus },
        ]),
    },
    output_shift: 3,
    activation: Activation::Ramp,
};
