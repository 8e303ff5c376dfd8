//! Fixed-point networks as NXC functions for the LEGO NXT's standard firmware. Their results equal the core's to the bit.
//!
//! The brick has neither reliable floating point nor 64-bit products, so products are computed in limbs of 16 bits, which
//! costs time but no accuracy. The fixed parts are NXC files in `src/nxc_networks`.

use std::fmt::{self, Write};

use mindgap_core::limits::POOL_BYTES;

use crate::budget::INSTRUCTIONS_PER_MS;
use crate::onboard::FREE_FLASH_BYTES;
use crate::tabulated::{Tabulated, lines};

const WIDE: &str = include_str!("nxc_networks/wide.nxc");
const POWERS: &str = include_str!("nxc_networks/powers.nxc");
const NETWORK: &str = include_str!("nxc_networks/network.nxc");

/// Measured size of the fixed parts as compiled by nbc, in flash and in memory, and size of each weight.
const PROGRAM_BYTES: usize = 8_600;
const MEMORY_BYTES: usize = 2_700;
const WEIGHT_BYTES: usize = 4;
/// Worst-case number of bytecode instructions of an evaluation: constant, per input, per product unit, and per exponent of
/// a product unit.
const INSTRUCTIONS: [usize; 4] = [800, 1_500, 650, 80];

/// Returns NXC source that defines these networks, for a program to include.
///
/// ```
/// use mindgap_controller_export::nxc_networks::nxc_networks;
///
/// assert!(nxc_networks(&[]).contains("#include this file"));
/// ```
pub fn nxc_networks(networks: &[Tabulated]) -> String {
    let mut table = String::new();
    let mut functions = String::new();
    let mut at = 0;
    for Tabulated { name, documentation, inputs, weights } in networks {
        let _ = write!(table, "  // {name}\n{}", lines(weights));
        let arguments: Vec<String> = inputs.iter().map(|input| format!("long {input}")).collect();
        let _ = write!(functions, "\n// {documentation}\nlong {name}({})\n{{\n", arguments.join(", "));
        for (i, input) in inputs.iter().enumerate() {
            let _ = writeln!(functions, "  network_input[{i}] = {input};");
        }
        let _ = writeln!(functions, "  return Network({at});\n}}");
        at += weights.len();
    }
    let table = table.trim_end().trim_end_matches(',');
    let head = "// A simulator's networks in fixed point: #include this file and compile with -v=128. Arguments and results are integers
// in units of 1/65536: pass cm * 65536, and divide the result by 65536.
";
    let table = format!("// The trained weights.\nlong weights[] = {{\n{table}\n}};\n");
    [head, WIDE, POWERS, &table, NETWORK, &functions].join("\n")
}

/// The resources that networks need. `Display` prints one line per resource.
///
/// ```
/// use mindgap_controller_export::nxc_networks::budget;
/// use mindgap_core::limits::POOL_BYTES;
///
/// assert!(budget(&[]).memory_bytes < POOL_BYTES);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct NetworksBudget {
    /// Upper bound on the flash size of a program that only calls all of them.
    pub program_bytes: usize,
    /// Upper bound on its memory.
    pub memory_bytes: usize,
    /// Name and worst-case evaluation time of each network, in ms.
    pub answer_ms: Vec<(&'static str, usize)>,
}

/// Returns the resources that these networks need.
pub fn budget(networks: &[Tabulated]) -> NetworksBudget {
    let weights: usize = networks.iter().map(|network| network.weights.len()).sum();
    NetworksBudget {
        program_bytes: PROGRAM_BYTES + WEIGHT_BYTES * weights,
        memory_bytes: MEMORY_BYTES + WEIGHT_BYTES * weights,
        answer_ms: networks.iter().map(|network| (network.name, answer_ms(network))).collect(),
    }
}

fn answer_ms(network: &Tabulated) -> usize {
    let [constant, per_input, per_unit, per_exponent] = INSTRUCTIONS;
    let inputs = network.inputs.len();
    let instructions = constant + inputs * per_input + network.powers() * (per_unit + inputs * per_exponent);
    instructions.div_ceil(INSTRUCTIONS_PER_MS as usize)
}

impl fmt::Display for NetworksBudget {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let NetworksBudget { program_bytes, memory_bytes, answer_ms } = self;
        writeln!(f, "program  {program_bytes:>7} of {FREE_FLASH_BYTES} bytes of flash")?;
        write!(f, "memory   {memory_bytes:>7} of {POOL_BYTES} bytes")?;
        answer_ms.iter().try_for_each(|(name, ms)| write!(f, "\n{name:<15} {ms} ms per evaluation at worst"))
    }
}
