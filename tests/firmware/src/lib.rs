//! The common parts of the images: [`job`] computes the same results on every processor, and [`report`] prints them.
#![cfg_attr(target_os = "none", no_std)]

pub mod controller;
pub mod job;
#[cfg(target_os = "none")]
pub mod marks;
#[rustfmt::skip]
pub mod monitor;
pub mod monitored;
#[rustfmt::skip]
pub mod networks;
#[cfg(target_os = "none")]
pub mod stack;
#[cfg(all(target_os = "none", not(cortex_m)))]
mod start;

/// Prints a line: by defmt on Cortex-M, as plain text elsewhere. The arguments have to print alike on all of them.
#[macro_export]
macro_rules! report {
    ($($argument:tt)*) => { $crate::report_with::println!($($argument)*) };
}

/// The macro that prints on this target.
pub mod report_with {
    #[cfg(cortex_m)]
    pub use defmt::println;
    #[cfg(all(target_os = "none", not(cortex_m)))]
    pub use semihosting::println;
    #[cfg(not(target_os = "none"))]
    pub use std::println;
}

/// Defines a panic handler that calls an undefined function: an image in which a panic is reachable does not link.
#[macro_export]
macro_rules! panics_must_not_link {
    () => {
        #[panic_handler]
        fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
            unsafe extern "C" {
                safe fn a_panic_is_reachable() -> !;
            }
            a_panic_is_reachable()
        }
    };
}
