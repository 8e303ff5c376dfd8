//! Networks of the sizes of Table I; made by `cargo run -p mindgap-tests --bin firmware-networks`.

use fixed::types::{I6F26, I38F26};
use heapless::Vec;
use mindgap_core::fixed_network::{FixedNetwork, FixedScaling};
use mindgap_core::folded::{Power, PowerSum, Sign};
use mindgap_core::network::Activation;

/// Turn of a step in degrees.
pub static TURN: FixedNetwork<4, 2> = FixedNetwork {
    inputs: [
            FixedScaling { gain: 1374389504, shift: 28, offset: I38F26::from_bits(100663296), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1374389504, shift: 28, offset: I38F26::from_bits(100663296), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1374389504, shift: 28, offset: I38F26::from_bits(100663296), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1374389504, shift: 28, offset: I38F26::from_bits(100663296), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
    ],
    sum: PowerSum {
        bias: I6F26::from_bits(0),
        slopes: [I6F26::from_bits(-234881022), I6F26::from_bits(234881022), I6F26::from_bits(-50331647), I6F26::from_bits(50331647)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-96691264), I6F26::from_bits(-5553792), I6F26::from_bits(79751104), I6F26::from_bits(7565472)], log2_weight: I6F26::from_bits(-14555151), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-96657568), I6F26::from_bits(-5487776), I6F26::from_bits(79871864), I6F26::from_bits(7618455)], log2_weight: I6F26::from_bits(-14555151), sign: Sign::Minus },
        ]),
    },
    output_shift: 4,
    activation: Activation::Linear,
};

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

/// Movement to the left in a step in cm.
pub static LATERAL: FixedNetwork<4, 10> = FixedNetwork {
    inputs: [
            FixedScaling { gain: 1374389504, shift: 28, offset: I38F26::from_bits(100663296), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1374389504, shift: 28, offset: I38F26::from_bits(100663296), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1374389504, shift: 28, offset: I38F26::from_bits(100663296), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1374389504, shift: 28, offset: I38F26::from_bits(100663296), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
    ],
    sum: PowerSum {
        bias: I6F26::from_bits(0),
        slopes: [I6F26::from_bits(-11744051), I6F26::from_bits(11744051), I6F26::from_bits(-5033165), I6F26::from_bits(5033165)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-56806816), I6F26::from_bits(33252192), I6F26::from_bits(-90379840), I6F26::from_bits(-77031456)], log2_weight: I6F26::from_bits(-126354794), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-56746224), I6F26::from_bits(33270656), I6F26::from_bits(-90287384), I6F26::from_bits(-77146712)], log2_weight: I6F26::from_bits(-126354794), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-125969056), I6F26::from_bits(-98381440), I6F26::from_bits(101832000), I6F26::from_bits(-118228608)], log2_weight: I6F26::from_bits(-1849640), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-126040168), I6F26::from_bits(-98403312), I6F26::from_bits(101704616), I6F26::from_bits(-118357736)], log2_weight: I6F26::from_bits(-1849640), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(103399840), I6F26::from_bits(-66590592), I6F26::from_bits(-18780288), I6F26::from_bits(75172544)], log2_weight: I6F26::from_bits(-80500910), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(103283256), I6F26::from_bits(-66524032), I6F26::from_bits(-18808348), I6F26::from_bits(75301328)], log2_weight: I6F26::from_bits(-80500910), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(29828768), I6F26::from_bits(35152512), I6F26::from_bits(58669088), I6F26::from_bits(-45731168)], log2_weight: I6F26::from_bits(-120195854), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(29904434), I6F26::from_bits(35237272), I6F26::from_bits(58759188), I6F26::from_bits(-45791268)], log2_weight: I6F26::from_bits(-120195854), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-127899328), I6F26::from_bits(-45902400), I6F26::from_bits(-73033888), I6F26::from_bits(22195104)], log2_weight: I6F26::from_bits(1039522), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-127823496), I6F26::from_bits(-46012708), I6F26::from_bits(-73023304), I6F26::from_bits(22214990)], log2_weight: I6F26::from_bits(1039522), sign: Sign::Minus },
        ]),
    },
    output_shift: 3,
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

/// Mean reading in cm.
pub static ECHO_VALUE: FixedNetwork<2, 20> = FixedNetwork {
    inputs: [
            FixedScaling { gain: 1077952640, shift: 28, offset: I38F26::from_bits(67108864), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1527099520, shift: 27, offset: I38F26::from_bits(67108864), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
    ],
    sum: PowerSum {
        bias: I6F26::from_bits(-16613376),
        slopes: [I6F26::from_bits(16449536), I6F26::from_bits(262144)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(105088672), I6F26::from_bits(132928960)], log2_weight: I6F26::from_bits(-110697072), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(105044840), I6F26::from_bits(132819728)], log2_weight: I6F26::from_bits(-110697072), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-116079872), I6F26::from_bits(11885728)], log2_weight: I6F26::from_bits(-99409240), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-116136720), I6F26::from_bits(11930749)], log2_weight: I6F26::from_bits(-99409240), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-84750976), I6F26::from_bits(121608608)], log2_weight: I6F26::from_bits(-193032573), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-84719216), I6F26::from_bits(121636304)], log2_weight: I6F26::from_bits(-193032573), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(41271936), I6F26::from_bits(70724096)], log2_weight: I6F26::from_bits(-96525305), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(41340800), I6F26::from_bits(70795856)], log2_weight: I6F26::from_bits(-96525305), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(129168416), I6F26::from_bits(-12175232)], log2_weight: I6F26::from_bits(-162513137), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(129197552), I6F26::from_bits(-12200207)], log2_weight: I6F26::from_bits(-162513137), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(121069376), I6F26::from_bits(32583552)], log2_weight: I6F26::from_bits(-97042854), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(121176608), I6F26::from_bits(32631818)], log2_weight: I6F26::from_bits(-97042854), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(41898272), I6F26::from_bits(-61842816)], log2_weight: I6F26::from_bits(-115548888), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(41912044), I6F26::from_bits(-61735628)], log2_weight: I6F26::from_bits(-115548888), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(74562528), I6F26::from_bits(-28903488)], log2_weight: I6F26::from_bits(-113830066), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(74651464), I6F26::from_bits(-28980080)], log2_weight: I6F26::from_bits(-113830066), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(73641248), I6F26::from_bits(-74837984)], log2_weight: I6F26::from_bits(-141591246), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(73548144), I6F26::from_bits(-74713104)], log2_weight: I6F26::from_bits(-141591246), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-88295808), I6F26::from_bits(96240448)], log2_weight: I6F26::from_bits(-188010337), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-88274792), I6F26::from_bits(96172752)], log2_weight: I6F26::from_bits(-188010337), sign: Sign::Minus },
        ]),
    },
    output_shift: 10,
    activation: Activation::Linear,
};
