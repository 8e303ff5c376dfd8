//! MPI ranks: processes on one or more machines that `mpirun` started with the same command.
//!
//! All ranks run the same command; the first rank hands out the work items, and it alone writes and prints. A rank asks for
//! work for each of its threads, and for more when items are done. Only the main thread calls MPI. It polls for messages and
//! sleeps in between: waiting inside MPI would occupy a whole processor.

use std::panic;
use std::process;
use std::sync::mpsc::Receiver;
use std::thread;
use std::time::Duration;

use mpi::Tag;
use mpi::environment::Universe;
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_bytes::ByteBuf;

use super::distribute::{Backoff, Message, Sent, unwound};
use super::task::Task;
use mindgap_foundations::error::{Error, Result};

/// An error on all ranks is reported by the first; the others wait this long to be aborted by it.
const GRACE: Duration = Duration::from_secs(10);

/// Message: a task, to be compared.
const TASK: Tag = 1;
/// Message: a thread is free, in a part of the run.
const FREE: Tag = 2;
/// Message: items to work on, with their indices.
const ITEMS: Tag = 3;
/// Message: the result of an item.
const DONE: Tag = 4;
/// Message: all items of a part are done.
const PART_DONE: Tag = 5;
/// Message: a value for all ranks.
const VALUE: Tag = 6;

/// The ranks, seen from one of them.
pub struct Ranks {
    universe: Universe,
}

impl Ranks {
    /// Joins the ranks that this process was started with; `None` without `mpirun`.
    ///
    /// # Errors
    /// When MPI cannot be initialised.
    pub fn join() -> Result<Option<Self>> {
        let is_started =
            ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"].iter().any(|name| std::env::var_os(name).is_some());
        if !is_started {
            return Ok(None);
        }
        let started = mpi::initialize_with_threading(mpi::Threading::Funneled);
        let (universe, _) = started.ok_or_else(|| Error::new("MPI is already initialised"))?;
        // MPI would wait for a rank that exits normally.
        let report = panic::take_hook();
        panic::set_hook(Box::new(move |why| {
            report(why);
            process::abort()
        }));
        Ok(Some(Ranks { universe }))
    }

    /// Returns whether this is the first rank.
    pub fn is_first(&self) -> bool {
        self.world().rank() == 0
    }

    /// Returns the number of ranks.
    pub fn count(&self) -> usize {
        self.world().size() as usize
    }

    /// Returns the number of ranks on this machine.
    pub fn on_this_machine(&self) -> usize {
        self.world().split_shared(0).size() as usize
    }

    /// Checks that all ranks have the same task.
    ///
    /// # Errors
    /// On the first rank, when another rank has a different task.
    pub fn agree(&self, task: &Task) -> Result<()> {
        if !self.is_first() {
            self.send(0, TASK, task)?;
            self.broadcast(None::<bool>)?;
            return Ok(());
        }
        for _ in 1..self.count() {
            let (rank, _, bytes) = self.receive();
            if let Some(difference) = decode::<Task>(&bytes)?.difference_from(task) {
                return Err(Error::new(format!("rank {rank} differs from rank 0: it has {difference}")));
            }
        }
        self.broadcast(Some(true))?;
        Ok(())
    }

    /// Sends the value of the first rank to all ranks and returns it.
    ///
    /// # Errors
    /// When it cannot be sent.
    pub fn broadcast<T: Serialize + DeserializeOwned>(&self, value: Option<T>) -> Result<T> {
        match value {
            Some(value) => {
                let bytes = encode(&value)?;
                (1..self.count()).try_for_each(|rank| self.send_bytes(rank, VALUE, &bytes))?;
                Ok(value)
            }
            None => decode(&self.receive().2),
        }
    }

