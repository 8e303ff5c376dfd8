//! A child process with everything that it starts: its process group, and, where `/proc` shows them, processes that left the
//! group.

use std::collections::HashSet;
use std::io;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, ExitStatus};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, WaitOptions};
use rustix::process::{getpid, kill_process, kill_process_group, waitid, waitpid};

use super::GLANCE;
use super::processes::{self, Process};

/// Time between SIGTERM, after which a driver stops its motors, and SIGKILL.
const GRACE: Duration = Duration::from_secs(3);
/// Time in which killed processes have to be gone.
const LAST: Duration = Duration::from_secs(2);

/// Programs that run, and those that left something behind that cannot be ended.
static RUNNING: Mutex<Vec<Kin>> = Mutex::new(Vec::new());
/// Whether orphans become children of this process, so that all its descendants are known.
static IS_ADOPTING: AtomicBool = AtomicBool::new(false);

/// A child process with everything that it starts. Dropping it ends them all.
pub struct Family {
    child: Child,
    kin: Kin,
}

/// How to recognise the processes of a program.
#[derive(Clone)]
struct Kin {
    /// The program itself, and its process group.
    root: Pid,
    /// Descendants that this process had before.
    before: HashSet<Pid>,
    /// Whether some of them outlived the program.
    is_left: bool,
}

/// Lets processes whose parents have ended become children of this process, so that programs cannot lose them. For commands
/// alone: a library must not end processes that its caller started.
#[cfg(target_os = "linux")]
pub fn adopt_orphans() {
    let is_set = rustix::process::set_child_subreaper(Some(getpid())).is_ok();
    IS_ADOPTING.store(is_set, Ordering::Relaxed);
}

/// Only Linux lets a process adopt orphans.
#[cfg(not(target_os = "linux"))]
pub fn adopt_orphans() {}

/// Ends all programs before this process ends, without grace once `is_hurried` is set. No other program starts or is reported
/// as ended while the returned guard is held.
pub fn end_all(is_hurried: &AtomicBool) -> impl Sized {
    let running = running();
    for kin in running.iter() {
        kin.end(is_hurried);
        // Nobody else will ask how it ended, and until then it looks alive.
        let _ = waitpid(Some(kin.root), WaitOptions::NOHANG);
    }
    running
}

fn running() -> MutexGuard<'static, Vec<Kin>> {
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Family {
    /// Starts a command in a process group of its own.
    ///
    /// # Errors
    /// If it cannot be started, or an earlier one left something behind that still runs.
    pub fn start(mut command: Command) -> io::Result<Self> {
        let mut running = running();
        running.retain(|kin| !kin.is_left || !kin.living().is_empty());
        if running.iter().any(|kin| kin.is_left) {
            return Err(io::Error::other("what an earlier call started still runs"));
        }
        let before = own_descendants(&processes::all()).map(|process| process.id).collect();
        let child = command.process_group(0).spawn()?;
        let kin = Kin { root: Pid::from_child(&child), before, is_left: false };
        running.push(kin.clone());
        Ok(Family { child, kin })
    }

    /// Returns whether the program itself has ended. Its id stays its own until the family is [ended](Self::end).
    pub fn has_ended(&self) -> bool {
        has_ended(self.kin.root)
    }

    /// Ends all processes that live: SIGTERM, and SIGKILL for those that do not end in time. Returns how the program ended, and
    /// the number of processes that live on, such as those of another user.
    ///
    /// # Errors
    /// If the system does not say how the program ended.
    pub fn end(&mut self) -> io::Result<(ExitStatus, usize)> {
        let left = self.kin.end(&AtomicBool::new(false));
        // While a signal ends this process, this waits for ever.
        let mut running = running();
        running.retain(|kin| kin.root != self.kin.root);
        if left > 0 {
            running.push(Kin { is_left: true, ..self.kin.clone() });
        }
        Ok((self.child.wait()?, left))
    }
}

