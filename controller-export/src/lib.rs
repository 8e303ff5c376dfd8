//! Turns a six-tuple controller into an onboard program.
//!
//! * [`nxc`]: readable NXC source for the LEGO NXT's standard firmware.
//! * [`rxe`]: the compiled program itself, a third of the size.
//! * [`rust`], [`c`]: constants for the core, and a header for everything that speaks C.
//! * [`nxc_networks`], [`rust_networks`]: a simulator's networks in fixed point, in NXC and Rust.
//! * [`collect`]: a program that drives at random and logs, in NXC.
//! * [`brick`]: a brick in software, which runs such programs and proves them equal.
//! * [`wiring`], [`names`], [`onboard`], [`origin`]: what the formats share: ports, file names on the brick, what a
//!   program does beyond the controller, and where the controller came from.
//!
//! Every program runs the same stepping machine as [`mindgap_core::controller::Machine`].

pub mod brick;
pub mod budget;
mod bytecode;
pub mod c;
pub mod collect;
pub mod error;
pub mod names;
pub mod nxc;
pub mod nxc_networks;
pub mod onboard;
pub mod origin;
pub mod rust;
pub mod rust_networks;
pub mod rxe;
pub mod wiring;

pub use error::ExportError;
pub use origin::Origin;
