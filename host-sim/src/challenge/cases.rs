//! The cases of a challenge: which robots, which effects, in which room, driven in which way.

use rand::seq::{IndexedRandom, SliceRandom};
use rand::{Rng, RngExt};

use super::rooms;
use crate::built_in_robot::{ActiveEffect, Driving, Effect, record, record_driving};
use crate::chance::{Generator, generator};
use crate::logs::Logs;
use crate::problem::Result;

/// Robots in a challenge.
pub const ROBOTS: usize = 4;
/// Steps of a run.
pub const STEPS: usize = 60;
/// A robot's own logs.
const NOMINAL_RUNS: usize = 80;
/// Runs of a case.
const RUNS: [usize; 2] = [16, 28];
/// Every other case is driven as the robot's own logs are.
const DRIVEN_ALIKE: f64 = 0.5;
/// Of ten cases so many have no effect, one that no diagnosis knows, and two that it knows; the others have one.
const WITHOUT: usize = 2;
const OUTSIDE: usize = 1;
const PAIRS: usize = 1;
/// A strong effect can make a robot that hits something in every small room: so many are tried.
const ROOMS_TRIED: usize = 20;
/// Places of generators.
const ROBOT: u64 = 0;
const CASE: u64 = 1;

/// A case before it is written.
pub struct Case {
    /// Which of the robots.
    pub robot: usize,
    /// What is different.
    pub effects: Vec<ActiveEffect>,
    /// How it was driven.
    pub driving: Driving,
    /// What was logged.
    pub logs: Logs,
    /// Draws what else is random about the case.
    pub rng: Generator,
}

/// The logs of each robot as its simulator should know it.
///
/// # Errors
/// When a robot has no room to drive in.
pub fn robots(seed: u64) -> Result<Vec<Logs>> {
    let robot = |robot: u64| {
        let mut rng = generator(seed, &[ROBOT, robot]);
        let spec = rooms::robot(&mut rng);
        record(&spec, &rooms::room(&mut rng), NOMINAL_RUNS, STEPS, &[], rng.next_u64())
    };
    (0..ROBOTS as u64).map(robot).collect()
}

/// Drives a case.
///
/// # Errors
/// When the robot hits something in every room.
pub fn case(number: usize, effects: &[Effect], robots: &[Logs], seed: u64) -> Result<Case> {
    let mut rng = generator(seed, &[CASE, number as u64]);
    let mut tried = 0;
    loop {
        let robot = rng.random_range(0..robots.len());
        let runs = rng.random_range(RUNS[0]..=RUNS[1]);
        let effects: Vec<ActiveEffect> = effects.iter().map(|e| ActiveEffect::random(*e, &mut rng)).collect();
        let alike = rng.random_bool(DRIVEN_ALIKE);
        let kind = Driving::ALL[1..].choose(&mut rng).filter(|_| !alike);
        let driving = *kind.unwrap_or(&Driving::MIXED);
        let (spec, scene) = (&robots[robot].robot, rooms::room(&mut rng));
        tried += 1;
        match record_driving(&driving, spec, &scene, [runs, STEPS], &effects, rng.next_u64()) {
            Ok(logs) => return Ok(Case { robot, effects, driving, logs, rng }),
            Err(problem) if tried == ROOMS_TRIED => return Err(problem),
            Err(_) => {}
        }
    }
}

/// What is different in each of so many cases, in no order; single effects come about equally often.
pub fn effects(cases: usize, seed: u64) -> Vec<Vec<Effect>> {
    let rng = &mut generator(seed, &[CASE]);
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
