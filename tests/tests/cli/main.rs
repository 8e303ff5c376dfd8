//! The command `mindgap` as a black box.
//!
//! All tests of the command are one program, which is linked once.

mod bad_input;
mod brick;
mod challenge;
mod check;
mod commands;
mod crosscheck;
mod demo;
mod determinism;
mod diagnose_logs;
mod drive;
#[cfg(target_os = "linux")]
mod ended;
#[cfg(target_os = "linux")]
mod failing_disks;
mod faults;
mod fleet;
mod general;
mod golden_files;
mod import;
mod import_recordings;
mod information;
mod killed;
mod messages;
mod new;
mod no_sensor;
mod outputs;
#[cfg(target_os = "linux")]
mod progress;
mod schemas;
mod trials;
