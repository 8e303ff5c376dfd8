//! Selects the linker scripts for a processor, and sets `cortex_m` for Cortex-M.

use std::path::Path;
use std::{env, fs};

fn main() {
    println!("cargo:rustc-check-cfg=cfg(cortex_m)");
    println!("cargo:rerun-if-changed=link");
    let target = env::var("TARGET").expect("cargo names the target");
    match target.as_str() {
        "thumbv6m-none-eabi" | "thumbv7em-none-eabi" => {
            println!("cargo:rustc-cfg=cortex_m");
            // The script of cortex-m-rt includes a file of this name.
            let memory = if target.starts_with("thumbv6m") { "link/microbit.x" } else { "link/mps2-an386.x" };
            let out = env::var("OUT_DIR").expect("cargo names a folder");
            fs::copy(memory, Path::new(&out).join("memory.x")).expect("the folder can be written to");
            println!("cargo:rustc-link-search={out}");
            println!("cargo:rustc-link-arg-bins=-Tlink.x");
            println!("cargo:rustc-link-arg-bin=job=-Tdefmt.x");
        }
        "armv4t-none-eabi" | "thumbv4t-none-eabi" => println!("cargo:rustc-link-arg-bins=-Tlink/arm7.x"),
        _ => {}
    }
}
