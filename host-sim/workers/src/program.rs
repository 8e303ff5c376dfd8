//! Programs that the user names, such as the driver of a robot. Everything that such a program starts ends with it: when it
//! ends, at its time limit, and when a signal ends this process.

#[cfg_attr(not(unix), path = "program/family_elsewhere.rs")]
mod family;
#[cfg(unix)]
mod processes;

use std::ffi::OsStr;
use std::io;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use mindgap_foundations::error::{Error, Result};

use super::remove_rank_variables;
use family::Family;
pub use family::{adopt_orphans, end_all};

/// Polling interval of a program.
const GLANCE: Duration = Duration::from_millis(20);

/// A program with its first arguments.
pub struct Program {
    /// What it is to the user, such as "the robot's command".
    role: &'static str,
    name: String,
    first_arguments: Vec<String>,
    limit: Duration,
}

impl Program {
    /// Splits a command into words as a shell does, at blanks, with quotes and backslashes. No shell interprets it.
    ///
    /// # Errors
    /// If the command is empty or a quote is not closed.
    pub fn new(role: &'static str, command: &str, limit: Duration) -> Result<Self> {
        let words = shlex::split(command).ok_or_else(|| Error::new(format!("{role} has an open quote: {command}")))?;
        let mut words = words.into_iter();
        let name = words.next().ok_or_else(|| Error::new(format!("{role} is empty")))?;
        Ok(Program { role, name, first_arguments: words.collect(), limit })
    }

    /// Runs the program with further arguments to its end, at most for its limit. Its standard input is empty, and its
    /// standard output goes to standard error, since standard output is reserved for reports. Processes that it started and
    /// left behind are ended.
    ///
    /// # Errors
    /// If it cannot be started, fails, takes too long, or leaves a process that cannot be ended.
    pub fn run(&self, arguments: &[&OsStr]) -> Result<()> {
        let failed = |what: String| Error::new(format!("{} {} {what}", self.role, self.name));
        let mut command = Command::new(&self.name);
        remove_rank_variables(&mut command);
        command.args(&self.first_arguments).args(arguments).stdin(Stdio::null()).stdout(Stdio::from(io::stderr()));
        let mut family = Family::start(command).map_err(|e| failed(format!("cannot be started: {e}")))?;
        let begun = Instant::now();
        while !family.has_ended() && begun.elapsed() <= self.limit {
            thread::sleep(GLANCE);
        }
        let is_late = !family.has_ended();
        let (status, left) = family.end().map_err(|e| failed(format!("cannot be waited for: {e}")))?;
        if left > 0 {
            Err(failed(format!("left processes behind that cannot be ended ({left})")))
        } else if is_late {
            Err(failed(format!("took longer than {} s and was ended", self.limit.as_secs_f64())))
        } else if !status.success() {
            Err(failed(format!("failed: {status}")))
        } else {
            Ok(())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(command: &str) -> String {
        let program = Program::new("the robot's command", command, Duration::from_millis(300));
        program.and_then(|program| program.run(&[])).map_or_else(|e| e.to_string(), |()| "done".into())
    }

    #[test]
    fn words_are_grouped_as_in_a_shell_that_interprets_nothing() {
        assert_eq!(run("test 'a b' = \"a b\""), "done");
        assert_eq!(run("test a\\ b = 'a b'"), "done");
        assert_eq!(run("test '$HOME;' = $HOME\\;"), "done");
        assert_eq!(run("sh 'my robot.sh"), "the robot's command has an open quote: sh 'my robot.sh");
        assert_eq!(run(" "), "the robot's command is empty");
    }

    #[test]
    fn failing_and_hanging_programs_are_errors() {
        assert_eq!(run("true"), "done");
        assert!(run("false").starts_with("the robot's command false failed: "));
        assert!(run("mindgap-has-no-such-robot").contains("cannot be started"));
        assert_eq!(run("sleep 9"), "the robot's command sleep took longer than 0.3 s and was ended");
    }
}
