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
        bias: I6F26::from_bits(-27904264),
        slopes: [I6F26::from_bits(-123552992), I6F26::from_bits(151676784), I6F26::from_bits(-50551776), I6F26::from_bits(52555348)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-94032416), I6F26::from_bits(197337360), I6F26::from_bits(-8604814), I6F26::from_bits(11231125)], log2_weight: I6F26::from_bits(-59512254), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(182275344), I6F26::from_bits(-82802912), I6F26::from_bits(6877274), I6F26::from_bits(-5599636)], log2_weight: I6F26::from_bits(-28485590), sign: Sign::Minus },
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
        bias: I6F26::from_bits(-16202567),
        slopes: [I6F26::from_bits(54773000), I6F26::from_bits(-37448552), I6F26::from_bits(14120397), I6F26::from_bits(-13901601)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(51679316), I6F26::from_bits(120440696), I6F26::from_bits(41528928), I6F26::from_bits(16195601)], log2_weight: I6F26::from_bits(-59139193), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(20516396), I6F26::from_bits(210079424), I6F26::from_bits(-198705824), I6F26::from_bits(-1394877)], log2_weight: I6F26::from_bits(-282974834), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-20986948), I6F26::from_bits(204902480), I6F26::from_bits(-601241344), I6F26::from_bits(-90590040)], log2_weight: I6F26::from_bits(-351239272), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(44907696), I6F26::from_bits(-640555584), I6F26::from_bits(-402098592), I6F26::from_bits(-883484352)], log2_weight: I6F26::from_bits(-324520780), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(49210536), I6F26::from_bits(90131776), I6F26::from_bits(96628584), I6F26::from_bits(19403438)], log2_weight: I6F26::from_bits(-169164306), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(85880464), I6F26::from_bits(102412064), I6F26::from_bits(17309376), I6F26::from_bits(8076569)], log2_weight: I6F26::from_bits(-91296347), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(114362432), I6F26::from_bits(-19269492), I6F26::from_bits(27183002), I6F26::from_bits(61581852)], log2_weight: I6F26::from_bits(-184417497), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(19479746), I6F26::from_bits(-214458656), I6F26::from_bits(-35397860), I6F26::from_bits(-7389570)], log2_weight: I6F26::from_bits(-209918528), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-781513536), I6F26::from_bits(-315176832), I6F26::from_bits(-487778688), I6F26::from_bits(581511808)], log2_weight: I6F26::from_bits(-703080814), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(149530288), I6F26::from_bits(-32673174), I6F26::from_bits(13178035), I6F26::from_bits(19734276)], log2_weight: I6F26::from_bits(-130839518), sign: Sign::Minus },
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
        bias: I6F26::from_bits(283665120),
        slopes: [I6F26::from_bits(-246476432), I6F26::from_bits(-106090568)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(103000104), I6F26::from_bits(8641684)], log2_weight: I6F26::from_bits(41515837), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(38014616), I6F26::from_bits(148929952)], log2_weight: I6F26::from_bits(-140062112), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-428559136), I6F26::from_bits(-336527232)], log2_weight: I6F26::from_bits(61009216), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-332465696), I6F26::from_bits(-258458480)], log2_weight: I6F26::from_bits(86935474), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-816082048), I6F26::from_bits(565336832)], log2_weight: I6F26::from_bits(-679472635), sign: Sign::Plus },
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
        bias: I6F26::from_bits(-4203),
        slopes: [I6F26::from_bits(4986), I6F26::from_bits(-607)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(679259584), I6F26::from_bits(-523773664)], log2_weight: I6F26::from_bits(-917621383), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(528072992), I6F26::from_bits(-776650560)], log2_weight: I6F26::from_bits(-929314445), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(1366936832), I6F26::from_bits(-795133952)], log2_weight: I6F26::from_bits(-1205009674), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(1030455296), I6F26::from_bits(-372837056)], log2_weight: I6F26::from_bits(-969065169), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(751609664), I6F26::from_bits(346043232)], log2_weight: I6F26::from_bits(-1106943484), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(27988036), I6F26::from_bits(820643392)], log2_weight: I6F26::from_bits(-1335655541), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-57271908), I6F26::from_bits(874208512)], log2_weight: I6F26::from_bits(-1263010287), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-877256640), I6F26::from_bits(228187280)], log2_weight: I6F26::from_bits(-1314987372), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(1130865408), I6F26::from_bits(-353077856)], log2_weight: I6F26::from_bits(-1005562271), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-138094192), I6F26::from_bits(910903168)], log2_weight: I6F26::from_bits(-1256249953), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(1376838400), I6F26::from_bits(-719461504)], log2_weight: I6F26::from_bits(-1294878563), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(894025344), I6F26::from_bits(521728224)], log2_weight: I6F26::from_bits(-1502687610), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-181637936), I6F26::from_bits(924270144)], log2_weight: I6F26::from_bits(-1330369578), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(408455168), I6F26::from_bits(-1059666496)], log2_weight: I6F26::from_bits(-1015424286), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(878015360), I6F26::from_bits(-402328736)], log2_weight: I6F26::from_bits(-940870259), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(740147840), I6F26::from_bits(338266240)], log2_weight: I6F26::from_bits(-1100455606), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(1632161408), I6F26::from_bits(-538917120)], log2_weight: I6F26::from_bits(-1897149712), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(1361920512), I6F26::from_bits(-832228160)], log2_weight: I6F26::from_bits(-1249795086), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(923455744), I6F26::from_bits(568492096)], log2_weight: I6F26::from_bits(-1609334386), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(1163124992), I6F26::from_bits(-336522400)], log2_weight: I6F26::from_bits(-1091802848), sign: Sign::Minus },
        ]),
    },
    output_shift: 23,
    activation: Activation::Linear,
};
