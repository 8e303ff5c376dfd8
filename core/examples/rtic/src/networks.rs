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
        bias: I6F26::from_bits(7525885),
        slopes: [I6F26::from_bits(-5509447), I6F26::from_bits(-9776908), I6F26::from_bits(1191714), I6F26::from_bits(1473773)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-341430688), I6F26::from_bits(-16053013), I6F26::from_bits(-27380718), I6F26::from_bits(46115784)], log2_weight: I6F26::from_bits(-199627517), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(69725096), I6F26::from_bits(637784256), I6F26::from_bits(15162945), I6F26::from_bits(28801868)], log2_weight: I6F26::from_bits(-750319138), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-87614672), I6F26::from_bits(-317471712), I6F26::from_bits(2051954), I6F26::from_bits(-12980570)], log2_weight: I6F26::from_bits(-173161306), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-546523008), I6F26::from_bits(-58831464), I6F26::from_bits(-38294352), I6F26::from_bits(77843432)], log2_weight: I6F26::from_bits(-276355859), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(295790784), I6F26::from_bits(56207036), I6F26::from_bits(8594274), I6F26::from_bits(-22137508)], log2_weight: I6F26::from_bits(-332345043), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(35240168), I6F26::from_bits(540638592), I6F26::from_bits(10053481), I6F26::from_bits(27719950)], log2_weight: I6F26::from_bits(-431033695), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-86852856), I6F26::from_bits(16560385), I6F26::from_bits(-17147020), I6F26::from_bits(2206718)], log2_weight: I6F26::from_bits(-186832304), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(29497426), I6F26::from_bits(515727232), I6F26::from_bits(9236837), I6F26::from_bits(26961650)], log2_weight: I6F26::from_bits(-412889201), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(344126240), I6F26::from_bits(58982404), I6F26::from_bits(10913554), I6F26::from_bits(-25521088)], log2_weight: I6F26::from_bits(-402136763), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-97443448), I6F26::from_bits(-640933952), I6F26::from_bits(12281193), I6F26::from_bits(-18819728)], log2_weight: I6F26::from_bits(-253127630), sign: Sign::Plus },
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
        bias: I6F26::from_bits(47354824),
        slopes: [I6F26::from_bits(-22112222), I6F26::from_bits(3720856)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-506543776), I6F26::from_bits(213278976)], log2_weight: I6F26::from_bits(-160585271), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-338663552), I6F26::from_bits(16353150)], log2_weight: I6F26::from_bits(-120870247), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-71719656), I6F26::from_bits(384061152)], log2_weight: I6F26::from_bits(-199029361), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-269592640), I6F26::from_bits(250767152)], log2_weight: I6F26::from_bits(-56383903), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-120386072), I6F26::from_bits(325376320)], log2_weight: I6F26::from_bits(-82858760), sign: Sign::Minus },
        ]),
    },
    output_shift: 2,
    activation: Activation::Ramp,
};
