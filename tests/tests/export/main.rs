//! Onboard programs, through real compilers and on the machine that runs a brick's bytecode.

mod brick;
mod budget;
mod c;
mod collect;
mod equality;
mod networks;
mod nxc;
mod rust;
mod rxe;
