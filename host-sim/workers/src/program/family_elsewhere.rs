//! A child process where there are no process groups: it is ended alone.

use std::io;
use std::process::{Child, Command, ExitStatus};
use std::sync::atomic::AtomicBool;

/// A child process. Dropping it ends it.
pub struct Family(Child);

/// Only Linux lets a process adopt orphans.
pub fn adopt_orphans() {}

/// Nothing to do: no signal ends this process.
pub fn end_all(_: &AtomicBool) -> impl Sized {}

impl Family {
    /// Starts a command.
    ///
    /// # Errors
    /// If it cannot be started.
    pub fn start(mut command: Command) -> io::Result<Self> {
        command.spawn().map(Family)
    }

    /// Returns whether it has ended.
    pub fn has_ended(&mut self) -> bool {
        !matches!(self.0.try_wait(), Ok(None))
    }

    /// Ends the process. Returns how it ended and that none is left.
    ///
    /// # Errors
    /// If the system does not say how it ended.
    pub fn end(&mut self) -> io::Result<(ExitStatus, usize)> {
        let _ = self.0.kill();
        Ok((self.0.wait()?, 0))
    }
}

impl Drop for Family {
    fn drop(&mut self) {
        let _ = self.end();
    }
}
