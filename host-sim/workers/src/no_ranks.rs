//! Without the feature `mpi` there are no ranks.

use std::sync::mpsc::Receiver;

use super::handing_out::{Sent, Told};
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

    pub fn help<P, T>(&self, _: u32, _: usize, _: impl Fn(usize, P), _: &Receiver<Sent<T>>) -> Result<()> {
        match *self {}
    }

    pub fn hand<P>(&self, _: usize, _: &[(usize, P)]) -> Result<()> {
        match *self {}
    }

    pub fn over(&self) -> Result<()> {
        match *self {}
    }

    pub fn told<T>(&self, _: u32) -> Result<Option<Told<T>>> {
        match *self {}
    }

    pub fn fail(&self, _: impl FnOnce()) -> ! {
        match *self {}
    }
}
