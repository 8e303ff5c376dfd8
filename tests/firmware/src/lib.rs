//! What the images share: [`job`] makes the same results on every processor, [`report`] prints them.
#![cfg_attr(target_os = "none", no_std)]

pub mod controller;
pub mod job;
#[rustfmt::skip]
pub mod networks;
#[cfg(target_os = "none")]
pub mod stack;
#[cfg(all(target_os = "none", not(cortex_m)))]
mod start;

/// Prints a line: by defmt on Cortex-M, as plain text elsewhere. The arguments are such that all print them alike.
#[macro_export]
macro_rules! report {
    ($($argument:tt)*) => { $crate::report_with::println!($($argument)*) };
}

/// Who prints.
pub mod report_with {
    #[cfg(cortex_m)]
    pub use defmt::println;
    #[cfg(all(target_os = "none", not(cortex_m)))]
    pub use semihosting::println;
    #[cfg(not(target_os = "none"))]
    pub use std::println;
}
