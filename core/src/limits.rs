//! The memory of an NXT-class brick, and the limits that this crate keeps. They are checked when it is compiled.
//!
//! The brick's AT91SAM7S256 has 64 KB of RAM and 256 KB of flash, and its firmware keeps most of both: a program gets a
//! pool of 32 KB for its data and shares the rest of the flash with other files. A program on the bare processor has all
//! of it.

use core::mem::size_of;

use crate::chance::Generator;
use crate::controller::{Controller, Machine};
use crate::fixed_network::{FixedNetwork, Output, ScaledInputs};

/// RAM of the processor, in bytes.
pub const RAM_BYTES: usize = 64 * 1024;
/// Flash of the processor, in bytes.
pub const FLASH_BYTES: usize = 256 * 1024;
/// Memory that the firmware gives a program for its data, in bytes.
pub const POOL_BYTES: usize = 32 * 1024;
/// Flash for files on an empty brick, in bytes, with the firmware that leaves least of it: the enhanced 1.32, which also
/// runs programs for the standard firmware. The standard 1.29 leaves 121,124 bytes.
pub const FREE_FLASH_BYTES: u32 = 104_104;

/// Upper bound on the flash of one network, in bytes.
pub const NETWORK_BYTES: usize = 1024;
/// Upper bound on the flash of five networks, a controller and their code, in bytes.
pub const PROGRAM_BYTES: usize = 12 * 1024;
/// Upper bound on the RAM of a controller's run with five networks, in bytes, without the stack.
pub const STATE_BYTES: usize = 512;
/// Upper bound on its stack, in bytes.
pub const STACK_BYTES: usize = 1024;

/// Everything that changes during a run: the machine, the random generator, and the inputs and outputs of five networks.
type State = (Machine<'static>, Generator, ScaledInputs<4>, ScaledInputs<2>, [Output; 5]);

const _: () = {
    assert!(size_of::<FixedNetwork<4>>() <= NETWORK_BYTES, "a motion network with all its product units is too large");
    assert!(size_of::<FixedNetwork<2>>() <= NETWORK_BYTES, "a sonar network with all its product units is too large");
    assert!(size_of::<State>() <= STATE_BYTES, "the state of a run is too large");
    // Networks of the sizes in Table I of the paper; `tests/firmware` measures what their code adds.
    let motion = size_of::<FixedNetwork<4, 2>>() + 2 * size_of::<FixedNetwork<4, 10>>();
    let sonar = size_of::<FixedNetwork<2, 5>>() + size_of::<FixedNetwork<2, 20>>();
    assert!(motion + sonar + size_of::<Controller>() <= PROGRAM_BYTES / 4, "networks leave too little for their code");
    assert!(STATE_BYTES + STACK_BYTES <= POOL_BYTES && PROGRAM_BYTES <= FREE_FLASH_BYTES as usize);
    assert!(POOL_BYTES <= RAM_BYTES && FREE_FLASH_BYTES as usize <= FLASH_BYTES);
};
