//! Ranks: processes on one machine or many that `mpirun` started together, all with the same call of the command.
//!
//! Each takes the same way through the command; pieces of work are done by the one to which the first rank hands them,
//! and the first alone writes, prints and asks. A rank asks for work for each of its threads, and for more as it is done.
//! Only the main thread speaks to MPI. It looks for messages now and then, and sleeps: waiting by MPI would take a whole
//! processor.

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

use super::handing_out::{Sent, Told, Waiting, unwound};
use super::task::Task;
use mindgap_foundations::error::{Error, Result};

/// What fails on all ranks alike is told by the first; another waits so long for the end that this is.
const GRACE: Duration = Duration::from_secs(10);

/// What messages are: a task, for comparison;
const TASK: Tag = 1;
/// a thread that is free, in a part of the run;
const FREE: Tag = 2;
/// pieces to do, with their indices;
const PIECES: Tag = 3;
/// what came of one;
const DONE: Tag = 4;
/// that all of a part are done;
const OVER: Tag = 5;
/// a value that all are to have.
const VALUE: Tag = 6;

/// The ranks, seen from one of them.
pub struct Ranks {
    universe: Universe,
}

impl Ranks {
    /// The ranks that this process was started with; none without `mpirun`.
    ///
    /// # Errors
    /// When MPI cannot be begun.
    pub fn join() -> Result<Option<Self>> {
        let is_started =
            ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"].iter().any(|name| std::env::var_os(name).is_some());
        if !is_started {
            return Ok(None);
        }
        let begun = mpi::initialize_with_threading(mpi::Threading::Funneled);
        let (universe, _) = begun.ok_or_else(|| Error::new("MPI was begun already"))?;
        // A rank that left in good order would be waited for.
        let tell = panic::take_hook();
        panic::set_hook(Box::new(move |why| {
            tell(why);
            process::abort()
        }));
        Ok(Some(Ranks { universe }))
    }

    /// Whether this is the first rank.
    pub fn is_first(&self) -> bool {
        self.world().rank() == 0
    }

    /// The number of ranks.
    pub fn count(&self) -> usize {
        self.world().size() as usize
    }

    /// The number of ranks on this machine.
    pub fn on_this_machine(&self) -> usize {
        self.world().split_shared(0).size() as usize
    }

    /// Makes sure that all ranks do the same.
    ///
    /// # Errors
    /// On the first rank, when one could not find out what to do, or does something else.
    pub fn agree(&self, task: &Task) -> Result<()> {
        if !self.is_first() {
            self.send(0, TASK, task)?;
            self.everywhere(None::<bool>)?;
            return Ok(());
        }
        for _ in 1..self.count() {
            let (rank, _, bytes) = self.receive();
            if let Some(difference) = decode::<Task>(&bytes)?.difference_from(task) {
                return Err(Error::new(format!("rank {rank} differs from rank 0: it has {difference}")));
            }
        }
        self.everywhere(Some(true))?;
        Ok(())
    }

    /// The value that the first rank gives, on all.
    ///
    /// # Errors
    /// When it cannot be sent.
    pub fn everywhere<T: Serialize + DeserializeOwned>(&self, value: Option<T>) -> Result<T> {
        match value {
            Some(value) => {
                let bytes = encode(&value)?;
                (1..self.count()).try_for_each(|rank| self.send_bytes(rank, VALUE, &bytes))?;
                Ok(value)
            }
            None => decode(&self.receive().2),
        }
    }

    /// Starts the pieces of a part of the run that the first rank hands out, on so many threads, and sends the results,
    /// until all are done.
    ///
    /// # Errors
    /// When a result cannot be sent.
    pub fn help<P: DeserializeOwned, T: Serialize>(
        &self,
        part: u32,
        threads: usize,
        start: impl Fn(usize, P),
        results: &Receiver<Sent<T>>,
    ) -> Result<()> {
        (0..threads).try_for_each(|_| self.send(0, FREE, &part))?;
        let (mut begun, mut waiting) = (0, Waiting::begin());
        loop {
            while let Some((_, tag, bytes)) = self.look() {
                if tag == OVER {
                    return Ok(());
                }
                for (index, piece) in decode::<Vec<(usize, P)>>(&bytes)? {
                    start(index, piece);
                    begun += 1;
                }
                waiting = Waiting::begin();
            }
            // Nothing is handed to a rank all of whose threads are at work.
            let sent = if begun < threads { results.recv_timeout(waiting.next()).ok() } else { results.recv().ok() };
            if let Some(sent) = sent {
                let (index, piece) = unwound(sent);
                self.send(0, DONE, &(index, piece.map_err(|e| e.to_string())))?;
                begun -= 1;
                waiting = Waiting::begin();
            }
        }
    }

    /// Hands pieces with their indices to a rank.
    ///
    /// # Errors
    /// When they cannot be sent.
    pub fn hand<P: Serialize>(&self, rank: usize, pieces: &[(usize, P)]) -> Result<()> {
        self.send(rank, PIECES, &pieces)
    }

    /// Tells all that a part is over.
    ///
    /// # Errors
    /// When it cannot be sent.
    pub fn over(&self) -> Result<()> {
        (1..self.count()).try_for_each(|rank| self.send(rank, OVER, &()))
    }

    /// What a rank tells of a part, if one does.
    ///
    /// # Errors
    /// When it is not to be understood.
    pub fn told<T: DeserializeOwned>(&self, part: u32) -> Result<Option<Told<T>>> {
        while let Some((rank, tag, bytes)) = self.look() {
            if tag == DONE {
                let (index, piece): (usize, std::result::Result<T, String>) = decode(&bytes)?;
                return Ok(Some(Told::Done(rank, index, piece.map_err(Error::new))));
            }
            // A rank that was late asks for work of a part that is over; it will hear that.
            if decode::<u32>(&bytes)? == part {
                return Ok(Some(Told::Free(rank)));
            }
        }
        Ok(None)
    }

    /// Ends all ranks after this one has failed; `tell` says why, unless the first rank does.
    pub fn fail(&self, tell: impl FnOnce()) -> ! {
        if !self.is_first() {
            thread::sleep(GRACE);
        }
        tell();
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

    /// The next message, whenever it comes.
    fn receive(&self) -> (usize, Tag, Vec<u8>) {
        let mut waiting = Waiting::begin();
        loop {
            match self.look() {
                Some(message) => return message,
                None => thread::sleep(waiting.next()),
            }
        }
    }

    /// The next message and who sent it, if there is one.
    fn look(&self) -> Option<(usize, Tag, Vec<u8>)> {
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
