//! What an NXT-class brick has room for, checked whenever this crate is compiled.
//!
//! The brick's AT91SAM7S256 has 64 KB of RAM and 256 KB of flash, and the firmware keeps most of it: a program gets a
//! pool of 32 KB for its data, and shares the rest of the flash with other files. A program on the bare processor has all
//! of it.

use core::mem::size_of;

use crate::chance::Generator;
use crate::controller::{Controller, Machine};
use crate::fixed_network::{FixedNetwork, Output, ScaledInputs};

/// RAM of the processor.
pub const RAM_BYTES: usize = 64 * 1024;
/// Flash of the processor.
pub const FLASH_BYTES: usize = 256 * 1024;
/// What the firmware leaves a program for its data.
pub const POOL_BYTES: usize = 32 * 1024;
/// User flash without files of a brick whose firmware leaves least of it: the enhanced 1.32, which runs programs for the
/// standard firmware too. The standard 1.29 leaves 121,124 bytes.
pub const FREE_FLASH_BYTES: u32 = 104_104;

/// The most that one network may take in flash.
pub const NETWORK_BYTES: usize = 1024;
/// The most that networks, controller and their code may take in flash together.
pub const PROGRAM_BYTES: usize = 12 * 1024;
/// The most RAM that a controller's run with networks beside it may take, stack apart.
pub const STATE_BYTES: usize = 512;
/// The most stack that it may take.
pub const STACK_BYTES: usize = 1024;

/// Everything that changes in a run: the controller's place, chance, and one step's inputs and outputs of five networks.
type State = (Machine, Generator, ScaledInputs<4>, ScaledInputs<2>, [Output; 5]);

const _: () = {
    assert!(size_of::<FixedNetwork<4>>() <= NETWORK_BYTES, "a motion network with all its product units is too large");
    assert!(size_of::<FixedNetwork<2>>() <= NETWORK_BYTES, "a sonar network with all its product units is too large");
    assert!(size_of::<State>() <= STATE_BYTES, "the state of a run is too large");
    // Networks of the sizes of Table I; `tests/firmware` measures what their code adds.
    let motion = size_of::<FixedNetwork<4, 2>>() + 2 * size_of::<FixedNetwork<4, 10>>();
    let sonar = size_of::<FixedNetwork<2, 5>>() + size_of::<FixedNetwork<2, 20>>();
    assert!(motion + sonar + size_of::<Controller>() <= PROGRAM_BYTES / 4, "networks leave too little for their code");
    assert!(STATE_BYTES + STACK_BYTES <= POOL_BYTES && PROGRAM_BYTES <= FREE_FLASH_BYTES as usize);
    assert!(POOL_BYTES <= RAM_BYTES && FREE_FLASH_BYTES as usize <= FLASH_BYTES);
};
