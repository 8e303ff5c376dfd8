//! The scheduler of clumps, which are ready, asleep, or waiting for a mutex.
//!
//! Source: the scheduler in the firmware's `c_cmd.c`.

use std::collections::VecDeque;

use super::Fault;
use super::program::{Clump, Program};

pub(super) struct Schedule {
    clumps: Vec<State>,
    queue: VecDeque<u8>,
    asleep: Vec<(u8, u32)>,
    /// For each mutex, by its entry in the dataspace: its owner, followed by the clumps that wait for it.
    mutexes: Vec<VecDeque<u8>>,
}

struct State {
    pc: usize,
    start: usize,
    fire_count: u8,
    first_fire_count: u8,
}

impl Schedule {
    pub(super) fn new(program: &Program) -> Self {
        let state = |clump: &Clump| State {
            pc: clump.code.start,
            start: clump.code.start,
            fire_count: clump.fire_count,
            first_fire_count: clump.fire_count,
        };
        let starting = program.clumps.iter().enumerate().filter(|(_, clump)| clump.fire_count == 0);
        Schedule {
            clumps: program.clumps.iter().map(state).collect(),
            queue: starting.map(|(i, _)| i as u8).collect(),
            asleep: Vec::new(),
            mutexes: vec![VecDeque::new(); program.entries.len()],
        }
    }

    /// Returns the running clump.
    pub(super) fn running(&self) -> Option<u8> {
        self.queue.front().copied()
    }

    /// Returns whether no clump runs or sleeps. Clumps that wait for a mutex would then wait for ever.
    pub(super) fn is_empty(&self) -> bool {
        self.queue.is_empty() && self.asleep.is_empty()
    }

    pub(super) fn rotate(&mut self) {
        if !self.queue.is_empty() {
            self.queue.rotate_left(1);
        }
    }

    pub(super) fn pc(&self, clump: u8) -> usize {
        self.clumps[usize::from(clump)].pc
    }

    pub(super) fn set_pc(&mut self, clump: u8, pc: usize) {
        self.clumps[usize::from(clump)].pc = pc;
    }

    /// Puts the running clump to sleep.
    pub(super) fn sleep(&mut self, until_ms: u32) {
        if let Some(clump) = self.queue.pop_front() {
            self.asleep.push((clump, until_ms));
        }
    }

    pub(super) fn wake(&mut self, t_ms: u32) {
        let queue = &mut self.queue;
        self.asleep.retain(|(clump, until_ms)| {
            let sleeps = *until_ms > t_ms;
            if !sleeps {
                queue.push_back(*clump);
            }
            sleeps
        });
    }

    /// Returns the time at which the next clump wakes, or `None` if one is ready or none sleeps.
    pub(super) fn next_wake_ms(&self) -> Option<u32> {
        if !self.queue.is_empty() {
            return None;
        }
        self.asleep.iter().map(|(_, until_ms)| *until_ms).min()
    }

    /// Replaces the running clump with the subroutine that it calls.
    pub(super) fn call(&mut self, callee: u8) -> Result<(), Fault> {
        self.check(callee)?;
        self.queue.pop_front();
        self.queue.push_back(callee);
        Ok(())
    }

    /// Ends the running subroutine and resumes its caller.
    pub(super) fn return_to(&mut self, caller: u8) -> Result<(), Fault> {
        self.check(caller)?;
        self.end_running();
        self.queue.push_back(caller);
        Ok(())
    }

    /// Ends the running clump and starts those of its dependents that wait for no other clump.
    pub(super) fn finish(&mut self, dependents: &[u8]) -> Result<(), Fault> {
        self.end_running();
        for dependent in dependents {
            self.check(*dependent)?;
            let state = &mut self.clumps[usize::from(*dependent)];
            state.fire_count = state.fire_count.wrapping_sub(1);
            if state.fire_count == 0 {
                self.queue.push_back(*dependent);
            }
        }
        Ok(())
    }

    /// Acquires a mutex for the running clump. If it is taken, the clump waits and the result is `false`.
    pub(super) fn acquire(&mut self, mutex: u16) -> Result<bool, Fault> {
        let running = self.running().ok_or(Fault::Instruction)?;
        let waiting = self.mutexes.get_mut(usize::from(mutex)).ok_or(Fault::Argument)?;
        waiting.push_back(running);
        if waiting.len() == 1 {
            return Ok(true);
        }
        self.queue.pop_front();
        Ok(false)
    }

    pub(super) fn release(&mut self, mutex: u16) -> Result<(), Fault> {
        let waiting = self.mutexes.get_mut(usize::from(mutex)).ok_or(Fault::Argument)?;
        waiting.pop_front();
        self.queue.extend(waiting.front());
        Ok(())
    }

    fn end_running(&mut self) {
        if let Some(clump) = self.queue.pop_front() {
            let state = &mut self.clumps[usize::from(clump)];
            state.pc = state.start;
            state.fire_count = state.first_fire_count;
        }
    }

    fn check(&self, clump: u8) -> Result<(), Fault> {
        if usize::from(clump) < self.clumps.len() { Ok(()) } else { Err(Fault::Argument) }
    }
}
