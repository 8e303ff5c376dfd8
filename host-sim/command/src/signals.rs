//! Signals that end the process: temporary files are removed.

use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread;

use signal_hook::consts::{SIGABRT, SIGINT, SIGTERM, SIGXFSZ};
use signal_hook::flag;
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

use mindgap_files as files;

/// Installs handlers that remove temporary files before a signal ends the process. A second signal ends it immediately,
/// in case a file system does not respond.
///
/// # Errors
/// If a handler or the thread cannot be installed.
pub fn install() -> io::Result<()> {
    let ending = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&ending))?;
        flag::register(signal, Arc::clone(&ending))?;
    }
    // The standard library aborts when out of memory: exit with 1, as on other errors, without a core dump.
    flag::register_conditional_shutdown(SIGABRT, 1, Arc::new(AtomicBool::new(true)))?;
    // With this signal handled, exceeding the file size limit is an error of the write.
    flag::register(SIGXFSZ, Arc::default())?;
    let mut signals = Signals::new([SIGINT, SIGTERM])?;
    thread::Builder::new().name("signals".into()).spawn(move || {
        if let Some(signal) = signals.forever().next() {
            let _no_further_writes = files::remove_temporary();
            let _ = emulate_default_handler(signal);
        }
    })?;
    Ok(())
}
