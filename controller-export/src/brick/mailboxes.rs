//! Mailboxes, through which bricks talk: ten for messages to this one, ten for messages to others.
//!
//! Source: `cCmdMessage…` in `c_cmd.c` of the firmware.

use std::collections::VecDeque;

use crate::bytecode::comm;

const MAILBOXES: usize = 20;
const MOST_MESSAGES: usize = 5;
const MOST_BYTES: usize = 59;

#[derive(Debug, Default)]
pub(super) struct Mailboxes([VecDeque<Vec<u8>>; MAILBOXES]);

impl Mailboxes {
    /// Leaves a message; the oldest goes when the mailbox is full.
    pub(super) fn write(&mut self, mailbox: u32, message: &[u8]) -> i8 {
        let Some(messages) = self.0.get_mut(mailbox as usize) else { return comm::INVALID_QUEUE };
        if message.len() > MOST_BYTES {
            return comm::INVALID_SIZE;
        }
        if messages.len() == MOST_MESSAGES {
            messages.pop_front();
        }
        messages.push_back(message.to_vec());
        comm::OK
    }

    /// The oldest message, which is taken out on demand; an empty string where there is none.
    pub(super) fn read(&mut self, mailbox: u32, takes: bool) -> (i8, Vec<u8>) {
        let Some(messages) = self.0.get_mut(mailbox as usize) else { return (comm::INVALID_QUEUE, vec![0]) };
        let message = if takes { messages.pop_front() } else { messages.front().cloned() };
        message.map_or((comm::EMPTY_MAILBOX, vec![0]), |message| (comm::OK, message))
    }
}
