//! Turns a six-tuple controller into an onboard program.
//!
//! The controller is that of C. J. Pretorius, M. C. du Plessis and C. B. Cilliers (2013), "A Neural
//! Network Ultrasonic Sensor Simulator for Evolutionary Robotics", called "the paper" in this crate.
//!
//! * [`nxc`]: readable NXC source for the LEGO NXT's standard firmware.
//! * [`rxe`]: the executable itself, less than half the size.
//! * [`rust`], [`c`]: a constant for programs that use the core, and a C99 header.
//! * [`arduino`]: an Arduino sketch.
//! * [`pybricks`]: a MicroPython program for hubs with pybricks firmware.
//! * [`nxc_networks`], [`rust_networks`], [`c_networks`]: a simulator's networks in fixed point; [`pybricks_networks`]: in
//!   floating point, for MicroPython. [`tabulated`] is what NXC and C read.
//! * [`collect`]: a program that drives at random or by a script and logs, in NXC.
//! * [`brick`]: an emulator of the brick, with which tests show that all formats behave alike.
//! * [`wiring`], [`names`], [`onboard`], [`origin`], [`budget`]: what the formats share: ports, file names on the brick,
//!   behaviour beyond the controller, the controller's origin, and the resources that a program takes.
//!
//! Every program runs the same stepping machine as [`mindgap_core::controller::Machine`].

pub mod arduino;
pub mod brick;
pub mod budget;
mod bytecode;
pub mod c;
pub mod c_networks;
pub mod collect;
pub mod error;
pub mod names;
pub mod nxc;
pub mod nxc_networks;
pub mod onboard;
pub mod origin;
pub mod pybricks;
pub mod pybricks_networks;
pub mod rust;
pub mod rust_networks;
pub mod rxe;
pub mod tabulated;
pub mod wiring;

pub use error::ExportError;
pub use origin::Origin;
