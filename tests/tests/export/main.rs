//! Onboard programs, through real compilers and on the machine that runs a brick's bytecode.

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
