//! Puts the page of `mindgap serve` into the program, if `MINDGAP_PAGE` names it.

use std::path::PathBuf;
use std::{env, fs};

fn main() {
    println!("cargo::rerun-if-env-changed=MINDGAP_PAGE");
    let page = env::var_os("MINDGAP_PAGE").map(|path| {
        println!("cargo::rerun-if-changed={}", path.display());
        fs::read(path).expect("MINDGAP_PAGE is the path of a page, from host-sim/command")
    });
    let copy = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it")).join("page.html");
    fs::write(copy, page.unwrap_or_default()).expect("a copy of the page");
}
