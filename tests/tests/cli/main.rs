//! The command `mindgap` as a black box.
//!
//! One program for all of them: it is linked once, and its tests share the processors.

mod bad_input;
mod brick;
mod broken_off;
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
mod messages;
mod new;
mod no_sensor;
mod outputs;
#[cfg(target_os = "linux")]
mod progress;
mod trials;
