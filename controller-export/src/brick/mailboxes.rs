//! Mailboxes for messages between bricks: ten for messages to this brick, ten for messages to others.
//!
//! Source: `cCmdMessage…` in `c_cmd.c` of the firmware.

use std::collections::VecDeque;

use crate::bytecode::comm;

const MAILBOXES: usize = 20;
const MAX_MESSAGES: usize = 5;
const MAX_BYTES: usize = 59;

#[derive(Debug, Default)]
pub(super) struct Mailboxes([VecDeque<Vec<u8>>; MAILBOXES]);

impl Mailboxes {
    /// Stores a message. A full mailbox drops its oldest one.
    pub(super) fn write(&mut self, mailbox: u32, message: &[u8]) -> i8 {
        let Some(messages) = self.0.get_mut(mailbox as usize) else { return comm::INVALID_QUEUE };
        if message.len() > MAX_BYTES {
            return comm::INVALID_SIZE;
        }
        if messages.len() == MAX_MESSAGES {
            messages.pop_front();
        }
        messages.push_back(message.to_vec());
        comm::OK
    }

    /// Returns the oldest message, and removes it if asked to; an empty string if there is none.
    pub(super) fn read(&mut self, mailbox: u32, removes: bool) -> (i8, Vec<u8>) {
        let Some(messages) = self.0.get_mut(mailbox as usize) else { return (comm::INVALID_QUEUE, vec![0]) };
        let message = if removes { messages.pop_front() } else { messages.front().cloned() };
        message.map_or((comm::EMPTY_MAILBOX, vec![0]), |message| (comm::OK, message))
    }
}
