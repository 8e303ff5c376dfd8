//! Signals that end the process: programs that it runs are ended, and temporary files are removed.

use std::fs;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use signal_hook::consts::{SIGABRT, SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXFSZ};
use signal_hook::flag;
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

use mindgap_files as files;
use mindgap_workers::program;

/// Installs handlers that end programs and remove temporary files before a signal ends the process. A second signal leaves
/// programs no time to stop their motors, and ends the process immediately once they have ended, in case a file system does
/// not respond.
///
/// # Errors
/// If a handler or the thread cannot be installed.
pub fn install() -> io::Result<()> {
    program::adopt_orphans();
    let (is_hurried, are_programs_ended) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(false)));
    let ending = || [SIGINT, SIGTERM, SIGQUIT].into_iter().chain(Some(SIGHUP).filter(|_| !outlives_its_terminal()));
    let mut signals = Signals::new(ending())?;
    for signal in ending() {
        flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&are_programs_ended))?;
    }
    // The standard library aborts when out of memory: exit with 1, as on other errors, without a core dump.
    flag::register_conditional_shutdown(SIGABRT, 1, Arc::new(AtomicBool::new(true)))?;
    // With this signal handled, exceeding the file size limit is an error of the write.
    flag::register(SIGXFSZ, Arc::default())?;
    thread::Builder::new().name("signals".into()).spawn(move || {
        let Some(signal) = signals.forever().next() else { return };
        // From here on, the flags alone count: this thread is busy.
        for signal in [SIGINT, SIGTERM, SIGQUIT] {
            let _ = flag::register(signal, Arc::clone(&is_hurried));
        }
        let _no_further_programs = program::end_all(&is_hurried);
        are_programs_ended.store(true, Ordering::Relaxed);
        let _no_further_writes = files::remove_temporary();
        let _ = emulate_default_handler(signal);
    })?;
    Ok(())
}

/// Returns whether this process was started to ignore SIGHUP, as by `nohup`.
fn outlives_its_terminal() -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|set| u64::from_str_radix(set.trim(), 16).ok()).unwrap_or_default();
    ignored & (1 << (SIGHUP - 1)) != 0
}
