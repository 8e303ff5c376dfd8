//! The compiler for NXT programs, `nbc`, as a black box.

use std::process::Command;

/// Compiles NXC for standard firmware and returns the .rxe; panics with the compiler's words when it refuses or warns.
pub fn compile(source: &str) -> Vec<u8> {
    compile_for(source, "-v=128")
}

/// Compiles NXC for the firmware that the option names.
pub fn compile_for(source: &str, firmware: &str) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // The compiler chooses the language by the ending; with another than .nxc it writes rubbish and reports success.
    let (nxc, rxe) = (folder.path().join("program.nxc"), folder.path().join("program.rxe"));
    std::fs::write(&nxc, source).expect("a file in a temporary folder");
    let output = Command::new("nbc")
        .args([firmware, "-sm-", &format!("-O={}", rxe.display())])
        .arg(&nxc)
        .output()
        .expect("the NXC compiler is missing: apt-get install nbc");
    let words = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && words.is_empty(), "{words}\n{source}");
    std::fs::read(&rxe).expect("nbc reported success and wrote nothing")
}
