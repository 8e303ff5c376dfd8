//! Networks trained on logs of the built-in robot; made by
//! `cargo run --release -p mindgap-tests --bin firmware-networks`.

use fixed::types::{I6F26, I38F26};
use heapless::Vec;
use mindgap_core::fixed_network::{FixedNetwork, FixedScaling};
use mindgap_core::folded::{Power, PowerSum, Sign};
use mindgap_core::network::Activation;

/// Turn to the left in a step, degrees.
pub static TURN: FixedNetwork<4, 2> = FixedNetwork {
    inputs: [
            FixedScaling { gain: 1908874368, shift: 28, offset: I38F26::from_bits(94604856), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1857283200, shift: 28, offset: I38F26::from_bits(95675472), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1908874368, shift: 28, offset: I38F26::from_bits(94604856), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1857283200, shift: 28, offset: I38F26::from_bits(95675472), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
    ],
    sum: PowerSum {
        bias: I6F26::from_bits(-30213708),
        slopes: [I6F26::from_bits(-195014944), I6F26::from_bits(235943760), I6F26::from_bits(-52006680), I6F26::from_bits(42570016)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-123776544), I6F26::from_bits(212684928), I6F26::from_bits(-8310894), I6F26::from_bits(39334740)], log2_weight: I6F26::from_bits(-131996414), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(200955792), I6F26::from_bits(-89208104), I6F26::from_bits(12763468), I6F26::from_bits(-15087999)], log2_weight: I6F26::from_bits(-78119705), sign: Sign::Minus },
        ]),
    },
    output_shift: 4,
    activation: Activation::Linear,
};

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

/// Way to the left in a step, cm.
pub static LATERAL: FixedNetwork<4, 10> = FixedNetwork {
    inputs: [
            FixedScaling { gain: 1908874368, shift: 28, offset: I38F26::from_bits(94604856), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1857283200, shift: 28, offset: I38F26::from_bits(95675472), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1908874368, shift: 28, offset: I38F26::from_bits(94604856), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1857283200, shift: 28, offset: I38F26::from_bits(95675472), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
    ],
    sum: PowerSum {
        bias: I6F26::from_bits(-34712632),
        slopes: [I6F26::from_bits(3297045), I6F26::from_bits(4857164), I6F26::from_bits(-9401815), I6F26::from_bits(159309472)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-14921551), I6F26::from_bits(-254661552), I6F26::from_bits(46428704), I6F26::from_bits(71578616)], log2_weight: I6F26::from_bits(-24740179), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-10912599), I6F26::from_bits(-40865500), I6F26::from_bits(2732493), I6F26::from_bits(72911752)], log2_weight: I6F26::from_bits(62944246), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(291397152), I6F26::from_bits(-90736680), I6F26::from_bits(72049936), I6F26::from_bits(106174280)], log2_weight: I6F26::from_bits(-460538999), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-37082640), I6F26::from_bits(-162493440), I6F26::from_bits(9353212), I6F26::from_bits(102808488)], log2_weight: I6F26::from_bits(7496223), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-12599884), I6F26::from_bits(-42383244), I6F26::from_bits(1889052), I6F26::from_bits(73603528)], log2_weight: I6F26::from_bits(62368173), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(57480884), I6F26::from_bits(396905408), I6F26::from_bits(1181178752), I6F26::from_bits(-281158784)], log2_weight: I6F26::from_bits(-1665943806), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-6652030), I6F26::from_bits(274185600), I6F26::from_bits(464539936), I6F26::from_bits(-173946816)], log2_weight: I6F26::from_bits(-851346923), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(11852361), I6F26::from_bits(-123472400), I6F26::from_bits(31629416), I6F26::from_bits(36381064)], log2_weight: I6F26::from_bits(56107553), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-170811792), I6F26::from_bits(-1012404992), I6F26::from_bits(-318587328), I6F26::from_bits(790472704)], log2_weight: I6F26::from_bits(-811930401), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(201816944), I6F26::from_bits(-45622148), I6F26::from_bits(46664812), I6F26::from_bits(42047592)], log2_weight: I6F26::from_bits(-223413230), sign: Sign::Minus },
        ]),
    },
    output_shift: 4,
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

/// Mean reading, cm.
pub static ECHO_VALUE: FixedNetwork<2, 20> = FixedNetwork {
    inputs: [
            FixedScaling { gain: 2001955456, shift: 29, offset: I38F26::from_bits(65799308), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1613891072, shift: 27, offset: I38F26::from_bits(67100984), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
    ],
    sum: PowerSum {
        bias: I6F26::from_bits(-351105),
        slopes: [I6F26::from_bits(818809), I6F26::from_bits(-726446)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(151721696), I6F26::from_bits(-25155972)], log2_weight: I6F26::from_bits(-335023560), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(161576752), I6F26::from_bits(-321424992)], log2_weight: I6F26::from_bits(-287720526), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-75539808), I6F26::from_bits(26237872)], log2_weight: I6F26::from_bits(-381513216), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-75539808), I6F26::from_bits(26237872)], log2_weight: I6F26::from_bits(-381513216), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-75539808), I6F26::from_bits(26237872)], log2_weight: I6F26::from_bits(-381513216), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-75539808), I6F26::from_bits(26237872)], log2_weight: I6F26::from_bits(-381513216), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(151408752), I6F26::from_bits(-25288192)], log2_weight: I6F26::from_bits(-335147999), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-75539808), I6F26::from_bits(26237872)], log2_weight: I6F26::from_bits(-381513216), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(231118832), I6F26::from_bits(259175312)], log2_weight: I6F26::from_bits(-363548328), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-266519008), I6F26::from_bits(425146688)], log2_weight: I6F26::from_bits(-422097932), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(389508640), I6F26::from_bits(-10028156)], log2_weight: I6F26::from_bits(-298097174), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(431641664), I6F26::from_bits(85983072)], log2_weight: I6F26::from_bits(-398268068), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(151514032), I6F26::from_bits(-25250628)], log2_weight: I6F26::from_bits(-335105490), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(65533532), I6F26::from_bits(371096832)], log2_weight: I6F26::from_bits(-346373518), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(151508960), I6F26::from_bits(-25252724)], log2_weight: I6F26::from_bits(-335107512), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(373570912), I6F26::from_bits(-221055088)], log2_weight: I6F26::from_bits(-389524591), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-75539808), I6F26::from_bits(26237872)], log2_weight: I6F26::from_bits(-381513216), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-112688912), I6F26::from_bits(428148576)], log2_weight: I6F26::from_bits(-363698635), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(151494576), I6F26::from_bits(-25258492)], log2_weight: I6F26::from_bits(-335113269), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(151677264), I6F26::from_bits(-25158170)], log2_weight: I6F26::from_bits(-335042250), sign: Sign::Plus },
        ]),
    },
    output_shift: 10,
    activation: Activation::Linear,
};
