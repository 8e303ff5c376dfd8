//! Networks trained on logs of the built-in robot; made by
//! `cargo run --release -p mindgap-tests --example firmware-networks`.

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
            Power { exponents: [I6F26::from_bits(200955792), I6F26::from_bits(-89208104), I6F26::from_bits(12763468), I6F26::from_bits(-15087999)], log2_weight: I6F26::from_bits(-78119698), sign: Sign::Minus },
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
        bias: I6F26::from_bits(7514979),
        slopes: [I6F26::from_bits(-5498160), I6F26::from_bits(-9743005), I6F26::from_bits(1190702), I6F26::from_bits(1471045)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-339254656), I6F26::from_bits(-15832219), I6F26::from_bits(-27371346), I6F26::from_bits(45791644)], log2_weight: I6F26::from_bits(-198877154), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(69986848), I6F26::from_bits(638212480), I6F26::from_bits(15133586), I6F26::from_bits(28874188)], log2_weight: I6F26::from_bits(-752516149), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-87773512), I6F26::from_bits(-319023904), I6F26::from_bits(2171535), I6F26::from_bits(-13091294)], log2_weight: I6F26::from_bits(-172897485), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-546153088), I6F26::from_bits(-59010536), I6F26::from_bits(-38373008), I6F26::from_bits(77870136)], log2_weight: I6F26::from_bits(-276924118), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(295884832), I6F26::from_bits(56231912), I6F26::from_bits(8600547), I6F26::from_bits(-22200058)], log2_weight: I6F26::from_bits(-332274140), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(35200256), I6F26::from_bits(540424128), I6F26::from_bits(9987376), I6F26::from_bits(27788956)], log2_weight: I6F26::from_bits(-431544757), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-88256848), I6F26::from_bits(16468651), I6F26::from_bits(-17283028), I6F26::from_bits(2414817)], log2_weight: I6F26::from_bits(-186477059), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(29462492), I6F26::from_bits(515509760), I6F26::from_bits(9174205), I6F26::from_bits(27027288)], log2_weight: I6F26::from_bits(-413264839), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(344124704), I6F26::from_bits(59008372), I6F26::from_bits(10919346), I6F26::from_bits(-25582962)], log2_weight: I6F26::from_bits(-401920008), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-97538592), I6F26::from_bits(-639957888), I6F26::from_bits(12367645), I6F26::from_bits(-18919610)], log2_weight: I6F26::from_bits(-252055380), sign: Sign::Plus },
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
        bias: I6F26::from_bits(-34357372),
        slopes: [I6F26::from_bits(3023516), I6F26::from_bits(4823442), I6F26::from_bits(-9687034), I6F26::from_bits(159707568)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-15024074), I6F26::from_bits(-254545632), I6F26::from_bits(46514076), I6F26::from_bits(71583448)], log2_weight: I6F26::from_bits(-24562451), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-10900155), I6F26::from_bits(-39807656), I6F26::from_bits(2708186), I6F26::from_bits(73359024)], log2_weight: I6F26::from_bits(64133990), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(291631008), I6F26::from_bits(-90248976), I6F26::from_bits(72238632), I6F26::from_bits(105535384)], log2_weight: I6F26::from_bits(-459312529), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-37144100), I6F26::from_bits(-162619136), I6F26::from_bits(9248766), I6F26::from_bits(103174256)], log2_weight: I6F26::from_bits(7521588), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-12725419), I6F26::from_bits(-43610760), I6F26::from_bits(1848682), I6F26::from_bits(73269520)], log2_weight: I6F26::from_bits(61628009), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(57872080), I6F26::from_bits(394558240), I6F26::from_bits(1177397760), I6F26::from_bits(-279467648)], log2_weight: I6F26::from_bits(-1660874884), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-6130504), I6F26::from_bits(271090592), I6F26::from_bits(459104128), I6F26::from_bits(-171652256)], log2_weight: I6F26::from_bits(-842867697), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(11660164), I6F26::from_bits(-123314520), I6F26::from_bits(31749760), I6F26::from_bits(36309276)], log2_weight: I6F26::from_bits(56452890), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-170874256), I6F26::from_bits(-1003653632), I6F26::from_bits(-314231392), I6F26::from_bits(785947456)], log2_weight: I6F26::from_bits(-807885244), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(202745680), I6F26::from_bits(-45702940), I6F26::from_bits(46974744), I6F26::from_bits(42270808)], log2_weight: I6F26::from_bits(-224650055), sign: Sign::Minus },
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
        bias: I6F26::from_bits(47116200),
        slopes: [I6F26::from_bits(-21902004), I6F26::from_bits(3490314)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(-503320416), I6F26::from_bits(214259552)], log2_weight: I6F26::from_bits(-159434104), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-344530624), I6F26::from_bits(14949793)], log2_weight: I6F26::from_bits(-122617212), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-72699216), I6F26::from_bits(384830656)], log2_weight: I6F26::from_bits(-198956353), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-270542048), I6F26::from_bits(251727024)], log2_weight: I6F26::from_bits(-56493177), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-121300424), I6F26::from_bits(326365312)], log2_weight: I6F26::from_bits(-83146829), sign: Sign::Minus },
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
        bias: I6F26::from_bits(-346874),
        slopes: [I6F26::from_bits(832603), I6F26::from_bits(-743479)],
        powers: Vec::from_array([
            Power { exponents: [I6F26::from_bits(151373264), I6F26::from_bits(-24033886)], log2_weight: I6F26::from_bits(-334657615), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(158107040), I6F26::from_bits(-318624640)], log2_weight: I6F26::from_bits(-287374761), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-75480560), I6F26::from_bits(26766752)], log2_weight: I6F26::from_bits(-381559262), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-75480560), I6F26::from_bits(26766752)], log2_weight: I6F26::from_bits(-381559262), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-75480560), I6F26::from_bits(26766752)], log2_weight: I6F26::from_bits(-381559262), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-75480560), I6F26::from_bits(26766752)], log2_weight: I6F26::from_bits(-381559262), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(150545632), I6F26::from_bits(-24743708)], log2_weight: I6F26::from_bits(-334952274), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-75480560), I6F26::from_bits(26766752)], log2_weight: I6F26::from_bits(-381559262), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(234928464), I6F26::from_bits(267184336)], log2_weight: I6F26::from_bits(-370942751), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-260131472), I6F26::from_bits(429014272)], log2_weight: I6F26::from_bits(-423823255), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(383430240), I6F26::from_bits(-1166480)], log2_weight: I6F26::from_bits(-295885872), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(425780000), I6F26::from_bits(95817456)], log2_weight: I6F26::from_bits(-396075106), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(150547280), I6F26::from_bits(-24742106)], log2_weight: I6F26::from_bits(-334951689), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(66896404), I6F26::from_bits(377685728)], log2_weight: I6F26::from_bits(-349866986), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(150549728), I6F26::from_bits(-24739752)], log2_weight: I6F26::from_bits(-334950806), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(368402240), I6F26::from_bits(-213641712)], log2_weight: I6F26::from_bits(-391430008), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(-75480560), I6F26::from_bits(26766752)], log2_weight: I6F26::from_bits(-381559262), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(-107240272), I6F26::from_bits(432295872)], log2_weight: I6F26::from_bits(-364750461), sign: Sign::Minus },
            Power { exponents: [I6F26::from_bits(150547344), I6F26::from_bits(-24742178)], log2_weight: I6F26::from_bits(-334951655), sign: Sign::Plus },
            Power { exponents: [I6F26::from_bits(150677920), I6F26::from_bits(-24618516)], log2_weight: I6F26::from_bits(-334904623), sign: Sign::Plus },
        ]),
    },
    output_shift: 10,
    activation: Activation::Linear,
};
