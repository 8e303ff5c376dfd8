//! Generates a challenge: robots with logs to learn a simulator from, and cases that may have effects.

use std::path::Path;

use rand::Rng;
use rayon::prelude::*;

use super::cases::{self, Echoes, Outside};
use super::seal::{Published, Sealed};
use super::{Counter, Folder};
use crate::error::Result;
use crate::files;

/// Writes a challenge of `count` cases to a folder; `outside` is what its effects outside the table are drawn from, and
/// `echoes` what the chance in their echoes belongs to; `watch` is told how many are done, and of how many.
///
/// # Errors
/// When the folder cannot be written or a case cannot be recorded.
pub fn make(
    folder: &Path,
    count: usize,
    seed: u64,
    outside: Outside,
    echoes: Echoes,
    watch: impl Fn(usize, usize) + Sync,
) -> Result<()> {
    let ours = |name: &str| ["robots", "cases", "cases.csv", "sealed.json", "answers"].contains(&name);
    let counter = Counter::new(count, watch);
    files::write_folder(folder, ours, |fresh| fill(&Folder(fresh), count, seed, outside, echoes, || counter.one_more()))
}

fn fill(
    folder: &Folder,
    count: usize,
    seed: u64,
    outside: Outside,
    echoes: Echoes,
    done: impl Fn() + Sync,
) -> Result<()> {
    let robots = cases::robots(seed, echoes)?;
    for (robot, logs) in robots.iter().enumerate() {
        logs.write(&folder.robot(&robot.to_string()))?;
    }
    let made: Vec<(Sealed, Published)> = cases::effects(count, seed, outside)
        .par_iter()
        .enumerate()
        .map(|(number, effects)| {
            let mut made = cases::case(number, effects, &robots, echoes, seed)?;
            let case = format!("{number:03}");
            made.logs.write(&folder.case(&case))?;
            let sealed = Sealed {
                case: case.clone(),
                effects: made.effects.iter().map(ToString::to_string).collect(),
                driving: made.driving.name.into(),
                fresh_seed: made.rng.next_u64(),
                salt: format!("{:016x}", made.rng.next_u64()),
            };
            let published = Published { case, robot: made.robot.to_string(), commitment: sealed.commitment() };
            done();
            Ok((sealed, published))
        })
        .collect::<Result<_>>()?;
    let (sealed, published): (Vec<Sealed>, Vec<Published>) = made.into_iter().unzip();
    files::write_json(&folder.sealed(), &sealed)?;
    files::write_csv(&folder.cases(), &published)
}
