//! Makes a challenge: robots that a simulator may be learned from, and cases in which something may be different.

use std::path::Path;

use rand::seq::SliceRandom;
use rand::{Rng, RngExt};
use rayon::prelude::*;

use super::seal::{Published, Sealed};
use super::{Folder, rooms};
use crate::built_in_robot::{ActiveEffect, Effect, record};
use crate::chance::{Generator, derive, generator};
use crate::files;
use crate::logs::Robot;
use crate::problem::Result;

/// Robots in a challenge.
const ROBOTS: usize = 4;
/// A robot's own logs.
const NOMINAL_RUNS: usize = 80;
const STEPS: usize = 60;
/// Runs of a case.
const RUNS: [usize; 2] = [16, 28];
/// Of ten cases so many have no effect, one that no diagnosis knows, and two that it knows; the others have one.
const WITHOUT: usize = 2;
const OUTSIDE: usize = 1;
const PAIRS: usize = 1;
/// Places of generators.
const ROBOT: u64 = 0;
const CASE: u64 = 1;

/// Writes `cases` cases to a folder.
///
/// # Errors
/// When the folder cannot be written.
pub fn make(folder: &Path, cases: usize, seed: u64) -> Result<()> {
    let ours = |name: &str| ["robots", "cases", "cases.csv", "sealed.json", "answers"].contains(&name);
    files::write_folder(folder, ours, |fresh| fill(&Folder(fresh), cases, seed))
}

fn fill(folder: &Folder, cases: usize, seed: u64) -> Result<()> {
    let robots: Vec<Robot> = (0..ROBOTS as u64)
        .map(|robot| {
            let mut rng = generator(seed, &[ROBOT, robot]);
            let spec = rooms::robot(&mut rng);
            let logs = record(&spec, &rooms::room(&mut rng), NOMINAL_RUNS, STEPS, &[], rng.next_u64())?;
            logs.write(&folder.robot(&robot.to_string()))?;
            Ok(spec)
        })
        .collect::<Result<_>>()?;
    let effects = effects(cases, &mut generator(seed, &[CASE]));
    let made: Vec<(Sealed, Published)> = effects
        .par_iter()
        .enumerate()
        .map(|(number, effects)| {
            let case = format!("{number:03}");
            let mut rng = generator(seed, &[CASE, number as u64]);
            let robot = rng.random_range(0..ROBOTS);
            let runs = rng.random_range(RUNS[0]..=RUNS[1]);
            let active: Vec<ActiveEffect> = effects.iter().map(|e| ActiveEffect::random(*e, &mut rng)).collect();
            let scene = rooms::room(&mut rng);
            let logs = record(&robots[robot], &scene, runs, STEPS, &active, rng.next_u64())?;
            logs.write(&folder.case(&case))?;
            let salt = format!("{:016x}", derive(seed, &[CASE, number as u64, rng.next_u64()]));
            let sealed =
                Sealed { case: case.clone(), effects: active.iter().map(ActiveEffect::to_string).collect(), salt };
            let published = Published { case, robot: robot.to_string(), commitment: sealed.commitment() };
            Ok((sealed, published))
        })
        .collect::<Result<_>>()?;
    let (sealed, published): (Vec<Sealed>, Vec<Published>) = made.into_iter().unzip();
    files::write_json(&folder.sealed(), &sealed)?;
    files::write_csv(&folder.cases(), &published)
}

/// What is different in each case, in no order; single effects come about equally often.
fn effects(cases: usize, rng: &mut Generator) -> Vec<Vec<Effect>> {
    let known: Vec<Effect> = Effect::all().filter(|e| e.in_table()).collect();
    let outside: Vec<Effect> = Effect::all().filter(|e| !e.in_table() && *e != Effect::Unchanged).collect();
    let (mut known, mut outside) = (Deck::new(known), Deck::new(outside));
    let mut effects: Vec<Vec<Effect>> = (0..cases)
        .map(|case| match case % 10 {
            c if c < WITHOUT => Vec::new(),
            c if c < WITHOUT + OUTSIDE => vec![outside.draw(rng)],
            c if c < WITHOUT + OUTSIDE + PAIRS => {
                let first = known.draw(rng);
                let second = loop {
                    let other = known.draw(rng);
                    if other != first {
                        break other;
                    }
                };
                vec![first, second]
            }
            _ => vec![known.draw(rng)],
        })
        .collect();
    effects.shuffle(rng);
    effects
}

/// Draws each in turn before any comes again.
struct Deck {
    cards: Vec<Effect>,
    drawn: usize,
}

impl Deck {
    fn new(cards: Vec<Effect>) -> Self {
        Deck { cards, drawn: 0 }
    }

    fn draw(&mut self, rng: &mut Generator) -> Effect {
        let place = self.drawn % self.cards.len();
        if place == 0 {
            self.cards.shuffle(rng);
        }
        self.drawn += 1;
        self.cards[place]
    }
}
