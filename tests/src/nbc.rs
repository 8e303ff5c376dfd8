//! Runs the compiler for NXT programs, `nbc`.

use std::process::Command;

/// Compiles NXC for the standard firmware and returns the .rxe file.
///
/// # Panics
/// Panics with the compiler's output when it fails or warns.
pub fn compile(source: &str) -> Vec<u8> {
    compile_for(source, "-v=128")
}

/// Compiles NXC for the firmware of an option of the compiler.
///
/// # Panics
/// As [`compile`].
pub fn compile_for(source: &str, firmware: &str) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // The compiler chooses the language by the file extension. For any other than .nxc it writes garbage and reports success.
    let (nxc, rxe) = (folder.path().join("program.nxc"), folder.path().join("program.rxe"));
    std::fs::write(&nxc, source).expect("a file in a temporary folder");
    let output = Command::new("nbc")
        .args([firmware, "-sm-", &format!("-O={}", rxe.display())])
        .arg(&nxc)
        .output()
        .expect("the NXC compiler is missing: apt-get install nbc");
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && message.is_empty(), "{message}\n{source}");
    std::fs::read(&rxe).expect("nbc reported success and wrote nothing")
}
