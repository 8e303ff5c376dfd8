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
            FixedScaling { gain: 1895709696, shift: 28, offset: I38F26::from_bits(94878048), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1895709696, shift: 28, offset: I38F26::from_bits(94878048), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1895709696, shift: 28, offset: I38F26::from_bits(94878048), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1895709696, shift: 28, offset: I38F26::from_bits(94878048), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
    ],
    sum: PowerSum {
        bias: I6F26::from_bits(-2198679),
        slopes: [I6F26::from_bits(-22916058), I6F26::from_bits(19477572), I6F26::from_bits(-39185136), I6F26::from_bits(40059044)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-73155488), I6F26::from_bits(159440240), I6F26::from_bits(-5649045), I6F26::from_bits(9265163)], log2_weight: I6F26::from_bits(21922060), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(164090800), I6F26::from_bits(-75692072), I6F26::from_bits(10868079), I6F26::from_bits(-5719791)], log2_weight: I6F26::from_bits(15739675), sign: Sign::Minus },
        ]),
    },
    output_shift: 4,
    activation: Activation::Linear,
};

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

/// Way to the left in a step, cm.
pub static LATERAL: FixedNetwork<4, 10> = FixedNetwork {
    inputs: [
            FixedScaling { gain: 1895709696, shift: 28, offset: I38F26::from_bits(94878048), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1895709696, shift: 28, offset: I38F26::from_bits(94878048), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1895709696, shift: 28, offset: I38F26::from_bits(94878048), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1895709696, shift: 28, offset: I38F26::from_bits(94878048), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
    ],
    sum: PowerSum {
        bias: I6F26::from_bits(2277348),
        slopes: [I6F26::from_bits(18999548), I6F26::from_bits(-13088758), I6F26::from_bits(3106888), I6F26::from_bits(-1386285)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(180529728), I6F26::from_bits(17191538), I6F26::from_bits(188439888), I6F26::from_bits(-125296536)], log2_weight: I6F26::from_bits(-259370811), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-132211784), I6F26::from_bits(-92444768), I6F26::from_bits(-72815880), I6F26::from_bits(175292512)], log2_weight: I6F26::from_bits(-95210376), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-203192272), I6F26::from_bits(61712584), I6F26::from_bits(-57091416), I6F26::from_bits(-25648584)], log2_weight: I6F26::from_bits(-77209819), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(119527872), I6F26::from_bits(-36024964), I6F26::from_bits(-68698992), I6F26::from_bits(120703984)], log2_weight: I6F26::from_bits(-155389817), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(305286432), I6F26::from_bits(-9607801), I6F26::from_bits(-16938022), I6F26::from_bits(26807920)], log2_weight: I6F26::from_bits(-223402494), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-11357496), I6F26::from_bits(159157328), I6F26::from_bits(10734213), I6F26::from_bits(-24460502)], log2_weight: I6F26::from_bits(-75365243), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(55631416), I6F26::from_bits(-38500432), I6F26::from_bits(97873304), I6F26::from_bits(-110463848)], log2_weight: I6F26::from_bits(-43445216), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-37651500), I6F26::from_bits(-307549280), I6F26::from_bits(9869992), I6F26::from_bits(49147900)], log2_weight: I6F26::from_bits(-56543281), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-111500536), I6F26::from_bits(30943506), I6F26::from_bits(-18524734), I6F26::from_bits(15040463)], log2_weight: I6F26::from_bits(-111365322), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-3601178), I6F26::from_bits(291352064), I6F26::from_bits(-13550178), I6F26::from_bits(15654354)], log2_weight: I6F26::from_bits(-163577673), sign: Sign::Plus },
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

/// Mean reading, cm.
pub static ECHO_VALUE: FixedNetwork<2, 20> = FixedNetwork {
    inputs: [
            FixedScaling { gain: 2029394688, shift: 29, offset: I38F26::from_bits(65884168), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
            FixedScaling { gain: 1582486528, shift: 27, offset: I38F26::from_bits(67085684), low: I6F26::from_bits(67108864), high: I6F26::from_bits(134217728) },
    ],
    sum: PowerSum {
        bias: I6F26::from_bits(-5840),
        slopes: [I6F26::from_bits(265226), I6F26::from_bits(39847)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-74396080), I6F26::from_bits(3729283)], log2_weight: I6F26::from_bits(-534523359), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-74396080), I6F26::from_bits(3729283)], log2_weight: I6F26::from_bits(-534523359), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-74396080), I6F26::from_bits(3729283)], log2_weight: I6F26::from_bits(-534523359), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-74396080), I6F26::from_bits(3729283)], log2_weight: I6F26::from_bits(-534523359), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(283390080), I6F26::from_bits(106506304)], log2_weight: I6F26::from_bits(-468631850), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-74396080), I6F26::from_bits(3729283)], log2_weight: I6F26::from_bits(-534523359), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-74396080), I6F26::from_bits(3729283)], log2_weight: I6F26::from_bits(-534523359), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-74396080), I6F26::from_bits(3729283)], log2_weight: I6F26::from_bits(-534523359), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(99165112), I6F26::from_bits(102506928)], log2_weight: I6F26::from_bits(-476364672), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(99821976), I6F26::from_bits(102548992)], log2_weight: I6F26::from_bits(-476137148), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(98461664), I6F26::from_bits(102428616)], log2_weight: I6F26::from_bits(-476628209), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(159316896), I6F26::from_bits(578761024)], log2_weight: I6F26::from_bits(-521969505), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(338120512), I6F26::from_bits(221823184)], log2_weight: I6F26::from_bits(-571113860), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(122356104), I6F26::from_bits(-93059240)], log2_weight: I6F26::from_bits(-486984580), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(100084168), I6F26::from_bits(102569792)], log2_weight: I6F26::from_bits(-476046956), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-104411936), I6F26::from_bits(174206288)], log2_weight: I6F26::from_bits(-484941086), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(196159840), I6F26::from_bits(429493376)], log2_weight: I6F26::from_bits(-488247249), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(144095584), I6F26::from_bits(639058368)], log2_weight: I6F26::from_bits(-612955543), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(100107784), I6F26::from_bits(102568912)], log2_weight: I6F26::from_bits(-476039862), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-74396080), I6F26::from_bits(3729283)], log2_weight: I6F26::from_bits(-534523359), sign: Sign::Minus },
        ]),
    },
    output_shift: 12,
    activation: Activation::Linear,
};
