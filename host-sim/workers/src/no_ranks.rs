//! Without the feature `mpi` there are no ranks.

use std::sync::mpsc::Receiver;

use serde_bytes::ByteBuf;

use super::handing_out::{Heard, Sent};
use super::task::Task;
use mindgap_foundations::error::Result;

/// None of them is ever there.
pub enum Ranks {}

impl Ranks {
    pub fn join() -> Result<Option<Self>> {
        Ok(None)
    }

    pub fn is_first(&self) -> bool {
        match *self {}
    }

    pub fn count(&self) -> usize {
        match *self {}
    }

    pub fn on_this_machine(&self) -> usize {
        match *self {}
    }

    pub fn agree(&self, _: &Task) -> Result<()> {
        match *self {}
    }

    pub fn everywhere<T>(&self, _: Option<T>) -> Result<T> {
        match *self {}
    }

    pub fn help(&self, _: u32, _: usize, _: impl Fn(usize, ByteBuf), _: &Receiver<Sent>) -> Result<()> {
        match *self {}
    }

    pub fn hand(&self, _: usize, _: &[(usize, ByteBuf)]) -> Result<()> {
        match *self {}
    }

    pub fn over(&self) -> Result<()> {
        match *self {}
    }

    pub fn heard(&self, _: u32) -> Result<Option<Heard>> {
        match *self {}
    }

    pub fn fail(&self, _: impl FnOnce()) -> ! {
        match *self {}
    }
}
