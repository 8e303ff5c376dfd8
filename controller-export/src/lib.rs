//! Turns a six-tuple controller into an onboard program.
//!
//! * [`nxc`]: readable NXC source for the LEGO NXT's standard firmware.
//! * [`brick`]: a brick in software, which runs such programs and proves them equal.
//! * [`wiring`], [`names`], [`onboard`], [`origin`]: what the formats share: ports, file names on the brick, what a
//!   program does beyond the controller, and where the controller came from.
//!
//! Every program runs the same stepping machine as [`mindgap_core::controller::Machine`].

pub mod brick;
mod bytecode;
pub mod error;
pub mod names;
pub mod nxc;
pub mod onboard;
pub mod origin;
pub mod wiring;

pub use error::ExportError;
pub use origin::Origin;
