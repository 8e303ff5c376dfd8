//! Fixed-point networks as NXC functions for the LEGO NXT's standard firmware, equal to the core's to the bit.
//!
//! The brick has neither reliable floating point nor 64-bit products, so products are computed in limbs of 16 bits, which
//! costs time but no accuracy. The constant parts are NXC files in the folder beside this file.

use std::fmt::{self, Write};

use mindgap_core::limits::POOL_BYTES;

use crate::budget::INSTRUCTIONS_PER_MS;
use crate::onboard::FREE_FLASH_BYTES;
use crate::tabulated::{Tabulated, lines};

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

/// NXC source that defines these networks, for a program to include.
pub fn nxc_networks(networks: &[Tabulated]) -> String {
    let mut table = String::new();
    let mut functions = String::new();
    let mut at = 0;
    for Tabulated { name, documentation, inputs, weights } in networks {
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
pub fn budget(networks: &[Tabulated]) -> NetworksBudget {
    let weights: usize = networks.iter().map(|network| network.weights.len()).sum();
    NetworksBudget {
        program_bytes: PROGRAM_BYTES + WEIGHT_BYTES * weights,
        memory_bytes: MEMORY_BYTES + WEIGHT_BYTES * weights,
        answer_ms: networks.iter().map(|network| (network.name, answer_ms(network))).collect(),
    }
}

fn answer_ms(network: &Tabulated) -> usize {
    let [always, of_input, of_power, of_exponent] = INSTRUCTIONS;
    let inputs = network.inputs.len();
    let instructions = always + inputs * of_input + network.powers() * (of_power + inputs * of_exponent);
    instructions.div_ceil(INSTRUCTIONS_PER_MS as usize)
}

impl fmt::Display for NetworksBudget {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let NetworksBudget { program_bytes, memory_bytes, answer_ms } = self;
        writeln!(f, "program  {program_bytes:>7} of {FREE_FLASH_BYTES} bytes of flash")?;
        write!(f, "memory   {memory_bytes:>7} of {POOL_BYTES} bytes")?;
        answer_ms.iter().try_for_each(|(name, ms)| write!(f, "\n{name:<15} {ms} ms an answer at worst"))
    }
}
