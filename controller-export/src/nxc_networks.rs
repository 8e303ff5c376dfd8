//! Fixed-point networks as NXC functions for the LEGO NXT's standard firmware, equal to the core's to the bit.
//!
//! The brick has neither reliable floating point nor 64-bit products, so products are computed in limbs of 16 bits, which
//! costs time but no accuracy. The constant parts are NXC files in the folder beside this file.

use std::fmt::{self, Write};

use mindgap_core::fixed_network::{FixedNetwork, FixedScaling};
use mindgap_core::folded::Sign;
use mindgap_core::limits::POOL_BYTES;
use mindgap_core::network::Activation;

use crate::budget::INSTRUCTIONS_PER_MS;
use crate::onboard::FREE_FLASH_BYTES;

const WIDE: &str = include_str!("nxc_networks/wide.nxc");
const POWERS: &str = include_str!("nxc_networks/powers.nxc");
const NETWORK: &str = include_str!("nxc_networks/network.nxc");

/// Measured size of the constant parts as compiled by nbc, in flash and in memory, and of each weight.
const PROGRAM_BYTES: usize = 8_600;
const MEMORY_BYTES: usize = 2_700;
const WEIGHT_BYTES: usize = 4;
/// Worst-case number of bytecode instructions of an evaluation: constant, for each input, for each product unit, and for
/// each of its exponents.
const INSTRUCTIONS: [usize; 4] = [800, 1_500, 650, 80];

/// Number of weights on a line of the table.
const A_LINE: usize = 8;

/// One network as an NXC function.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NxcNetwork {
    name: &'static str,
    documentation: &'static str,
    inputs: Vec<&'static str>,
    weights: Vec<i32>,
}

impl NxcNetwork {
    /// The function `name` with arguments named `inputs`.
    pub fn new<const N: usize>(
        name: &'static str,
        documentation: &'static str,
        inputs: [&'static str; N],
        network: &FixedNetwork<N>,
    ) -> Self {
        NxcNetwork { name, documentation, inputs: inputs.to_vec(), weights: weights(network) }
    }
}

/// NXC source that defines these networks, for a program to include.
pub fn nxc_networks(networks: &[NxcNetwork]) -> String {
    let mut table = String::new();
    let mut functions = String::new();
    let mut at = 0;
    for NxcNetwork { name, documentation, inputs, weights } in networks {
        let _ = write!(table, "  // {name}\n{}", lines(weights));
        let arguments: Vec<String> = inputs.iter().map(|input| format!("long {input}")).collect();
        let _ = write!(functions, "\n// {documentation}\nlong {name}({})\n{{\n", arguments.join(", "));
        for (place, input) in inputs.iter().enumerate() {
            let _ = writeln!(functions, "  network_input[{place}] = {input};");
        }
        let _ = writeln!(functions, "  return Network({at});\n}}");
        at += weights.len();
    }
    let table = table.trim_end().trim_end_matches(',');
    let head = "// A simulator's networks in fixed point: #include this file. Arguments and results are whole numbers that stand
// for so many 65536ths: give cm * 65536, and divide what comes back by 65536. Compile with -v=128.
";
    let table = format!("// What was learned.\nlong weights[] = {{\n{table}\n}};\n");
    [head, WIDE, POWERS, &table, NETWORK, &functions].join("\n")
}

/// Resources that networks take; displayed one a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NetworksBudget {
    /// Upper bound on the size in flash of a program that calls all of them and does nothing else.
    pub program_bytes: usize,
    /// Upper bound on its memory.
    pub memory_bytes: usize,
    /// Worst-case evaluation time of each network, ms.
    pub answer_ms: Vec<(&'static str, usize)>,
}

/// Resources that these networks take.
pub fn budget(networks: &[NxcNetwork]) -> NetworksBudget {
    let weights: usize = networks.iter().map(|network| network.weights.len()).sum();
    NetworksBudget {
        program_bytes: PROGRAM_BYTES + WEIGHT_BYTES * weights,
        memory_bytes: MEMORY_BYTES + WEIGHT_BYTES * weights,
        answer_ms: networks.iter().map(|network| (network.name, network.answer_ms())).collect(),
    }
}

impl NxcNetwork {
    fn answer_ms(&self) -> usize {
        let [always, of_input, of_power, of_exponent] = INSTRUCTIONS;
        let (inputs, powers) = (self.inputs.len(), self.weights[1] as usize);
        let instructions = always + inputs * of_input + powers * (of_power + inputs * of_exponent);
        instructions.div_ceil(INSTRUCTIONS_PER_MS as usize)
    }
}

impl fmt::Display for NetworksBudget {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let NetworksBudget { program_bytes, memory_bytes, answer_ms } = self;
        writeln!(f, "program  {program_bytes:>7} of {FREE_FLASH_BYTES} bytes of flash")?;
        write!(f, "memory   {memory_bytes:>7} of {POOL_BYTES} bytes")?;
        answer_ms.iter().try_for_each(|(name, ms)| write!(f, "\n{name:<15} {ms} ms an answer at worst"))
    }
}

/// The weights in the order in which `Network` in network.nxc reads them.
fn weights<const N: usize>(network: &FixedNetwork<N>) -> Vec<i32> {
    let FixedNetwork { inputs, sum, output_shift, activation } = network;
    let is_ramp = i32::from(*activation == Activation::Ramp);
    let mut weights = vec![N as i32, sum.powers.len() as i32, i32::from(*output_shift), is_ramp];
    weights.extend(inputs.iter().flat_map(scaling));
    weights.push(sum.bias.to_bits());
    weights.extend(sum.slopes.iter().map(|slope| slope.to_bits()));
    for power in &sum.powers {
        weights.extend([i32::from(power.sign == Sign::Minus), power.log2_weight.to_bits()]);
        weights.extend(power.exponents.iter().map(|exponent| exponent.to_bits()));
    }
    weights
}

/// Gain, shift, the four limbs of the offset, and the range.
fn scaling(scaling: &FixedScaling) -> [i32; 8] {
    let FixedScaling { gain, shift, offset, low, high } = scaling;
    let offset = offset.to_bits();
    let piece = |i: u32| ((offset >> (16 * i)) & 0xffff) as i32;
    let highest = (offset >> 48) as i32;
    [*gain, i32::from(*shift), highest, piece(2), piece(1), piece(0), low.to_bits(), high.to_bits()]
}

fn lines(weights: &[i32]) -> String {
    let line = |numbers: &[i32]| {
        let words: Vec<String> = numbers.iter().map(i32::to_string).collect();
        format!("  {},\n", words.join(", "))
    };
    weights.chunks(A_LINE).map(line).collect()
}
