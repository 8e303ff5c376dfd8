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
        bias: I6F26::from_bits(-47821048),
        slopes: [I6F26::from_bits(-16601798), I6F26::from_bits(-15525936), I6F26::from_bits(27756094), I6F26::from_bits(-24268686)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-36645696), I6F26::from_bits(-34708428), I6F26::from_bits(7674704), I6F26::from_bits(-6200106)], log2_weight: I6F26::from_bits(-2499913), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(55473120), I6F26::from_bits(2452339), I6F26::from_bits(9106670), I6F26::from_bits(97950440)], log2_weight: I6F26::from_bits(-69002607), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(92648456), I6F26::from_bits(102941992), I6F26::from_bits(5107252), I6F26::from_bits(-8543962)], log2_weight: I6F26::from_bits(645704), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-36712340), I6F26::from_bits(-34619084), I6F26::from_bits(7408919), I6F26::from_bits(-6140100)], log2_weight: I6F26::from_bits(-2526849), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-36616872), I6F26::from_bits(-34819928), I6F26::from_bits(8085146), I6F26::from_bits(-6265644)], log2_weight: I6F26::from_bits(-2451107), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-36644096), I6F26::from_bits(-34732996), I6F26::from_bits(7748748), I6F26::from_bits(-6212820)], log2_weight: I6F26::from_bits(-2488319), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-36649424), I6F26::from_bits(-34731384), I6F26::from_bits(7758550), I6F26::from_bits(-6209172)], log2_weight: I6F26::from_bits(-2486786), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(76168568), I6F26::from_bits(-123224304), I6F26::from_bits(21963672), I6F26::from_bits(-37778312)], log2_weight: I6F26::from_bits(-40727288), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-123636104), I6F26::from_bits(86258048), I6F26::from_bits(19052236), I6F26::from_bits(13762669)], log2_weight: I6F26::from_bits(-31813556), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-131803656), I6F26::from_bits(-124237136), I6F26::from_bits(-14603509), I6F26::from_bits(-16579102)], log2_weight: I6F26::from_bits(55360552), sign: Sign::Minus },
        ]),
    },
    output_shift: 1,
    activation: Activation::Linear,
};

/// Probability of an echo.
pub static ECHO_PROBABILITY: FixedNetwork<2, 5> = FixedNetwork {
    inputs: [
            FixedScaling { gain: 2001955456, shift: 29, offset: I38F26::from_bits(65799308), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1613891072, shift: 27, offset: I38F26::from_bits(67100984), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
    ],
    sum: PowerSum {
        bias: I6F26::from_bits(5168719),
        slopes: [I6F26::from_bits(-2523806), I6F26::from_bits(874049)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(175888368), I6F26::from_bits(641718144)], log2_weight: I6F26::from_bits(-676886521), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(56034524), I6F26::from_bits(450410432)], log2_weight: I6F26::from_bits(-332193979), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-225927888), I6F26::from_bits(126118536)], log2_weight: I6F26::from_bits(-308770920), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-61211992), I6F26::from_bits(331769184)], log2_weight: I6F26::from_bits(-313889599), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(111986656), I6F26::from_bits(531551040)], log2_weight: I6F26::from_bits(-424442701), sign: Sign::Plus },
        ]),
    },
    output_shift: 5,
    activation: Activation::Ramp,
};