impl Drop for Family {
    fn drop(&mut self) {
        let is_running = running().iter().any(|kin| kin.root == self.kin.root && !kin.is_left);
        if is_running {
            let _ = self.end();
        }
    }
}

impl Kin {
    fn end(&self, is_hurried: &AtomicBool) -> usize {
        let begun = Instant::now();
        let mut asked = HashSet::new();
        let living = loop {
            let living = self.living();
            let is_out_of_grace = begun.elapsed() > GRACE || is_hurried.load(Ordering::Relaxed);
            if living.is_empty() || begun.elapsed() > GRACE + LAST {
                break living;
            }
            for id in &living {
                if is_out_of_grace {
                    let _ = kill_process(*id, Signal::KILL);
                } else if asked.insert(*id) {
                    // A stopped process cannot react until it continues.
                    let _ = [Signal::TERM, Signal::CONT].map(|signal| kill_process(*id, signal));
                }
            }
            thread::sleep(GLANCE);
        };
        // Members of the group that `living` does not see: without `/proc`, or if only their first thread has ended.
        let _ = kill_process_group(self.root, Signal::KILL);
        self.bury();
        living.len()
    }

    fn living(&self) -> Vec<Pid> {
        let all = processes::all();
        if all.is_empty() {
            return Some(self.root).filter(|root| !has_ended(*root)).into_iter().collect();
        }
        let adopted: HashSet<Pid> = own_descendants(&all).map(|process| process.id).collect();
        let is_kin = |process: &&Process| {
            let is_new = adopted.contains(&process.id) && !self.before.contains(&process.id);
            process.id == self.root
                || process.group == Some(self.root)
                || processes::descends(&all, process, self.root)
                || is_new
        };
        all.iter().filter(|process| !process.is_dead).filter(is_kin).map(|process| process.id).collect()
    }

    /// Asks how adopted processes ended, which makes their ids free.
    fn bury(&self) {
        let all = processes::all();
        let is_adopted =
            |process: &&Process| process.is_dead && process.parent == Some(getpid()) && process.id != self.root;
        for process in own_descendants(&all).filter(is_adopted).filter(|process| !self.before.contains(&process.id)) {
            let _ = waitpid(Some(process.id), WaitOptions::NOHANG);
        }
    }
}

/// Returns whether a child has ended, without releasing its id.
fn has_ended(child: Pid) -> bool {
    let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
    !matches!(waitid(WaitId::Pid(child), options), Ok(None))
}

/// Returns the descendants of this process, if it knows them all.
fn own_descendants(all: &[Process]) -> impl Iterator<Item = &Process> {
    let own = Some(getpid()).filter(|_| IS_ADOPTING.load(Ordering::Relaxed));
    all.iter().filter(move |process| own.is_some_and(|own| processes::descends(all, process, own)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A program that ignores SIGTERM and starts others, in its group and outside it, which do so as well.
    #[test]
    fn nothing_of_a_family_is_left() {
        let mut command = Command::new("sh");
        command.args([
            "-c",
            "trap '' TERM; sleep 77 & (sleep 77; true) & setsid sh -c \"trap '' TERM; sleep 77; true\" & wait",
        ]);
        let mut family = Family::start(command).expect("a shell");
        let kin = family.kin.clone();
        while kin.living().len() < 5 {
            thread::sleep(GLANCE);
        }
        let begun = Instant::now();
        let (status, left) = family.end().expect("it ends");
        assert!(!status.success() && left == 0 && begun.elapsed() >= GRACE && kin.living().is_empty());
    }

    #[test]
    fn a_family_that_reacts_has_its_grace() {
        let mut command = Command::new("sh");
        command.args(["-c", "trap 'exit 7' TERM; while :; do sleep 0.01; done"]);
        let mut family = Family::start(command).expect("a shell");
        thread::sleep(10 * GLANCE);
        let begun = Instant::now();
        let (status, _) = family.end().expect("it ends");
        assert!(status.code() == Some(7) && begun.elapsed() < GRACE);
    }
}
