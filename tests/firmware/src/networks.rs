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
        bias: I6F26::from_bits(-16185297),
        slopes: [I6F26::from_bits(-15844957), I6F26::from_bits(24435526), I6F26::from_bits(-45474892), I6F26::from_bits(45356600)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-68968088), I6F26::from_bits(159422096), I6F26::from_bits(-6086644), I6F26::from_bits(8380444)], log2_weight: I6F26::from_bits(21400986), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(160621536), I6F26::from_bits(-71197792), I6F26::from_bits(5553768), I6F26::from_bits(-5042861)], log2_weight: I6F26::from_bits(24664776), sign: Sign::Minus },
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

/// Way to the left in a step, cm.
pub static LATERAL: FixedNetwork<4, 10> = FixedNetwork {
    inputs: [
            FixedScaling { gain: 1908874368, shift: 28, offset: I38F26::from_bits(94604856), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1857283200, shift: 28, offset: I38F26::from_bits(95675472), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1908874368, shift: 28, offset: I38F26::from_bits(94604856), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1857283200, shift: 28, offset: I38F26::from_bits(95675472), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
    ],
    sum: PowerSum {
        bias: I6F26::from_bits(1726847),
        slopes: [I6F26::from_bits(8206736), I6F26::from_bits(-7585042), I6F26::from_bits(4303966), I6F26::from_bits(-5081984)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(6931909), I6F26::from_bits(247605296), I6F26::from_bits(-133974424), I6F26::from_bits(37144984)], log2_weight: I6F26::from_bits(-239210912), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(259730816), I6F26::from_bits(202669), I6F26::from_bits(47546560), I6F26::from_bits(11071840)], log2_weight: I6F26::from_bits(-221176267), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-8774042), I6F26::from_bits(127087512), I6F26::from_bits(-91401384), I6F26::from_bits(-37154688)], log2_weight: I6F26::from_bits(-155382033), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-164355296), I6F26::from_bits(-12874025), I6F26::from_bits(-124916144), I6F26::from_bits(118190104)], log2_weight: I6F26::from_bits(-149140136), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(175046736), I6F26::from_bits(14520336), I6F26::from_bits(106615080), I6F26::from_bits(42815028)], log2_weight: I6F26::from_bits(-233966652), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-110096032), I6F26::from_bits(113641704), I6F26::from_bits(36727964), I6F26::from_bits(23241906)], log2_weight: I6F26::from_bits(-128645964), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(116282232), I6F26::from_bits(43874552), I6F26::from_bits(181354416), I6F26::from_bits(8868604)], log2_weight: I6F26::from_bits(-293279340), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-25693424), I6F26::from_bits(243297968), I6F26::from_bits(53913356), I6F26::from_bits(26794606)], log2_weight: I6F26::from_bits(-253228130), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(78148208), I6F26::from_bits(-168229104), I6F26::from_bits(-20147100), I6F26::from_bits(2097118)], log2_weight: I6F26::from_bits(-99661652), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-6798224), I6F26::from_bits(-95589320), I6F26::from_bits(96667216), I6F26::from_bits(-63881288)], log2_weight: I6F26::from_bits(-124092192), sign: Sign::Plus },
        ]),
    },
    output_shift: 2,
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

/// Mean reading, cm.
pub static ECHO_VALUE: FixedNetwork<2, 20> = FixedNetwork {
    inputs: [
            FixedScaling { gain: 2001955456, shift: 29, offset: I38F26::from_bits(65799308), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1613891072, shift: 27, offset: I38F26::from_bits(67100984), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
    ],
    sum: PowerSum {
        bias: I6F26::from_bits(478729),
        slopes: [I6F26::from_bits(3110686), I6F26::from_bits(1316720)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-40715028), I6F26::from_bits(-100113096)], log2_weight: I6F26::from_bits(-303931989), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-41274900), I6F26::from_bits(505690016)], log2_weight: I6F26::from_bits(-287439584), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-76158360), I6F26::from_bits(-35455228)], log2_weight: I6F26::from_bits(-317898243), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(100234704), I6F26::from_bits(25020452)], log2_weight: I6F26::from_bits(-268414983), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-89364288), I6F26::from_bits(586882944)], log2_weight: I6F26::from_bits(-392978028), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-76158360), I6F26::from_bits(-35455228)], log2_weight: I6F26::from_bits(-317898243), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(100252368), I6F26::from_bits(25027326)], log2_weight: I6F26::from_bits(-268409341), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-76158360), I6F26::from_bits(-35455228)], log2_weight: I6F26::from_bits(-317898243), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(100266552), I6F26::from_bits(25032864)], log2_weight: I6F26::from_bits(-268404830), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(40678872), I6F26::from_bits(316832928)], log2_weight: I6F26::from_bits(-217648656), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(100227800), I6F26::from_bits(25017774)], log2_weight: I6F26::from_bits(-268417176), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(337515520), I6F26::from_bits(-141954192)], log2_weight: I6F26::from_bits(-259980573), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-76158360), I6F26::from_bits(-35455228)], log2_weight: I6F26::from_bits(-317898243), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-76158360), I6F26::from_bits(-35455228)], log2_weight: I6F26::from_bits(-317898243), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-76158360), I6F26::from_bits(-35455228)], log2_weight: I6F26::from_bits(-317898243), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(382467776), I6F26::from_bits(-302121856)], log2_weight: I6F26::from_bits(-342212750), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(100229336), I6F26::from_bits(25018368)], log2_weight: I6F26::from_bits(-268416691), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-76158360), I6F26::from_bits(-35455228)], log2_weight: I6F26::from_bits(-317898243), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(100229416), I6F26::from_bits(25018402)], log2_weight: I6F26::from_bits(-268416668), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-76158360), I6F26::from_bits(-35455228)], log2_weight: I6F26::from_bits(-317898243), sign: Sign::Minus },
        ]),
    },
    output_shift: 9,
    activation: Activation::Linear,
};
