//! Sets `short_products` for processors without an instruction for the 64-bit product of two 32-bit words.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-check-cfg=cfg(short_products)");
    let target = std::env::var("TARGET").unwrap_or_default();
    if ["thumbv4t", "thumbv5te", "thumbv6m", "thumbv8m.base"].iter().any(|core| target.starts_with(core)) {
        println!("cargo:rustc-cfg=short_products");
    }
}
