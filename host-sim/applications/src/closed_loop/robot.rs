//! Robots that a loop can drive: an external command, or a person with a brick.

use std::ffi::OsStr;
use std::io::{self, BufRead, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_workers::program::Program;

/// Largest log of one run, bytes: that of the longest controller has a third.
pub const MAX_LOG_BYTES: u64 = 32 << 20;

/// A robot that drives a controller and logs the run.
pub trait TrialRobot {
    /// Drives a controller and writes the log to `call.out`.
    ///
    /// # Errors
    /// If the drive failed; its log is not used.
    fn drive(&mut self, call: &Call) -> Result<()>;
}

/// The arguments of one drive.
pub struct Call<'a> {
    /// Controller file.
    pub controller: &'a Path,
    /// Scene file.
    pub scene: &'a Path,
    /// Number of the start in the scene, from 1.
    pub start: usize,
    /// Log to write.
    pub out: &'a Path,
    /// Seed for simulated robots.
    pub seed: u64,
}

/// A robot driven by an external command, which is called with controller, scene, start, log and seed, writes the log and
/// exits with 0.
pub struct CommandRobot(Program);

/// A person who loads the controller onto a brick, drives, and enters the path of the log.
pub struct AskRobot;

impl CommandRobot {
    /// Takes a command with its first arguments, as in a shell, and the timeout of one call.
    ///
    /// # Errors
    /// If the command is empty or has an open quote.
    pub fn new(command: &str, timeout: Duration) -> Result<Self> {
        Program::new("the robot's command", command, timeout).map(CommandRobot)
    }
}

impl TrialRobot for CommandRobot {
    fn drive(&mut self, call: &Call) -> Result<()> {
        let [controller, scene, out] =
            [files::absolute(call.controller)?, files::absolute(call.scene)?, files::absolute(call.out)?];
        let [start, seed] = [call.start.to_string(), call.seed.to_string()];
        let arguments: [&OsStr; 5] = [controller.as_ref(), scene.as_ref(), start.as_ref(), out.as_ref(), seed.as_ref()];
        self.0.run(&arguments)
    }
}

impl TrialRobot for AskRobot {
    fn drive(&mut self, call: &Call) -> Result<()> {
        eprintln!(
            "Load {} on the robot (mindgap export {0} --format rxe --out loop.rxe), put it on start {} of {}, and let it drive.\n\
             Then enter the path of the run's log:",
            call.controller.display(),
            call.start,
            call.scene.display()
        );
        io::stderr().flush().map_err(|e| Error::new(format!("standard error cannot be written: {e}")))?;
        let mut answer = String::new();
        io::stdin()
            .lock()
            .read_line(&mut answer)
            .map_err(|e| Error::new(format!("standard input cannot be read: {e}")))?;
        let path = PathBuf::from(answer.trim());
        if path.as_os_str().is_empty() {
            return Err(Error::new("no log was given"));
        }
        files::write(call.out, files::read_bytes(&path, MAX_LOG_BYTES)?)
    }
}
