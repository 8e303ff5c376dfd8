//! Networks of the sizes of Table I; made by `cargo run -p mindgap-tests --bin firmware-networks`.

use fixed::types::{I6F26, I38F26};
use heapless::Vec;
use mindgap_core::fixed_network::{FixedNetwork, FixedScaling};
use mindgap_core::folded::{Power, PowerSum, Sign};
use mindgap_core::network::Activation;

/// Forward movement in a step in cm.
pub static FORWARD: FixedNetwork<4, 10> = FixedNetwork {
    inputs: [
            FixedScaling { gain: 1374389504, shift: 28, offset: I38F26::from_bits(100663296), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1374389504, shift: 28, offset: I38F26::from_bits(100663296), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1374389504, shift: 28, offset: I38F26::from_bits(100663296), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1374389504, shift: 28, offset: I38F26::from_bits(100663296), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
    ],
    sum: PowerSum {
        bias: I6F26::from_bits(-50331648),
        slopes: [I6F26::from_bits(13631488), I6F26::from_bits(13631488), I6F26::from_bits(3145728), I6F26::from_bits(3145728)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(93587040), I6F26::from_bits(-122447712), I6F26::from_bits(-109389504), I6F26::from_bits(76295648)], log2_weight: I6F26::from_bits(-111128814), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(93693944), I6F26::from_bits(-122453848), I6F26::from_bits(-109455184), I6F26::from_bits(76426264)], log2_weight: I6F26::from_bits(-111128814), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(41274624), I6F26::from_bits(34758848), I6F26::from_bits(-30897408), I6F26::from_bits(129838816)], log2_weight: I6F26::from_bits(-117407600), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(41248164), I6F26::from_bits(34738412), I6F26::from_bits(-30793538), I6F26::from_bits(129971288)], log2_weight: I6F26::from_bits(-117407600), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-27754624), I6F26::from_bits(-28896416), I6F26::from_bits(-10167648), I6F26::from_bits(-66497856)], log2_weight: I6F26::from_bits(-144277390), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-27887164), I6F26::from_bits(-28925090), I6F26::from_bits(-10127152), I6F26::from_bits(-66557416)], log2_weight: I6F26::from_bits(-144277390), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-5681440), I6F26::from_bits(98984416), I6F26::from_bits(4328576), I6F26::from_bits(69931456)], log2_weight: I6F26::from_bits(-88807865), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-5725158), I6F26::from_bits(99006392), I6F26::from_bits(4219788), I6F26::from_bits(70005320)], log2_weight: I6F26::from_bits(-88807865), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(75095040), I6F26::from_bits(-36352800), I6F26::from_bits(-70332576), I6F26::from_bits(-11530464)], log2_weight: I6F26::from_bits(-123405228), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(75015328), I6F26::from_bits(-36355416), I6F26::from_bits(-70302392), I6F26::from_bits(-11614178)], log2_weight: I6F26::from_bits(-123405228), sign: Sign::Minus },
        ]),
    },
    output_shift: 6,
    activation: Activation::Linear,
};

/// Probability of an echo.
pub static ECHO_PROBABILITY: FixedNetwork<2, 5> = FixedNetwork {
    inputs: [
            FixedScaling { gain: 1077952640, shift: 28, offset: I38F26::from_bits(67108864), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1527099520, shift: 27, offset: I38F26::from_bits(67108864), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
    ],
    sum: PowerSum {
        bias: I6F26::from_bits(36909876),
        slopes: [I6F26::from_bits(-5033165), I6F26::from_bits(-13421773)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-103815744), I6F26::from_bits(11899168)], log2_weight: I6F26::from_bits(107485656), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-103941240), I6F26::from_bits(11883731)], log2_weight: I6F26::from_bits(107485656), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(16319008), I6F26::from_bits(82187136)], log2_weight: I6F26::from_bits(70930196), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(16301689), I6F26::from_bits(82184016)], log2_weight: I6F26::from_bits(70930196), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-23455936), I6F26::from_bits(2489152)], log2_weight: I6F26::from_bits(-580079372), sign: Sign::Plus },
        ]),
    },
    output_shift: 2,
    activation: Activation::Ramp,
};
