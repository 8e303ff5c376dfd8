//! Onboard programs: compiled by the real compilers and run in emulators.

mod arduino;
mod brick;
mod budget;
mod c;
mod collect;
mod conformance;
mod equality;
mod networks;
mod nxc;
mod pybricks;
mod rust;
mod rxe;
mod safety;
mod scripted;
