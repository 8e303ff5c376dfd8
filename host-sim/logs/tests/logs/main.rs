//! Logs of the built-in robot: in longer steps, and as tables in memory.

mod resample;
mod tables;
