#![doc = include_str!("../README.md")]
//!
//! ## Modules
//!
//! * [`nxc`], [`rxe`], [`c`], [`rust`], [`arduino`], [`pybricks`]: a controller as source code or as an executable.
//! * [`nxc_networks`], [`c_networks`], [`rust_networks`]: networks in fixed point; [`pybricks_networks`]: in floating
//!   point. NXC and C read the same table, [`tabulated`].
//! * [`c_monitor`], [`rust_monitor`]: the onboard monitor of a simulator, as C99 and as Rust.
//! * [`collect`], [`pybricks_collect`]: a program that drives and logs.
//! * [`brick`]: the emulator, with which tests show that all formats behave alike.
//! * [`wiring`], [`names`], [`onboard`], [`origin`], [`budget`]: what the formats share: ports, file names on the brick,
//!   behaviour beyond the controller, the controller's origin, and the resources of a program.
//! * [`error`]: the reasons why a controller cannot be exported.
//!
//! "The paper" in these pages is C. J. Pretorius, M. C. du Plessis and C. B. Cilliers (2013), *A Neural Network Ultrasonic
//! Sensor Simulator for Evolutionary Robotics*.

pub mod arduino;
pub mod brick;
pub mod budget;
mod bytecode;
pub mod c;
pub mod c_monitor;
pub mod c_networks;
pub mod collect;
pub mod error;
pub mod names;
pub mod nxc;
pub mod nxc_networks;
pub mod onboard;
pub mod origin;
pub mod pybricks;
pub mod pybricks_collect;
pub mod pybricks_networks;
pub mod rust;
pub mod rust_monitor;
pub mod rust_networks;
pub mod rxe;
pub mod tabulated;
pub mod wiring;

pub use error::ExportError;
pub use origin::Origin;
