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

/// Way to the left in a step, cm.
pub static LATERAL: FixedNetwork<4, 10> = FixedNetwork {
    inputs: [
            FixedScaling { gain: 1908874368, shift: 28, offset: I38F26::from_bits(94604856), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1857283200, shift: 28, offset: I38F26::from_bits(95675472), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1908874368, shift: 28, offset: I38F26::from_bits(94604856), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1857283200, shift: 28, offset: I38F26::from_bits(95675472), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
    ],
    sum: PowerSum {
        bias: I6F26::from_bits(3425106),
        slopes: [I6F26::from_bits(14981978), I6F26::from_bits(-16665620), I6F26::from_bits(7487564), I6F26::from_bits(-8452325)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(166411888), I6F26::from_bits(6876238), I6F26::from_bits(81846544), I6F26::from_bits(42492916)], log2_weight: I6F26::from_bits(-162768730), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(12849405), I6F26::from_bits(242392592), I6F26::from_bits(-149358992), I6F26::from_bits(50079172)], log2_weight: I6F26::from_bits(-198226926), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-1934247), I6F26::from_bits(-76261904), I6F26::from_bits(106603520), I6F26::from_bits(-74105200)], log2_weight: I6F26::from_bits(-58433798), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(77398848), I6F26::from_bits(-175393600), I6F26::from_bits(-22309096), I6F26::from_bits(3380378)], log2_weight: I6F26::from_bits(-29295875), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(259663520), I6F26::from_bits(-2109096), I6F26::from_bits(32184564), I6F26::from_bits(11213150)], log2_weight: I6F26::from_bits(-153233008), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(121744048), I6F26::from_bits(34649048), I6F26::from_bits(177321072), I6F26::from_bits(-19140588)], log2_weight: I6F26::from_bits(-230521576), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-35701344), I6F26::from_bits(111087016), I6F26::from_bits(-93023944), I6F26::from_bits(-39420012)], log2_weight: I6F26::from_bits(-83821948), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-150495376), I6F26::from_bits(-12029554), I6F26::from_bits(-128252896), I6F26::from_bits(131768456)], log2_weight: I6F26::from_bits(-93825619), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-104174192), I6F26::from_bits(113202432), I6F26::from_bits(44711228), I6F26::from_bits(21887322)], log2_weight: I6F26::from_bits(-63316217), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-27255972), I6F26::from_bits(250797408), I6F26::from_bits(42831376), I6F26::from_bits(25868906)], log2_weight: I6F26::from_bits(-179378565), sign: Sign::Plus },
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
