//! `nbc`, the compiler for NXT programs.

use std::process::Command;

/// Compiles NXC for standard firmware and returns the .rxe.
///
/// # Panics
/// If the compiler reports an error or a warning.
pub fn compile(source: &str) -> Vec<u8> {
    compile_for(source, "-v=128")
}

/// Compiles NXC for the firmware that an option of `nbc` names.
///
/// # Panics
/// If the compiler reports an error or a warning.
pub fn compile_for(source: &str, firmware: &str) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // The compiler chooses the language by the extension. With any other than .nxc it writes rubbish and reports success.
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
