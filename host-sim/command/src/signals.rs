//! Signals that end a command: nothing temporary is left behind.

use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread;

use signal_hook::consts::{SIGABRT, SIGINT, SIGTERM, SIGXFSZ};
use signal_hook::flag;
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

use mindgap_files as files;

/// Ends this process on a signal as ever, but removes what it has under temporary names first. The second signal ends it at
/// once, as where a file system does not answer.
///
/// # Errors
/// When the system gives no handlers or no thread.
pub fn heed() -> io::Result<()> {
    let ending = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&ending))?;
        flag::register(signal, Arc::clone(&ending))?;
    }
    // Without memory the standard library says so and aborts: that is a problem like others, and no fault to be debugged.
    flag::register_conditional_shutdown(SIGABRT, 1, Arc::new(AtomicBool::new(true)))?;
    // A file that may not grow is an error of the write.
    flag::register(SIGXFSZ, Arc::default())?;
    let mut signals = Signals::new([SIGINT, SIGTERM])?;
    thread::Builder::new().name("signals".into()).spawn(move || {
        if let Some(signal) = signals.forever().next() {
            let _nothing_more_begins = files::remove_temporary();
            let _ = emulate_default_handler(signal);
        }
    })?;
    Ok(())
}
