//! Evolution that does not stick: several starts, and a final choice by many fresh runs.

use super::fitness::Task;
use super::paper::{self, Evolved};

/// Evolves a controller that does well in fresh runs too.
pub fn evolve(task: &Task, watch: impl FnMut(usize, f64)) -> Evolved {
    paper::evolve(task, &paper::settings(), watch)
}
