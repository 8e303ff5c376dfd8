//! Robots that a loop can drive: an external command, or a person with a brick.

use std::fs;
use std::io::{self, BufRead, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_workers as workers;

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
pub struct CommandRobot {
    /// Command with its first arguments, separated by spaces.
    pub command: String,
    /// Timeout of one call.
    pub timeout: Duration,
}

/// A person who loads the controller onto a brick, drives, and enters the path of the log.
pub struct AskRobot;

/// Polling interval of the command.
const GLANCE: Duration = Duration::from_millis(20);

impl TrialRobot for CommandRobot {
    fn drive(&mut self, call: &Call) -> Result<()> {
        let mut words = self.command.split_whitespace();
        let program = words.next().ok_or_else(|| Error::new("the robot's command is empty"))?;
        let failed = |what: String| Error::new(format!("the robot's command {program} {what}"));
        let mut command = Command::new(program);
        workers::remove_rank_variables(&mut command);
        let mut child = command
            .args(words)
            .args([call.controller, call.scene])
            .arg(call.start.to_string())
            .arg(call.out)
            .arg(call.seed.to_string())
            .stdin(Stdio::null())
            // Standard output is reserved for the report of the loop.
            .stdout(Stdio::from(io::stderr()))
            .spawn()
            .map_err(|e| failed(format!("cannot be started: {e}")))?;
        let begun = Instant::now();
        loop {
            match child.try_wait().map_err(|e| failed(format!("cannot be waited for: {e}")))? {
                Some(status) if status.success() => return Ok(()),
                Some(status) => return Err(failed(format!("failed: {status}"))),
                None if begun.elapsed() > self.timeout => {
                    // Killing fails if it has just ended.
                    let _ = child.kill();
                    let _ = child.wait();
                    return Err(failed(format!("took longer than {} s and was killed", self.timeout.as_secs_f64())));
                }
                None => thread::sleep(GLANCE),
            }
        }
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
        let log = fs::read(&path).map_err(|e| Error::in_file(&path, format!("cannot be read: {e}")))?;
        files::write(call.out, log)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drive(command: &str) -> Result<()> {
        let path = Path::new("none");
        let call = Call { controller: path, scene: path, start: 1, out: path, seed: 1 };
        CommandRobot { command: command.into(), timeout: Duration::from_millis(200) }.drive(&call)
    }

    #[test]
    fn failing_and_hanging_commands_are_errors() {
        assert!(drive("true").is_ok());
        let problem = |command: &str| drive(command).unwrap_err().to_string();
        assert!(problem("false").starts_with("the robot's command false failed: "));
        assert!(problem("mindgap-has-no-such-robot").contains("cannot be started"));
        assert!(
            problem("tail -f /dev/null --").contains("took longer than 0.2 s") || problem("sleep 9").contains("killed")
        );
        assert_eq!(problem(" "), "the robot's command is empty");
    }
}
