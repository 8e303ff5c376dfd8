//! Fixed-point networks as a C99 header, for any board with a C compiler and for Arduino sketches. Their results equal the
//! core's to the bit.

use std::fmt::Write;

use mindgap_core::fixed_point::STEPS;

use crate::tabulated::{Tabulated, lines};

const NETWORK: &str = include_str!("c_networks/network.h");

/// Returns a header that defines one function per network, followed by `more`: nothing, or their
/// [monitor](crate::c_monitor).
///
/// ```
/// use mindgap_controller_export::c_networks::c_networks;
///
/// assert!(c_networks(&[], "").contains("#ifndef MINDGAP_NETWORKS_H"));
/// ```
pub fn c_networks(networks: &[Tabulated], more: &str) -> String {
    let mut tables =
        table("network_steps", "2^(i/32) - 1 with 32 fractional bits, unsigned.", &STEPS.map(|s| s as i32));
    let mut functions = String::new();
    for Tabulated { name, documentation, inputs, weights } in networks {
        let weights_name = format!("network_{name}_weights");
        tables += &table(&weights_name, documentation, weights);
        let arguments: Vec<String> = inputs.iter().map(|input| format!("int32_t {input}")).collect();
        let _ = write!(
            functions,
            "\n/* {documentation} */\n\
             static inline int32_t network_{name}({}) {{\n  \
               const int32_t inputs[] = {{{}}};\n  \
               return network_evaluate({weights_name}, inputs);\n\
             }}\n",
            arguments.join(", "),
            inputs.join(", ")
        );
    }
    format!(
        "/* A simulator's networks in fixed point. Arguments and results are integers in units of 1/65536: pass cm * 65536, and\n \
         * divide the result by 65536. */\n\
         #ifndef MINDGAP_NETWORKS_H\n\
         #define MINDGAP_NETWORKS_H\n\
         \n\
         #include <stdbool.h>\n\
         #include <stdint.h>\n\
         \n\
         /* AVR processors need special instructions to read their flash. */\n\
         #ifdef __AVR__\n\
         #include <avr/pgmspace.h>\n\
         #define NETWORK_FLASH PROGMEM\n\
         #define NETWORK_READ(address) ((int32_t)pgm_read_dword(address))\n\
         #else\n\
         #define NETWORK_FLASH\n\
         #define NETWORK_READ(address) (*(address))\n\
         #endif\n\
         \n\
         {tables}\n{NETWORK}{functions}{more}\n#endif\n"
    )
}

fn table(name: &str, documentation: &str, numbers: &[i32]) -> String {
    format!("/* {documentation} */\nstatic const int32_t {name}[] NETWORK_FLASH = {{\n{}}};\n", lines(numbers))
}