    /// Works on the items of a part that the first rank hands out, on `threads` threads, and sends the results, until the
    /// part is done.
    ///
    /// # Errors
    /// When a result cannot be sent.
    pub fn help(
        &self,
        part: u32,
        threads: usize,
        start: impl Fn(usize, ByteBuf),
        results: &Receiver<Sent>,
    ) -> Result<()> {
        (0..threads).try_for_each(|_| self.send(0, FREE, &part))?;
        let (mut started, mut backoff) = (0, Backoff::new());
        loop {
            while let Some((_, tag, bytes)) = self.probe() {
                if tag == PART_DONE {
                    return Ok(());
                }
                for (index, item) in decode::<Vec<(usize, ByteBuf)>>(&bytes)? {
                    start(index, item);
                    started += 1;
                }
                backoff = Backoff::new();
            }
            // Nothing is handed to a rank whose threads are all busy.
            let sent = if started < threads { results.recv_timeout(backoff.next()).ok() } else { results.recv().ok() };
            if let Some(sent) = sent {
                let (index, item) = unwound(sent);
                self.send(0, DONE, &(index, item.map_err(|e| e.to_string())))?;
                started -= 1;
                backoff = Backoff::new();
            }
        }
    }

    /// Hands items with their indices to a rank.
    ///
    /// # Errors
    /// When they cannot be sent.
    pub fn hand(&self, rank: usize, items: &[(usize, ByteBuf)]) -> Result<()> {
        self.send(rank, ITEMS, &items)
    }

    /// Tells all ranks that a part is done.
    ///
    /// # Errors
    /// When it cannot be sent.
    pub fn finish_part(&self) -> Result<()> {
        (1..self.count()).try_for_each(|rank| self.send(rank, PART_DONE, &()))
    }

    /// Returns the next message of a rank about a part, if there is one.
    ///
    /// # Errors
    /// When it cannot be decoded.
    pub fn poll(&self, part: u32) -> Result<Option<Message>> {
        while let Some((rank, tag, bytes)) = self.probe() {
            if tag == DONE {
                let (index, item): (usize, std::result::Result<ByteBuf, String>) = decode(&bytes)?;
                return Ok(Some(Message::Done(rank, index, item.map_err(Error::new))));
            }
            // A late rank asks for work of a finished part; the answer will be that the part is done.
            if decode::<u32>(&bytes)? == part {
                return Ok(Some(Message::Free(rank)));
            }
        }
        Ok(None)
    }

    /// Ends all ranks after this one has failed; `report` prints the error, unless the first rank already has.
    pub fn fail(&self, report: impl FnOnce()) -> ! {
        if !self.is_first() {
            thread::sleep(GRACE);
        }
        report();
        if self.count() == 1 {
            process::exit(1)
        }
        self.world().abort(1)
    }

    fn world(&self) -> SimpleCommunicator {
        self.universe.world()
    }

    fn send(&self, rank: usize, tag: Tag, value: &impl Serialize) -> Result<()> {
        self.send_bytes(rank, tag, &encode(value)?)
    }

    fn send_bytes(&self, rank: usize, tag: Tag, bytes: &[u8]) -> Result<()> {
        if i32::try_from(bytes.len()).is_err() {
            return Err(Error::new(format!("{} bytes are too many for one message between ranks", bytes.len())));
        }
        self.world().process_at_rank(rank as i32).send_with_tag(bytes, tag);
        Ok(())
    }

    /// Waits for the next message.
    fn receive(&self) -> (usize, Tag, Vec<u8>) {
        let mut backoff = Backoff::new();
        loop {
            match self.probe() {
                Some(message) => return message,
                None => thread::sleep(backoff.next()),
            }
        }
    }

    /// Returns the next message with its sender and tag, if there is one.
    fn probe(&self) -> Option<(usize, Tag, Vec<u8>)> {
        let found = self.world().any_process().immediate_matched_probe()?;
        let (bytes, status) = found.matched_receive_vec();
        Some((status.source_rank() as usize, status.tag(), bytes))
    }
}

fn encode(value: &impl Serialize) -> Result<Vec<u8>> {
    rmp_serde::to_vec_named(value).map_err(|e| Error::new(format!("a message between ranks: {e}")))
}

fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T> {
    rmp_serde::from_slice(bytes).map_err(|e| Error::new(format!("a message between ranks: {e}")))
}
