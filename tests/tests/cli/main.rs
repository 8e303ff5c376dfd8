//! The command `mindgap` as a black box.
//!
//! All tests of the command are one program, which is linked once.

mod bad_input;
mod brick;
mod bundle;
mod challenge;
mod check;
mod commands;
mod compare;
mod crosscheck;
mod demo;
mod determinism;
mod diagnose_logs;
mod drive;
#[cfg(target_os = "linux")]
mod drivers;
#[cfg(target_os = "linux")]
mod ended;
#[cfg(target_os = "linux")]
mod experiments;
#[cfg(target_os = "linux")]
mod failing_disks;
mod faults;
mod fleet;
mod general;
mod golden_files;
mod import;
mod import_measurements;
mod import_recordings;
mod information;
mod killed;
mod messages;
mod monitor;
mod new;
mod no_sensor;
mod outputs;
#[cfg(target_os = "linux")]
mod progress;
mod schemas;
mod serve;
mod sessions;
mod several_sensors;
mod trials;
