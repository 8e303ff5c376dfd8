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
            FixedScaling { gain: 1895709696, shift: 28, offset: I38F26::from_bits(94878048), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1895709696, shift: 28, offset: I38F26::from_bits(94878048), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1895709696, shift: 28, offset: I38F26::from_bits(94878048), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1895709696, shift: 28, offset: I38F26::from_bits(94878048), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
    ],
    sum: PowerSum {
        bias: I6F26::from_bits(-39055132),
        slopes: [I6F26::from_bits(-5542500), I6F26::from_bits(6595802), I6F26::from_bits(21481180), I6F26::from_bits(-9296995)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-21927802), I6F26::from_bits(-29346698), I6F26::from_bits(6156329), I6F26::from_bits(15909813)], log2_weight: I6F26::from_bits(-20890595), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-119699616), I6F26::from_bits(-132045120), I6F26::from_bits(-30988506), I6F26::from_bits(-33175552)], log2_weight: I6F26::from_bits(59190058), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-66615692), I6F26::from_bits(43534708), I6F26::from_bits(21754286), I6F26::from_bits(86295968)], log2_weight: I6F26::from_bits(-58254711), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-23215084), I6F26::from_bits(-30792960), I6F26::from_bits(5818426), I6F26::from_bits(15554650)], log2_weight: I6F26::from_bits(-20069228), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-21791504), I6F26::from_bits(-29198570), I6F26::from_bits(6228982), I6F26::from_bits(15926404)], log2_weight: I6F26::from_bits(-20976559), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-22303894), I6F26::from_bits(-29588848), I6F26::from_bits(6070580), I6F26::from_bits(15834933)], log2_weight: I6F26::from_bits(-20713463), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-22053858), I6F26::from_bits(-29653284), I6F26::from_bits(6208704), I6F26::from_bits(15771749)], log2_weight: I6F26::from_bits(-20762800), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(113941312), I6F26::from_bits(-55174096), I6F26::from_bits(17410502), I6F26::from_bits(38993808)], log2_weight: I6F26::from_bits(-22214735), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-21968396), I6F26::from_bits(-29327092), I6F26::from_bits(6187128), I6F26::from_bits(15889575)], log2_weight: I6F26::from_bits(-20888167), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(75629536), I6F26::from_bits(116765080), I6F26::from_bits(3771122), I6F26::from_bits(33458)], log2_weight: I6F26::from_bits(-9499747), sign: Sign::Plus },
        ]),
    },
    output_shift: 1,
    activation: Activation::Linear,
};

/// Probability of an echo.
pub static ECHO_PROBABILITY: FixedNetwork<2, 5> = FixedNetwork {
    inputs: [
            FixedScaling { gain: 1980803584, shift: 29, offset: I38F26::from_bits(65913492), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1582486528, shift: 27, offset: I38F26::from_bits(67085684), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
    ],
    sum: PowerSum {
        bias: I6F26::from_bits(-275591488),
        slopes: [I6F26::from_bits(46738304), I6F26::from_bits(80232584)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-134294032), I6F26::from_bits(-114141792)], log2_weight: I6F26::from_bits(128236982), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-134294032), I6F26::from_bits(-114141792)], log2_weight: I6F26::from_bits(128236982), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-920584704), I6F26::from_bits(-598095808)], log2_weight: I6F26::from_bits(108281233), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-360962144), I6F26::from_bits(-358607008)], log2_weight: I6F26::from_bits(117515761), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-473089664), I6F26::from_bits(-255233264)], log2_weight: I6F26::from_bits(127599547), sign: Sign::Minus },
        ]),
    },
    output_shift: 0,
    activation: Activation::Ramp,
};
